"""The command line. This file stays cheap: `pluto --help` must cost little more than a bare interpreter, so nothing is imported early."""

from __future__ import annotations

import os
import sys

COMMANDS = {
    "run": "run a mission in a simulated world",
    "check": "find every fault of missions, worlds, maps and platform files",
    "fmt": "bring missions and worlds into one canonical form",
    "diff": "say what differs between two missions, in nodes and ports",
    "tree": "show a mission's tree (ascii, unicode, dot, svg, xhtml, xml)",
    "nodes": "list every node with its ports",
    "new": "write a first mission or leaf to start from",
    "ps": "show the modules of a running robot",
    "stop": "stop a running robot at once",
    "module": "start or stop one module of a running robot",
    "shell": "talk to a running robot: one command, a script, or a conversation",
    "why": "why the robot is not moving: of a running robot or of a black box",
    "replay": "a recorded run, tick by tick, or executed again",
    "info": "what a black box holds",
    "plot": "a recorded run as a picture: path, speeds, verdicts, leaves",
    "export": "a black box as JSON, CSV, XML or a CARMEN log",
    "record": "record a running robot from outside",
    "repair": "make a black box whole that was cut short or damaged",
    "totest": "make a pytest file of a recorded run",
    "bench": "measure, and print ratios",
}

FIRST_STEPS = """\
pluto runs missions (behaviour trees in XML) on simulated and real robots. Three things to try:

  pluto run t02_go_to_a_place.xml                                         a first drive in the yard, with a summary
  pluto run patrol.xml --port goals="8,3;10.5,8;2,3.5" --plot patrol.png   a patrol, drawn
  pluto tree patrol.xml                                                   what that mission is made of

`pluto --help` lists all commands."""


def help_text() -> str:
    """What `pluto --help` prints."""
    width = max(map(len, COMMANDS))
    rows = "\n".join(f"  {name:<{width}}  {text}" for name, text in COMMANDS.items())
    return f"usage: pluto COMMAND [ARGUMENTS ...]\n\n{rows}\n\n`pluto COMMAND --help` tells more; `pluto` alone prints three things to try."


def main(argv: list[str] | None = None) -> int:
    """Run one command; returns its exit code."""
    _prepare_streams()
    try:
        code = _command(sys.argv[1:] if argv is None else argv)
        sys.stdout.flush()
    except BrokenPipeError:  # the reader of our output has gone, as in `pluto nodes | head`
        _forget_output()
        return 141
    except OSError as error:  # no room for our output, a folder that has gone
        _forget_output()
        print(f"pluto: error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return code


def _prepare_streams() -> None:
    """Whoever closed our output wants none; an old locale, or a file name in no locale, must not end in a traceback."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115  open for as long as the process lives
        if hasattr(getattr(sys, name), "reconfigure"):
            getattr(sys, name).reconfigure(errors="backslashreplace")


def _forget_output() -> None:
    """What cannot be written is dropped, or the interpreter complains again when it flushes at exit."""
    try:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError:
        return


def _command(args: list[str]) -> int:
    if not args:
        print(FIRST_STEPS)
        return 0
    name, rest = args[0], args[1:]
    if name in ("-h", "--help", "help"):
        print(help_text())
        return 0
    if name == "--version":
        from pluto_bt import __version__

        print(f"pluto {__version__}")
        return 0
    from pluto_bt.source.faults import InputError, did_you_mean

    if name not in COMMANDS:
        print(f'pluto: no command "{name}"; {did_you_mean(name, COMMANDS) or "`pluto --help` lists them"}', file=sys.stderr)
        return 2
    from importlib import import_module

    try:
        code: int = import_module(f"pluto_bt.commands.{name}").main(rest)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return code


if __name__ == "__main__":
    sys.exit(main())
