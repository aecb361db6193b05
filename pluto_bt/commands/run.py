"""`pluto run`: a mission in a world, with live progress, a summary, a picture and a trace."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import IO, TYPE_CHECKING

from pluto_bt.commands.options import Parser
from pluto_bt.result import RunResult
from pluto_bt.source import Faults, InputError

if TYPE_CHECKING:
    from pluto_bt.commands.progress import Progress
    from pluto_bt.resume import ResumeRequest
    from pluto_bt.runner import Runner


def main(argv: list[str]) -> int:
    """Run one mission; returns the exit code of DESIGN.md, section 4."""
    wants_json = "--json" in argv  # known even if the command line cannot be understood
    try:
        result = _run(run_parser().parse_args(argv))
    except InputError as error:
        print(error, file=sys.stderr)
        result = RunResult(result="REFUSED", reason="bad-input", faults=[fault.as_json() for fault in error.faults])
    if wants_json:
        print(result.as_json(), flush=True)
    return result.exit_code


def run_parser() -> Parser:
    """All options of a run."""
    from pluto_bt.commands.doors import add_door_options
    from pluto_bt.commands.input_options import add_input_options

    parser = Parser(prog="pluto run", description="Run a mission in a simulated world.")
    add_input_options(parser)
    parser.add_argument("--realtime", action="store_true", help="the same modules in threads, at the pace of the clock")
    parser.add_argument("--speed", metavar="FACTOR", help="with --realtime: run that many times faster")
    parser.add_argument("--max-time", metavar="S", help="stop after this many seconds of the run")
    parser.add_argument("--watch", action="store_true", help="show the live tree on the terminal")
    parser.add_argument("--plot", metavar="FILE", help="draw world, path, goals and contacts (.png or .svg)")
    parser.add_argument("--trace", metavar="FILE.jsonl", help="write one line a tick and a command")
    parser.add_argument("--record", metavar="FILE.mcap", help="write a black box, for `pluto replay`, `pluto why` and Foxglove")
    parser.add_argument("--resume", choices=("hold", "ask", "resume"), help="keep a journal; after a crash stay still, ask, or go on where it was")
    parser.add_argument("--journal", metavar="FILE", help="with --resume: where the journal lies (default: one for each mission in the state folder)")
    add_door_options(parser)
    parser.add_argument("--json", action="store_true", help="end with one JSON object on the last line")
    return parser


def _progress(stream: IO[str], watch: bool) -> Progress:
    """What the run shows of itself; the tree too if it is to be watched."""
    from pluto_bt.commands.progress import Progress, is_terminal

    if not watch:
        return Progress(stream)
    from pluto_bt.commands.watch import LiveTree, ToldTree

    return LiveTree(stream) if is_terminal(stream) else ToldTree(stream)


def _confirm(question: str) -> bool:
    """A question at the terminal; without one the answer is no."""
    if not sys.stdin.isatty():
        return False
    print(f"{question} [y/N] ", end="", file=sys.stderr, flush=True)
    return sys.stdin.readline().strip().lower() in ("y", "yes")


def _tell_of_compilation(has_gateway: bool) -> None:
    then = "; the gateway opens when that is done" if has_gateway else ""
    print(f"compiling kernels: once after an installation or an update, up to a minute{then}", file=sys.stderr, flush=True)


def _resume(args: argparse.Namespace) -> ResumeRequest | None:
    from pluto_bt.resume import ResumeRequest

    if args.resume is None:
        return None
    return ResumeRequest(args.resume, None if args.journal is None else Path(args.journal), args.start is not None, _confirm)


def _run(args: argparse.Namespace) -> RunResult:
    from pluto_bt.commands.doors import read_doors
    from pluto_bt.commands.input_options import request_of
    from pluto_bt.commands.outputs import check_outputs
    from pluto_bt.files import refuse_shadowed_packages
    from pluto_bt.inputs.option_values import read_positive
    from pluto_bt.inputs.reading import read_inputs

    refuse_shadowed_packages()
    faults = Faults()
    check_outputs(args, faults)
    doors = read_doors(args, faults)
    speed, max_time_s = read_positive(args.speed, "--speed", faults), read_positive(args.max_time, "--max-time", faults)
    inputs = read_inputs(request_of(args), faults=faults)
    for warning in inputs.warnings:
        print(warning.as_text(), file=sys.stderr)
    from pluto_bt.runner import make_runner  # heavy: only once there is something to run

    has_gateway = args.realtime or doors.take_orders or doors.ssh is not None
    progress = _progress(sys.stderr if args.json else sys.stdout, args.watch)
    runner = make_runner(
        inputs, realtime=args.realtime, speed=speed or 1.0, max_time_s=max_time_s, trace_path=args.trace, record=args.record,
        resume=_resume(args), doors=doors, on_event=progress.event, on_progress=progress.show, on_compiling=lambda: _tell_of_compilation(has_gateway),
    )  # fmt: skip
    progress.attach(runner.mission)
    with runner.interruptible():
        result = runner.run()
    progress.end(result)
    if args.plot:
        _draw(args.plot, runner)
        progress.line(f"picture: {args.plot}")
    return result


def _draw(path: str, runner: Runner) -> None:
    from pluto_bt.commands.map_picture import draw_run  # matplotlib: only for who wants a picture

    draw_run(path, runner)
