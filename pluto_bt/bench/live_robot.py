"""A whole robot on patrol in real time, in a process of its own, which tells how punctual its ticks are. For the gateway's benchmarks.

`python -m pluto_bt.bench.live_robot [KEYS] [NAME=VALUE …]`, with parameters as `pluto run --set` takes them, prints the gateway's port; with a file
of keys also that of the ssh door and that of the web console. For each line it reads it prints, as JSON, how late the ticks have been since the
last line (ms), the gateway's process, the mission's state, when the base was last told to stand (wall, ns)
and whether it still is, and the events so far; it ends with its input.
"""

from __future__ import annotations

import json
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np

from pluto_bt.blackboard.messages import Event, MissionState
from pluto_bt.doors import Doors
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.ssh_link import SshRequest
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.runner import make_runner
from pluto_bt.runtime.clock import NS, wall_ns

PERIOD_MS = 100.0


def lateness_ms(ticks_ms: list[float]) -> list[float]:
    """How much later than the most punctual ticks, which came at their due times, each one came."""
    phases = np.array(ticks_ms or [0.0]) % PERIOD_MS
    around = (phases - np.median(phases) + PERIOD_MS / 2) % PERIOD_MS
    late: list[float] = np.clip(around - np.percentile(around, 5.0), 0.0, None).tolist()
    return late


class Ear:
    """Hears what the base is told."""

    def __init__(self, base: Any) -> None:
        self._own = base.drive
        self.stands = True
        self.zero_ns = 0
        base.drive = self._drive

    def _drive(self, speed_mps: float, turn_rate_radps: float) -> None:
        stands = speed_mps == turn_rate_radps == 0.0
        if stands and not self.stands:
            self.zero_ns = wall_ns()
        self.stands = stands
        self._own(speed_mps, turn_rate_radps)


def main(words: list[str]) -> None:
    """Patrol until the input ends; with a file of keys also by ssh, and with a web console."""
    keys = next((word for word in words if "=" not in word), "")
    settings = [word for word in words if word != keys]
    request = Request("patrol.xml", world="yard.xml", port=["goals=8,3;13.5,3;10.5,8;2,3.5", "rounds=-1"], set=settings)
    events: list[Event] = []
    anywhere = Address(port=0)
    doors = Doors(gateway=anywhere, web=anywhere, ssh=SshRequest(anywhere, Path(keys))) if keys else Doors(gateway=anywhere)
    runner = make_runner(read_inputs(request), realtime=True, doors=doors, on_event=events.append)
    system = runner.system
    ear = Ear(system.simulator.devices["base"])
    ticks_ms: list[float] = []
    system.executive.on_ticked = lambda activities, lines: ticks_ms.append(system.clock.now_ns() / (NS / 1000))
    thread = threading.Thread(target=runner.run)
    thread.start()
    found: list[Any] = [part.component for name in ("gateway", "ssh") for part in system.parts if part.module.name == name]
    gateway, *ssh = found
    ports = [gateway.address.port, *(door.address.port for door in ssh), *([gateway.console_address.port] if keys else [])]
    print(*ports, flush=True)
    for _ in sys.stdin:
        late_ms, ticks_ms[:] = lateness_ms(ticks_ms), []
        mission = system.board.newest("mission/state")
        state = mission.value.state if mission is not None and isinstance(mission.value, MissionState) else ""
        p50, p999, worst = np.percentile(late_ms, [50.0, 99.9, 100.0])
        told = {"late_ms": late_ms, "ticks": len(late_ms), "p50_ms": p50, "p999_ms": p999, "worst_ms": worst, "pid": gateway.pid, "mission": state}
        print(json.dumps(told | {"zero_ns": ear.zero_ns, "stands": ear.stands, "events": [event.code for event in events]}), flush=True)
    runner.loop.interrupt()
    thread.join()


if __name__ == "__main__":
    main(sys.argv[1:])
