"""`pluto bench attacks`: what clients who mean harm cost the others, beside a robot on patrol; and how fast it stops meanwhile."""

from __future__ import annotations

import json
import subprocess
import threading
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from pluto_bt.bench.attacker import CROWDS, STREAMS, begin
from pluto_bt.bench.fanout import process_of
from pluto_bt.bench.resident import resident_mb
from pluto_bt.bench.row import BenchRow
from pluto_bt.gateway.client import Client
from pluto_bt.runtime.clock import NS, wait, wall_ns

FLOODS = ("pings", "stops", "gets", "describes", "new-names")
ENDLESS = ("attribute", "text", "name", "comment", "white-space", "mission", "mission-names", "attributes", "depth", "mission-depth")
GROUPS = {
    "endless messages": ENDLESS, "floods": FLOODS, "crowds": (*CROWDS, "storm", "documents"),
    "rubbish and bombs": tuple(name for name in STREAMS if name not in (*ENDLESS, *FLOODS)),
}  # fmt: skip
GROUP_S, PING_EVERY_S, SETTLE_S = 12.0, 0.006, 3.0
TRIALS, MOVING_MPS, PATIENCE_S = 150, 0.1, 30.0


class Live(NamedTuple):
    """A robot on patrol in a process of its own, and how to ask it."""

    process: subprocess.Popen[bytes]
    port: int

    def tells(self) -> dict[str, Any]:
        """What `live_robot` knows."""
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.write(b"\n")
        self.process.stdin.flush()
        told: dict[str, Any] = json.loads(self.process.stdout.readline())
        return told

    def client(self, name: str) -> Client:
        """A client of its gateway."""
        return Client(port=self.port, timeout_s=PATIENCE_S, name=name)


def run() -> Iterator[BenchRow]:
    """All rows."""
    with process_of("-m", "pluto_bt.bench.live_robot") as process:
        assert process.stdout is not None
        live = Live(process, int(process.stdout.readline()))
        with live.client(name="operator") as polite:
            pings_ms(live, polite, "never-read", 1.0)  # what is taken once and kept
            before_mb = settled_mb(live, polite)
            for group, attacks in GROUPS.items():
                yield _beside(live, polite, group, attacks)
            yield BenchRow("memory that the gateway has gained by all of them", settled_mb(live, polite) - before_mb, "MB", "< 10")
        yield from _stops(live)


# the others ----------------------------------------------------------------------------------------------------------
def _beside(live: Live, polite: Client, group: str, attacks: tuple[str, ...]) -> BenchRow:
    """A polite client beside each attack, in turns with a program in the attacker's place that only needs the processor."""
    each_s, attacked, quiet = GROUP_S / len(attacks), list[float](), list[float]()
    for attack in attacks:
        attacked += pings_ms(live, polite, attack, each_s)
        quiet += pings_ms(live, polite, "burn", each_s)
    theirs, calm = (float(np.quantile(delays, 0.999, method="higher")) for delays in (attacked, quiet))
    note = f"p99.9 of {len(attacked)} pings {theirs:.1f} ms, beside a burner {calm:.1f} ms"
    return BenchRow(f"a ping beside {group} ({len(attacks)}), less beside a burner", theirs - calm, "ms", "<= 20", note)


def pings_ms(live: Live, polite: Client, attack: str, seconds: float) -> list[float]:
    """How long each ping takes while the attack goes on."""
    delays_ms, pause = list[float](), threading.Event()
    with begin(attack, live.port, seconds) as process:
        while process.poll() is None:
            begun_ns = wall_ns()
            polite.request("ping")
            delays_ms.append((wall_ns() - begun_ns) / 1e6)
            wait(pause, PING_EVERY_S)
    return delays_ms


def settled_mb(live: Live, polite: Client) -> float:
    """Memory of the gateway's process when those who attacked have been let go."""
    pings_ms(live, polite, "burn", SETTLE_S)
    return resident_mb(int(live.tells()["pid"]))


# stops ---------------------------------------------------------------------------------------------------------------
def _stops(live: Live) -> Iterator[BenchRow]:
    """A passer-by without a lease stops the robot while others flood the gateway."""
    delays_ms = list[float]()
    flood = begin("pings", live.port, 600.0)
    try:
        with live.client(name="passer") as passer, live.client(name="operator") as operator:
            while len(delays_ms) < TRIALS:
                drive_on(operator)
                stopped_ns = wall_ns()
                passer.request("stop")
                zero_ns = stood_ns(live)
                if zero_ns >= stopped_ns:  # else something had stopped it just before
                    delays_ms.append((zero_ns - stopped_ns) / 1e6)
    finally:
        flood.kill()
        flood.communicate()
    p99, worst = np.percentile(delays_ms, [99.0, 100.0], method="inverted_cdf")  # one in a hundred may be later
    note = f"{TRIALS} stops, median {float(np.median(delays_ms)):.1f} ms"
    yield BenchRow("<stop/> during a flood to a command of zero, p99", float(p99), "ms", "<= 20", note)
    yield BenchRow("<stop/> during a flood to a command of zero, worst", float(worst), "ms", "<= 100")


def drive_on(operator: Client) -> None:
    """The mission goes on, and the robot moves."""
    if operator.request("mission", op="state").get("state") == "paused":
        operator.request("mission", op="resume")
    pause, until_ns = threading.Event(), wall_ns() + PATIENCE_S * NS
    while wall_ns() < until_ns:
        told = operator.request("get", topic="drive/status").findtext("data") or "0"
        if abs(float(told.split()[0])) > MOVING_MPS:
            return
        wait(pause, 0.02)
    raise TimeoutError("the robot does not move")


def stood_ns(live: Live) -> int:
    """When the base was told to stand, as it is now."""
    pause, until_ns = threading.Event(), wall_ns() + PATIENCE_S * NS
    while wall_ns() < until_ns:
        told = live.tells()
        if told["stands"]:
            return int(told["zero_ns"])
        wait(pause, 0.01)
    raise TimeoutError("the robot does not stop")
