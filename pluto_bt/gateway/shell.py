"""`pluto shell [HOST:PORT] [COMMAND ...]`: say one thing to a running robot, or talk to it."""

from __future__ import annotations

import os
import re
import shlex
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TextIO

from pluto_bt.gateway.client import Client, GatewayError
from pluto_bt.gateway.commands import COMMANDS, DONE, FAILED, USAGE, UsageError
from pluto_bt.gateway.listen import Address
from pluto_bt.source import did_you_mean

INTERRUPTED = 130
DEFAULT_ADDRESS = str(Address())
_ADDRESS = re.compile(r"(\[[0-9A-Fa-f:]+\]|[A-Za-z0-9.-]*):([0-9]{1,5})")


def main(words: Sequence[str], out: TextIO | None = None, errors: TextIO | None = None) -> int:
    """Run the shell with the words behind `pluto shell`; the exit code: 0 done, 1 failed, 2 not understood, 130 Ctrl-C after a stop."""
    out, errors = out or sys.stdout, errors or sys.stderr
    if words and words[0] in ("-h", "--help"):
        print(f"usage: pluto shell [HOST:PORT] [COMMAND ...]\n\n{help_text()}\n\nWithout a command it asks for commands. HOST:PORT is "
              f"{DEFAULT_ADDRESS} if it is not given.", file=out)  # fmt: skip
        return DONE
    rest = list(words)
    address = rest.pop(0) if rest and _ADDRESS.fullmatch(rest[0]) else DEFAULT_ADDRESS
    shell = Shell(address, out, errors)
    return shell.say(rest) if rest else shell.talk()


def help_text() -> str:
    """One line a command."""
    rows = [(command.usage, command.doc) for command in COMMANDS.values()]
    rows += [("help", "this list"), ("quit", "leave; the robot goes on with what it does. Ctrl-C stops the robot")]
    return "\n".join(f"{usage:<14} {doc}" for usage, doc in rows)


class Shell:
    """One robot's address and where to write; each command has its own connection, so that a long silence costs nothing."""

    def __init__(self, address: str, out: TextIO, errors: TextIO) -> None:
        found = _ADDRESS.fullmatch(address)
        assert found is not None, "checked by main"
        self._host, self._port = found[1].strip("[]") or "127.0.0.1", int(found[2])
        self._out = out
        self._errors = errors

    def say(self, words: Sequence[str]) -> int:
        """Do one command; its exit code."""
        name, *arguments = words
        if name == "help":
            print(help_text(), file=self._out)
            return DONE
        command = COMMANDS.get(name)
        if command is None:
            hint = did_you_mean(name, COMMANDS)
            return self._complain(f'unknown command "{name}"; {hint or "one of: " + ", ".join(COMMANDS)}', USAGE)
        try:
            with Client(self._host, self._port, name="shell") as client:
                return command.run(client, arguments, self._out)
        except UsageError as error:
            return self._complain(f"{error}; usage: {command.usage}", USAGE)
        except GatewayError as error:
            return self._complain(f"{error.code}: {error.text}", FAILED)
        except KeyboardInterrupt:
            return self._interrupted()

    def talk(self) -> int:
        """Read commands until `quit` or the end of the input; the exit code of the last one if nobody sits there."""
        ask = _prompt() if sys.stdin.isatty() else _plain
        code = DONE
        while True:
            try:
                line = ask()
                words = shlex.split(line)
            except EOFError:
                return DONE if sys.stdin.isatty() else code
            except KeyboardInterrupt:
                code = self._interrupted()
                continue
            except ValueError as error:  # an open quote
                code = self._complain(str(error), USAGE)
                continue
            if words and words[0] in ("quit", "exit"):
                return DONE if sys.stdin.isatty() else code
            if words:
                code = self.say(words)

    def _interrupted(self) -> int:
        """Ctrl-C: whatever went on, the robot stops."""
        try:
            with Client(self._host, self._port, name="shell") as client:
                client.request("stop")
        except GatewayError as error:
            return self._complain(f"{error.code}: {error.text}", FAILED)
        print("stopped", file=self._out)
        return INTERRUPTED

    def _complain(self, text: str, code: int) -> int:
        print(f"pluto shell: {text}", file=self._errors)
        return code


def _plain() -> str:
    return input("pluto> " if sys.stdin.isatty() else "")


def _prompt() -> Callable[[], str]:
    """Line editing with completion and history where prompt_toolkit is installed, else plain input."""
    try:
        from prompt_toolkit import PromptSession
        from prompt_toolkit.completion import WordCompleter
        from prompt_toolkit.history import FileHistory, History, InMemoryHistory
    except ImportError:
        return _plain
    history: History
    try:
        folder = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local/state") / "pluto"
        folder.mkdir(parents=True, exist_ok=True)
        history = FileHistory(str(folder / "shell_history"))
    except (OSError, RuntimeError):
        history = InMemoryHistory()
    session: PromptSession[str] = PromptSession("pluto> ", completer=WordCompleter([*COMMANDS, "help", "quit"]), history=history)
    return session.prompt
