"""The robot's software dies at once: SIGKILL for its whole process, while a base in another process listens. How long does that base drive on?

The software is the real one, in real time and threads: it drives its own simulated robot, and whatever it tells its base goes over a socket too.
At the other end a base of the simulator hears it; nothing but its own dead-man can stop it. `python -m pluto_bt.bench.killed SOCKET` is the
nursery, which warms up once and makes a robot (a process in a group of its own) for each number it reads.
"""

from __future__ import annotations

import os
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.maps.world import World
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.run_options import Options
from pluto_bt.runtime.clock import MonotonicClock, VirtualClock, wait
from pluto_bt.runtime.lockstep import Lockstep
from pluto_bt.system import System
from sim.motors import STOP, Motors
from sim.simtime import TICK_NS, SimTime

TOLD = struct.Struct("<dd")  # speed m/s, turn rate rad/s
HELLO = struct.Struct("<q")  # the process
PLATFORM, TWIST = "atrv2", (0.4, 0.25)
AT_ONCE = 8
LIVES_S, ORDER_EVERY_S, WAIT_S = 20.0, 0.2, 60.0
JITTER_S = 0.1  # about two commands


class Nursery:
    """Makes robots that can be killed."""

    def __enter__(self) -> Nursery:
        self._folder = tempfile.TemporaryDirectory()
        path = Path(self._folder.name) / "base"
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(str(path))
        self._listener.listen(AT_ONCE)
        self._listener.settimeout(WAIT_S)
        command = [sys.executable, "-m", "pluto_bt.bench.killed", str(path)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait(WAIT_S)
        self._listener.close()
        self._folder.cleanup()

    def robots(self, count: int) -> list[Base]:
        """So many new robots, each with the base that listens to it."""
        assert self._process.stdin is not None
        self._process.stdin.write(f"{count}\n".encode())
        self._process.stdin.flush()
        return [Base(self._listener.accept()[0]) for _ in range(count)]


class Base:
    """A base of the simulator at the end of a wire."""

    def __init__(self, wire: socket.socket) -> None:
        self._wire = wire
        wire.settimeout(WAIT_S)
        (self.process,) = HELLO.unpack(wire.recv(HELLO.size, socket.MSG_WAITALL))
        self._time = SimTime()
        self._motors = Motors(load_robot_file(PLATFORM).limits, self._time)

    def listen(self, clock: MonotonicClock, for_s: float) -> None:
        """Do as told until it drives, and then for a while."""
        while self._motors.command == STOP and self._hear(clock):
            pass
        until_s = clock.now_s() + for_s
        while clock.now_s() < until_s and self._hear(clock):
            pass

    def killed(self, clock: MonotonicClock) -> float | None:
        """Kill the software; gives for how long the base drove on after the last word it heard, or None if that word was to stand.

        On a busy machine the software is late now and then, and makes the robot stand for a moment: such a death shows nothing.
        """
        os.killpg(self.process, signal.SIGKILL)
        while self._hear(clock):
            pass
        self._wire.close()
        self._motors.advance(self._time.now_ns + 10 * TICK_NS)  # what was on its way to the motors
        if self._motors.command == STOP:
            return None
        heard_ns = at_ns = self._time.now_ns
        while self._motors.command != STOP:
            at_ns += TICK_NS
            self._motors.advance(at_ns)
        return (at_ns - heard_ns) / 1e9

    def _hear(self, clock: MonotonicClock) -> bool:
        """One command; False if nobody is there any more."""
        try:
            told = self._wire.recv(TOLD.size, socket.MSG_WAITALL)
        except ConnectionResetError:
            return False
        if len(told) < TOLD.size:
            return False
        self._time.jump_to(max(self._time.now_ns, clock.now_ns()))
        self._motors.advance(self._time.now_ns)
        self._motors.drive(*TOLD.unpack(told))
        return True


def killed_times_s(trials: int, seed: int) -> list[float]:
    """Seconds from the last command that a base heard until it stopped by itself, its software killed at a random moment; one for each trial.

    Raises: RuntimeError if of so many robots again as there are trials none was driving.
    """
    rng, times, stood = np.random.default_rng(seed), list[float](), 0
    with Nursery() as nursery:
        while len(times) < trials and stood <= trials:
            clock = MonotonicClock()
            for base in nursery.robots(min(AT_ONCE, trials - len(times))):
                base.listen(clock, float(rng.uniform(0.0, JITTER_S)))
                took_s = base.killed(clock)
                times += [] if took_s is None else [took_s]
                stood += took_s is None
    if stood > trials:
        raise RuntimeError(f"{stood} of {stood + len(times)} robots stood when they were killed")
    return times


# ---------------------------------------------------------------------- the other process


def _system(clock: VirtualClock | MonotonicClock) -> System:
    return System(Options(world=World("field"), robot=load_robot_file(PLATFORM), start=(0.0, 0.0, 0.0)), clock)


def _circle(system: System) -> None:
    """A velocity, through the whole chain."""
    system.inboxes["motion"].post("mission", ActuatorState(system.clock.now_s(), 0, (0.0, 0.0), TWIST))


def _live(path: str) -> None:
    """One robot: drives in circles until it is killed."""
    os.setpgid(0, 0)
    wire = socket.socket(socket.AF_UNIX)
    wire.connect(path)
    wire.sendall(HELLO.pack(os.getpid()))
    system = _system(MonotonicClock())
    base: Any = system.simulator.devices["base"]
    own = base.drive

    def drive(speed_mps: float, turn_rate_radps: float) -> None:
        own(speed_mps, turn_rate_radps)
        wire.sendall(TOLD.pack(speed_mps, turn_rate_radps))

    base.drive = drive
    system.start_parts()
    system.scheduler.start()
    while system.clock.now_s() < LIVES_S:
        _circle(system)
        wait(threading.Event(), ORDER_EVERY_S)


def nursery(path: str) -> None:
    """Warm up, then a robot for each that is asked for."""
    system = _system(VirtualClock())
    system.start_parts()
    assert isinstance(system.scheduler, Lockstep)
    system.scheduler.start()
    for k in range(1, 11):
        _circle(system)
        system.scheduler.run_until(k * 200_000_000)
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the dead
    for line in sys.stdin:
        for _ in range(int(line)):
            if os.fork() == 0:
                try:
                    _live(path)
                finally:
                    os._exit(0)


if __name__ == "__main__":
    nursery(sys.argv[1])
