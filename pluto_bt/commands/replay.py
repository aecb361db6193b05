"""`pluto replay FILE`: a recorded run, tick by tick, forward and back; or run again on what it saw."""

from __future__ import annotations

import argparse
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from pluto_bt.commands.options import Parser
from pluto_bt.commands.replay_by_hand import KEYS, go_through
from pluto_bt.files import find_file
from pluto_bt.source import Faults, Place

if TYPE_CHECKING:
    from pluto_bt.record.box import Box


def main(argv: list[str]) -> int:
    """Show a run, or repeat it; exit 1 if the repetition differs."""
    args = _parser().parse_args(argv)
    from pluto_bt.commands.boxes import read_box

    at_s, mission = _check(args)
    box = read_box(args.file)
    if args.web is not None:
        return show_in_browser(box, args.file, args.web)
    if args.execute:
        return execute(box, mission)
    if args.contracts:
        return contracts(box, mission)
    return look(box, at_s, args.step)


def _parser() -> Parser:
    parser = Parser(prog="pluto replay", description="Show a recorded run: what happened, or everything at one time.")
    parser.add_argument("file", metavar="FILE.mcap")
    parser.add_argument("--at", metavar="T", help="the tree and the blackboard at this time of the run (s)")
    parser.add_argument("--step", action="store_true", help=f"go through it by hand: {KEYS}")
    parser.add_argument("--execute", action="store_true", help="run the real tree on the recorded inputs and tell the first tick that differs")
    parser.add_argument("--contracts", action="store_true", help="check the mission's contracts over the run; exit 1 if one is broken")
    parser.add_argument("--mission", metavar="M.xml", help="with --execute, --contracts: take this mission, such as a newer version of it")
    parser.add_argument("--web", nargs="?", const="", metavar="HOST:PORT", help="show it in the web console, with a slider for the time")
    return parser


def _check(args: argparse.Namespace) -> tuple[float | None, Path | None]:
    """The time of `--at` and the file of `--mission`. Raises: InputError for what does not fit."""
    from pluto_bt.inputs.option_values import read_time

    faults = Faults()
    at_s = read_time(args.at, "--at", faults)
    mission = None if args.mission is None else find_file("mission", args.mission, faults)
    if mission is not None and not (args.execute or args.contracts):
        faults.error(Place(f"--mission {args.mission}"), "bad-option", "--mission goes with --execute or --contracts",
                     expected="--execute or --contracts", found="--mission alone", mend="add one of them, or drop --mission")  # fmt: skip
    if args.web is not None:
        from pluto_bt.commands.doors import read_web

        read_web(args.web, faults)
    faults.raise_errors()
    return at_s, mission


def look(box: Box, at_s: float | None, by_hand: bool) -> int:
    """What happened, or all of one tick, or one after the other."""
    if not len(box):
        print("no tick was recorded", file=sys.stderr)
        return 1
    if by_hand:
        go_through(box, at_s or 0.0)
    elif at_s is not None:
        from pluto_bt.commands.moment import moment

        print(moment(box, box.number_at(at_s)))
    else:
        from pluto_bt.record.story import changes

        for change in changes(box):
            print(f"{change.t_s:9.2f} s  tick {change.number + 1:<6} {change.what}: {change.words}".rstrip(": "))
    return 0


def show_in_browser(box: Box, name: str, address: str) -> int:
    """Serve the console on the recording until Ctrl-C."""
    from pluto_bt.box_moments import Moments
    from pluto_bt.doors import web_address
    from pluto_bt.gateway.listen import Address, open_listener
    from pluto_bt.gateway.web.recorded import RecordedSite

    moments = Moments(box)
    site = RecordedSite(moments.scenery(name), moments.at)
    listener = open_listener(web_address(address), option="--web")
    print(f"{name} is shown at http://{Address(*listener.getsockname()[:2])}/ (Ctrl-C ends)", flush=True)
    with suppress(KeyboardInterrupt):
        site.serve(listener)
    return 0


def execute(box: Box, mission: Path | None) -> int:
    """Repeat the run, or let another mission have its inputs."""
    from pluto_bt.playback import PlaybackError, differences

    try:
        found, ticks = differences(box, mission=mission, most=1)
    except PlaybackError as error:
        print(f"pluto replay: {error}", file=sys.stderr)
        return 2
    if found:
        print(f"differs from {found[0]}")
        return 1
    cut = "" if ticks == len(box) else f"; the recorded inputs end there, {len(box) - ticks} ticks before the file does"
    print(f"{ticks} ticks executed again, all identical{cut}")
    return 0


def contracts(box: Box, mission: Path | None) -> int:
    """The contracts over the run."""
    from pluto_bt.contract_report import check_box
    from pluto_bt.inputs.plugins import load_plugins
    from pluto_bt.trees.loader.contracts import contracts_in

    load_plugins(box.run.plugins, Faults())  # for their enums; a contract that lacks one says so
    with box.unpacked() as files:
        shown = box.run.mission if mission is None else str(mission)
        found = contracts_in(mission or files / box.run.mission, shown)
    if not found:
        print(f"{shown} has no contracts")
        return 0
    kept = check_box(box, found)
    for one in kept:
        told = one.as_json()
        how = "cannot be" if told["judged"] or told["breaches"] else "never"
        print(f"{told['verdict']:<10} {told['name']}: {told['always']}" + (f" ({how} judged: {told['problem']})" if told["problem"] else ""))
        for breach in one.breaches:
            end = "to the end" if breach.until_s is None else f"to {breach.until_s:.2f} s"
            print(f"           did not hold from {breach.since_s:.2f} s {end}, broken at {breach.broken_s:.2f} s")
    return 1 if any(one.breaches for one in kept) else 0
