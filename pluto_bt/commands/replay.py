"""`pluto replay FILE`: a recorded run, tick by tick, forward and back; or run again on what it saw."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from pluto_bt.commands.files import find_file
from pluto_bt.commands.options import Parser
from pluto_bt.source import Faults, PlutoError

if TYPE_CHECKING:
    from pluto_bt.record.box import Box

KEYS = "Enter or n = next, p = back, +N and -N = so many ticks, at T = to a time (s), c = next change, q = leave"


def main(argv: list[str]) -> int:
    """Show a run, or repeat it; exit 1 if the repetition differs."""
    parser = Parser(prog="pluto replay", description="Show a recorded run: what happened, or everything at one time.")
    parser.add_argument("file", metavar="FILE.mcap")
    parser.add_argument("--at", metavar="T", help="the tree and the blackboard at this time of the run (s)")
    parser.add_argument("--step", action="store_true", help=f"go through it by hand: {KEYS}")
    parser.add_argument("--execute", action="store_true", help="run the real tree on the recorded inputs and tell the first tick that differs")
    parser.add_argument("--contracts", action="store_true", help="check the mission's contracts over the run; exit 1 if one is broken")
    parser.add_argument("--mission", metavar="M.xml", help="with --execute, --contracts: take this mission, such as a newer version of it")
    parser.add_argument("--web", nargs="?", const="", metavar="HOST:PORT", help="show it in the web console, with a slider for the time")
    args = parser.parse_args(argv)
    from pluto_bt.commands.boxes import read_box, read_time

    faults = Faults()
    at_s = read_time(args.at, "--at", faults)
    if args.web is not None:
        from pluto_bt.commands.doors import check_web

        check_web(args.web, faults)
    faults.raise_errors()
    box = read_box(args.file)
    if args.web is not None:
        return show_in_browser(box, args.file, args.web)
    if args.execute:
        return execute(box, args.mission)
    if args.contracts:
        return contracts(box, args.mission)
    if not len(box):
        print("no tick was recorded", file=sys.stderr)
        return 1
    if args.step:
        return step(box, at_s or 0.0)
    if at_s is not None:
        return show(box, box.number_at(at_s))
    from pluto_bt.record.story import changes

    for change in changes(box):
        print(f"{change.t_s:9.2f} s  tick {change.number + 1:<6} {change.what}: {change.words}".rstrip(": "))
    return 0


def show(box: Box, number: int) -> int:
    """One tick."""
    from pluto_bt.commands.moment import moment

    print(moment(box, number))
    return 0


def show_in_browser(box: Box, name: str, address: str) -> int:
    """Serve the console on the recording until Ctrl-C."""
    from pluto_bt.box_moments import Moments
    from pluto_bt.commands.doors import web_address
    from pluto_bt.gateway.listen import Address, open_listener
    from pluto_bt.gateway.web.recorded import RecordedSite

    moments = Moments(box)
    site = RecordedSite(moments.scenery(name), moments.at)
    listener = open_listener(web_address(address), option="--web")
    print(f"{name} is shown at http://{Address(*listener.getsockname()[:2])}/ (Ctrl-C ends)", flush=True)
    with suppress(KeyboardInterrupt):
        site.serve(listener)
    return 0


def execute(box: Box, mission: str | None = None) -> int:
    """Repeat the run, or let another mission have its inputs."""
    from pluto_bt.playback import PlaybackError, differences

    try:
        found, ticks = differences(box, mission=None if mission is None else Path(mission), most=1)
    except PlaybackError as error:
        print(f"pluto replay: {error}", file=sys.stderr)
        return 2
    if found:
        print(f"differs from {found[0]}")
        return 1
    cut = "" if ticks == len(box) else f"; the recorded inputs end there, {len(box) - ticks} ticks before the file does"
    print(f"{ticks} ticks executed again, all identical{cut}")
    return 0


def _rules(name: str) -> Path:
    """A file with contracts, as given or among the shipped missions. Raises: InputError."""
    faults = Faults()
    path = find_file("mission", name, faults)
    faults.raise_errors()
    assert path is not None  # else there was a fault
    return path


def contracts(box: Box, mission: str | None) -> int:
    """The contracts over the run."""
    from pluto_bt.contract_report import check_box
    from pluto_bt.trees.loader.contracts import contracts_in

    with box.unpacked() as files:
        path = _rules(mission) if mission is not None else files / box.run.mission
        found = contracts_in(path, mission or box.run.mission)
    if not found:
        print(f"{mission or box.run.mission} has no contracts")
        return 0
    kept = check_box(box, found)
    for one in kept:
        told = one.as_json()
        print(f"{told['verdict']:<10} {told['name']}: {told['always']}" + (f" (never judged: {told['problem']})" if told["problem"] else ""))
        for breach in one.breaches:
            end = "to the end" if breach.until_s is None else f"to {breach.until_s:.2f} s"
            print(f"           did not hold from {breach.since_s:.2f} s {end}, broken at {breach.broken_s:.2f} s")
    return 1 if any(one.breaches for one in kept) else 0


def step(box: Box, at_s: float) -> int:
    """Go through a run by hand; commands are read from the input, a line each."""
    number, is_asked = box.number_at(at_s), sys.stdin.isatty()
    if is_asked:
        print(KEYS)
    while True:
        show(box, number)
        try:
            words = input("replay> " if is_asked else "").split()
        except EOFError:
            return 0
        if words[:1] in (["q"], ["quit"]):
            return 0
        try:
            number = min(max(_moved(words)(box, number), 0), len(box) - 1)
        except (PlutoError, ValueError, OverflowError):  # "at inf" is no time either
            print(KEYS, file=sys.stderr)
        print()


def _moved(words: list[str]) -> Callable[[Box, int], int]:
    """Where a line leads. Raises: ValueError if it means nothing."""
    if not words or words == ["n"]:
        return lambda box, number: number + 1
    if words == ["p"]:
        return lambda box, number: number - 1
    if words == ["c"]:
        return _next_change
    if words[0] == "at" and len(words) == 2:
        at_s = float(words[1])
        return lambda box, number: box.number_at(at_s)
    if len(words) == 1 and words[0][0] in "+-":
        count = int(words[0])
        return lambda box, number: number + count
    raise ValueError(words[0])


def _next_change(box: Box, number: int) -> int:
    from pluto_bt.record.story import changes

    return next((change.number for change in changes(box) if change.number > number), len(box) - 1)
