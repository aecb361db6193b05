"""`pluto why [FILE] [--at T]`: the chain of causes, the first cause first, of a recorded run or of one that goes on."""

from __future__ import annotations

import json
import sys
from typing import Any

from pluto_bt.commands.options import Parser
from pluto_bt.source import Faults

COLUMNS = ("layer", "code", "since", "text")


def main(argv: list[str]) -> int:
    """Print the answer."""
    parser = Parser(prog="pluto why", description="Tell why the robot is, or is not, moving: the chain of causes, the first cause first.")
    parser.add_argument("file", nargs="?", metavar="FILE.mcap", help="a black box; without one, the robot behind --gateway is asked")
    parser.add_argument("--at", metavar="T", help="at this time of the run (s); default: its end, or now")
    parser.add_argument("--gateway", metavar="HOST:PORT", default="127.0.0.1:7500")
    parser.add_argument("--json", action="store_true", help="one JSON object")
    args = parser.parse_args(argv)
    from pluto_bt.inputs.option_values import read_time

    faults = Faults()
    at_s = read_time(args.at, "--at", faults)
    faults.raise_errors()
    if args.file is None:
        return _live(args.gateway, at_s, args.json)
    from pluto_bt.commands.boxes import read_box
    from pluto_bt.trees.why_box import end_s, why_at

    box = read_box(args.file)
    if not len(box):
        print("no tick was recorded", file=sys.stderr)
        return 1
    answer, over_s = why_at(box, at_s), end_s(box)
    ended = "" if over_s is None or (at_s is not None and at_s < over_s) else f" when the run ended, at {over_s:.1f} s"
    _print(answer.is_moving, [cause._asdict() for cause in answer.causes], args.json, ended)
    return 0


def _live(address: str, at_s: float | None, as_json: bool) -> int:
    from pluto_bt.commands.gateway_call import call
    from pluto_bt.gateway.why import causes_of

    answer = call("why", address, "why", **({} if at_s is None else {"at": str(at_s)}))
    if answer is None:
        return 1
    is_moving, causes = causes_of(answer)
    _print(is_moving, causes, as_json)
    return 0


def _print(is_moving: bool, causes: list[dict[str, Any]], as_json: bool, ended: str = "") -> None:
    """`ended`: the words for an answer that speaks of the end of a run that is over."""
    if as_json:
        print(json.dumps({"moving": is_moving, "causes": causes}, ensure_ascii=False))
        return
    from pluto_bt.gateway.why import lines

    verdict, *told = lines(is_moving, causes)
    print("\n".join([verdict + ended, *told]))
