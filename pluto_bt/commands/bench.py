"""`pluto bench`: the project's figures, measured on this machine, as ratios or counts in one run."""

from __future__ import annotations

import importlib
import sys

from pluto_bt.commands.options import Parser

BENCHES = {
    "stack": "the whole robot in lockstep: × real time, and where the time goes",
    "rays": "laser scans against the plain versions",
    "sim_step": "the simulator alone, against Stage's figure and ir-sim",
    "stop-times": "from a cause to zero velocity, 1000 trials each",
    "faults": "two things break at once, in places drawn at random",
    "tick": "a tick of the tree against stock py_trees",
    "movement": "patrols, goto, moveto, explore and investigate in worlds drawn at random, with and without people",
    "check": "a mission of 10 000 nodes, loaded and checked",
    "patrols": "patrols over random courses in places nobody tuned to",
    "repeat": "runs with one seed: equal traces",
    "refusals": "the worst of broken inputs: time and memory until they are refused",
    "startup": "`pluto --help` and the first tick of a mission",
    "trips": "the car's trip2, 100 loops on 40 seeds, and with one thing wrong",
    "jbot": "1000 feet out and back between trees: where the robot believes to be",
    "replay": "100 recorded runs executed again, in lockstep and in threads; what recording costs",
    "resume": "kill -9 at every tick of a mission, then go on",
    "fanout": "one value to 1000 clients of the gateway, against plain uvloop writes and foxglove-sdk",
    "gateway": "requests a second, parsing and encoding against lxml, what clients and a killed gateway cost the robot",
    "console": "STOP in a browser, `ssh ROBOT stop` and Ctrl-C to a command of zero; what logins by ssh cost the robot",
    "attacks": "what clients who mean harm cost the others, and how fast a stop is meanwhile",
    "memory": "memory of an hour's simulated run",
}


def main(argv: list[str]) -> int:
    """Run the named benchmarks, or all; prints one line a figure."""
    parser = Parser(prog="pluto bench", description="Measure, and print ratios. " + "; ".join(f"{name}: {text}" for name, text in BENCHES.items()))
    parser.add_argument("name", nargs="*", metavar="NAME", help=f"one of: {', '.join(BENCHES)} (default: all)")
    args = parser.parse_args(argv)
    unknown = [name for name in args.name if name not in BENCHES]
    if unknown:
        from pluto_bt.source import did_you_mean

        print(f'pluto bench: no benchmark "{unknown[0]}"; {did_you_mean(unknown[0], BENCHES) or "one of: " + ", ".join(BENCHES)}', file=sys.stderr)
        return 2
    for name in args.name or BENCHES:
        print(f"{name}: {BENCHES[name]}   (repeat: pluto bench {name})")
        for row in importlib.import_module(f"pluto_bt.bench.{name.replace('-', '_')}").run():
            value = f"{row.value:.4g} {row.unit}".rstrip()
            print(f"  {row.name:<46} {value:>14}   {row.target:<22} {row.note}".rstrip(), flush=True)
    return 0
