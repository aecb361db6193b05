"""`pluto record FILE`: topics of a running robot, written down from outside over its gateway."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Final

from pluto_bt.commands.gateway_call import gateway_parser, reach, tell_refusal
from pluto_bt.source import Faults

if TYPE_CHECKING:
    from pluto_bt.gateway.client import Client, Element

RATE_HZ: Final = 10.0  # of each topic that nobody asked for by name
SILENCE_S: Final = 5.0


def main(argv: list[str]) -> int:
    """Listen until the time is over, the robot ends its run, or Ctrl-C."""
    parser = gateway_parser("record", "Write down the topics of a running robot from outside; `pluto run --record` tells more.")
    parser.add_argument("file", metavar="FILE.mcap", help="the file to write")
    about = f"every value of this topic, or of all that begin as in NAME* (default: all topics, each {RATE_HZ:g} times a second at most)"
    parser.add_argument("--topic", metavar="NAME", action="append", default=[], help=about)
    parser.add_argument("--seconds", metavar="S", help="stop after so much time of the robot's clock")
    args = parser.parse_args(argv)
    from pluto_bt.commands.extras import need
    from pluto_bt.commands.outputs import check_file
    from pluto_bt.inputs.option_values import read_positive

    faults = Faults()
    seconds = read_positive(args.seconds, "--seconds", faults)
    if need("record", args.file, faults):
        check_file(args.file, "FILE", (".mcap",), faults)
    faults.raise_errors()
    return record(Path(args.file), args.gateway, args.topic, seconds)


def record(to: Path, address: str, topics: list[str], seconds: float | None) -> int:
    """Write the file; 1 if there is no robot, or it knows no such topic."""
    from pluto_bt.gateway.backoff import AGAIN
    from pluto_bt.gateway.client import GatewayError

    try:
        with reach(address, name="record", backoff=AGAIN) as client:
            mission = client.request("mission", op="state")
            for topic in topics or ["*"]:
                client.subscribe(topic, max_rate_hz=0.0 if topics else RATE_HZ)
            count = write(to, mission.get("name", ""), heard(client, seconds))
    except GatewayError as error:
        tell_refusal("record", error)
        return 1
    print(f"{to}: {count} messages")
    return 0


def heard(client: Client, seconds: float | None) -> Iterator[Element]:
    """Every `<value>` until the end; Ctrl-C and the end of the robot's run are ends like any other."""
    from pluto_bt.gateway.client import GatewayError

    begun_s: float | None = None
    try:
        while (message := client.receive(SILENCE_S)) is not None:
            if message.tag != "value":
                continue
            begun_s = time_of(message) if begun_s is None else begun_s
            if seconds is not None and time_of(message) - begun_s > seconds:
                return
            yield message
    except (GatewayError, KeyboardInterrupt):
        return


def time_of(value: Element) -> float:
    """When the robot sent it, by its own clock (s)."""
    return float(value.get("stamp", "0")) + float(value.get("age", "0"))


def write(to: Path, mission: str, values: Iterator[Element]) -> int:
    """Write what is heard; how many messages. The index is written whatever happens."""
    from pluto_bt import __version__
    from pluto_bt.blackboard import Sample
    from pluto_bt.gateway.read_values import message_of
    from pluto_bt.record.watched import KINDS, WatchedWriter

    writer = WatchedWriter(to, mission, __version__)
    try:
        for value in values:
            topic = value.get("topic", "")
            if topic in KINDS:  # a robot of another version may have others
                writer.take(topic, Sample(message_of(KINDS[topic], value), int(value.get("seq", "0")), time_of(value)))
    finally:
        writer.finish()
    return writer.count
