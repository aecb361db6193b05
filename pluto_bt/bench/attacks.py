"""`pluto bench attacks`: what clients who mean harm cost the others, beside a robot on patrol; and how fast it stops meanwhile."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import numpy as np

from pluto_bt.bench.attacker import CROWDS, STREAMS, begin
from pluto_bt.bench.live import Live, drive_on, on_patrol
from pluto_bt.bench.resident import resident_mb
from pluto_bt.bench.row import BenchRow
from pluto_bt.gateway.client import Client
from pluto_bt.runtime.clock import wait, wall_ns

FLOODS = ("pings", "stops", "gets", "describes", "new-names")
ENDLESS = ("attribute", "text", "name", "comment", "white-space", "mission", "mission-names", "attributes", "depth", "mission-depth")
GROUPS = {
    "endless messages": ENDLESS, "floods": FLOODS, "crowds": (*CROWDS, "storm", "documents"),
    "rubbish and bombs": tuple(name for name in STREAMS if name not in (*ENDLESS, *FLOODS)),
}  # fmt: skip
GROUP_S, PING_EVERY_S, SETTLE_S = 12.0, 0.006, 3.0
TRIALS = 150


def run() -> Iterator[BenchRow]:
    """All rows."""
    with on_patrol() as live:
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
                zero_ns = live.stood_ns()
                if zero_ns >= stopped_ns:  # else something had stopped it just before
                    delays_ms.append((zero_ns - stopped_ns) / 1e6)
    finally:
        flood.kill()
        flood.communicate()
    p99, worst = np.percentile(delays_ms, [99.0, 100.0], method="inverted_cdf")  # one in a hundred may be later
    note = f"{TRIALS} stops, median {float(np.median(delays_ms)):.1f} ms"
    yield BenchRow("<stop/> during a flood to a command of zero, p99", float(p99), "ms", "<= 20", note)
    yield BenchRow("<stop/> during a flood to a command of zero, worst", float(worst), "ms", "<= 100")
