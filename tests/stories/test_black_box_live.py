"""A run in threads that people interfere with: `why` answers while it goes on, and the box of it all is executed again, tick for tick."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest

from pluto_bt.blackboard.messages import Message
from pluto_bt.cli import main
from pluto_bt.commands.record import record
from pluto_bt.doors import Doors
from pluto_bt.gateway.client import Client, GatewayError
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.why import causes_of, lines
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.playback import replay_file
from pluto_bt.record.box import open_box
from pluto_bt.runner import Runner, make_runner
from pluto_bt.source import Faults
from pluto_bt.trees.why_box import why_at

LONG_S = 60.0


def ask(client: Client, at_s: float | None = None) -> tuple[bool, list[dict[str, Any]]]:
    """Does it move, and the causes."""
    return causes_of(client.request("why", **({} if at_s is None else {"at": at_s})))


class Live:
    """A robot at work in threads of this process, with a client."""

    def __init__(self, runner: Runner) -> None:
        self.runner = runner
        self._thread = threading.Thread(target=runner.run)
        self._thread.start()
        address = runner.system.part("gateway").component.address  # type: ignore[union-attr]
        self.client = Client(address.host, address.port, session="test", timeout_s=LONG_S)

    def wait_until(self, is_so: Callable[[], bool]) -> None:
        """Ask again and again, listening to the gateway in between."""
        give_up_s = self.runner.system.clock.now_s() + LONG_S
        while not is_so():
            assert self.runner.system.clock.now_s() < give_up_s
            self.client.receive(0.05)

    def end(self) -> None:
        self.client.close()
        self.runner.loop.interrupt()
        self._thread.join(LONG_S)


@pytest.fixture
def live(tmp_path: Path) -> Iterator[Live]:
    inputs = read_inputs(Request("patrol.xml", world="yard.xml", platform="pioneer", port=["goals=8,3;2,3.5", "rounds=9"]))
    robot = Live(make_runner(inputs, realtime=True, doors=Doors(gateway=Address(port=0)), record=tmp_path / "a.mcap"))
    yield robot
    robot.end()


def test_who_listens_from_outside_has_what_the_robot_said(live: Live, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The recording of a listener and the robot's own tell the same values of the same topics."""
    live.wait_until(lambda: ask(live.client)[0])
    address = live.runner.system.part("gateway").component.address  # type: ignore[union-attr]
    assert record(tmp_path / "heard.mcap", f"{address.host}:{address.port}", ["motion/*", "Localization/Pose"], 1.5) == 0
    live.end()
    heard, own = (open_box(tmp_path / name, name, Faults()) for name in ("heard.mcap", "a.mcap"))
    assert heard is not None and own is not None and heard.run.mode == "watched"
    names = ("motion/status", "Localization/Pose")
    told = {name: {sample.seq: sample.value for sample in samples} for name, samples in own.samples(names).items()}
    for name, samples in heard.samples(names).items():
        both = [(sample.value, told[name][sample.seq]) for sample in samples if sample.seq in told[name]]
        assert len(both) >= 10 and all(a.stamp_s == pytest.approx(b.stamp_s, abs=1e-6) for a, b in both)
        assert all(replaced(a) == replaced(b) for a, b in both)
    for command in ("info", "plot"):
        assert main([command, str(tmp_path / "heard.mcap")]) == 0
    assert main(["replay", str(tmp_path / "heard.mcap")]) == 2
    assert "no ticks of a tree" in capsys.readouterr().err


def replaced(message: Message) -> Message:
    """The same, but for the stamp, which goes over the wire in microseconds."""
    return msgspec.structs.replace(message, stamp_s=0.0)


def test_why_is_answered_while_people_interfere_and_the_box_repeats_it_all(live: Live, tmp_path: Path) -> None:
    client = live.client
    live.wait_until(lambda: ask(client)[0])
    is_moving, causes = ask(client)
    assert is_moving and [cause["layer"] for cause in causes] == ["node", "mission"]
    moved_s = live.runner.system.clock.now_s()
    client.request("stop")
    live.wait_until(lambda: not ask(client)[0])
    is_moving, causes = ask(client)
    assert (causes[0]["layer"], causes[0]["code"]) == ("operator", "operator-stop") and "resume" in causes[0]["unblock"]
    assert lines(is_moving, causes)[1].startswith("  because operator: operator-stop since ")
    assert ask(client, moved_s)[0], "so far back it still remembers"
    with pytest.raises(GatewayError, match="known are 0"):
        ask(client, 1e6)
    client.lease("acquire")
    client.request("run", node="MakeTurn", angle_deg="40")  # an errand while the mission waits
    live.wait_until(lambda: live.runner.system.executive.core.errand is not None and live.runner.system.executive.core.errand.is_over)
    client.lease("release")
    client.request("mission", op="resume")
    live.wait_until(lambda: ask(client)[0])
    live.end()
    faults = Faults()
    box = open_box(tmp_path / "a.mcap", "a.mcap", faults)
    assert box is not None and [tree.role for tree in box.trees.values()] == ["mission", "errand"]
    first = why_at(box, causes[0]["since_s"] + 0.3).first
    assert first is not None and (first.layer, first.code) == ("operator", "operator-stop"), "recorded and live tell the same"
    assert replay_file(tmp_path / "a.mcap") == []
