"""One client before a gateway without sockets, whose every answer is held against the schema."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from lxml import etree

from pluto_bt import gateway
from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.local import LocalGateway
from tests.gateway.robot import FakeRobot

SCHEMA = etree.XMLSchema(etree.parse(str(Path(gateway.__file__).with_name("protocol.xsd"))))
LIMITS = Limits(message_bytes=2048, mission_bytes=4096)


class Play:
    """A fresh robot and a fresh client."""

    def __init__(self) -> None:
        self.robot = FakeRobot()
        self.robot.write("tree", m.TreeState(0.0, 1))
        self.gateway = LocalGateway(self.robot, LIMITS)
        self.client = self.gateway.connect()

    def feed(self, pieces: Iterable[bytes]) -> None:
        """The client sends; then the robot takes its time."""
        for piece in pieces:
            self.client.send(piece)
        for _ in range(3):
            self.robot.time_s += 0.02
            self.gateway.step(self.robot.time_s)

    def heard(self) -> list[bytes]:
        """The lines that came, sorted, for what the robot answers comes later; at most the last one said is fatal."""
        lines = self.client.received().splitlines()
        for line in lines:
            SCHEMA.assertValid(etree.fromstring(line))
        assert not [line for line in lines[:-1] if b'fatal="true"' in line]
        return sorted(lines)


def deeds_that_move(did: list[tuple[object, ...]]) -> list[object]:
    """What a robot would have moved by."""
    return [deed[0] for deed in did if deed[0] in ("run", "command")]
