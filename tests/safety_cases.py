"""What stops the robot: one row a cause, with the time that the parameters promise. `test_safety.py` plays each; `docs/safety.md` shows them.

Each story begins with an ATRV-2 that drives at its top speed, 0.9 m/s, over an open field; at T_S the cause sets in.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pluto_bt.behaviours.reasons import WAITING
from pluto_bt.loop import THREADS_LIMIT_S
from pluto_bt.modules.base import DEAD_MAN_S
from pluto_bt.modules.robot_file import RobotFile, load_robot_file

T_S = 6.0
SPEED_MPS = 0.9
ROBOT = load_robot_file("atrv2")
DRIVING = '<GoTo name="drive" goal="50;0" max_speed_mps="0.9"/>'


def fault(device: str, kind: str) -> str:
    """A line of the world's script."""
    return f'<at t="{T_S:g}"><fault device="{device}" kind="{kind}"/></at>'


def braking_s(robot: RobotFile, speed_mps: float = SPEED_MPS) -> float:
    """From a command of zero velocity until the wheels stand: the drive's step, the motors' dead time, the ramp, four times the motors' lag."""
    limits = robot.limits
    return robot.drive.period_s + limits.motor_latency_s + speed_mps / limits.deceleration_mps2 + 4.0 * limits.motor_time_constant_s


def scan_s(robot: RobotFile) -> float:
    """Until avoidance has looked at the next scan: its period, its way over the line, avoidance's step."""
    laser = robot.devices.laser
    assert laser is not None
    return 1.0 / laser.rate_hz + laser.arrival_delay_s + robot.avoid.period_s


def scan_age_s(robot: RobotFile) -> float:
    """Until the stop filter finds the newest scan too old: the age of a scan that is a quarter of a period late, and a step."""
    laser = robot.devices.laser
    assert laser is not None
    return laser.arrival_delay_s + 1.25 / laser.rate_hz + robot.filter.period_s


@dataclass(frozen=True)
class Cause:
    """One row.

    Attributes:
        notice_s: the longest time until zero velocity is commanded, from the parameters.
        measured_s: from the cause to standing wheels, as played when this row was written.
        result: result and reason of the run if the cause does not clear.
    """

    name: str
    noticed_by: str
    notice_s: Callable[[RobotFile], float]
    measured_s: float
    status: str
    result: str
    clears: str
    script: str = ""
    tree: str = DRIVING
    stop: bool = False
    from_s: float = T_S

    @property
    def limit_s(self) -> float:
        """At rest after so long at the latest."""
        return self.notice_s(ROBOT) + braking_s(ROBOT)


AT_ONCE: Callable[[RobotFile], float] = lambda robot: 0.0  # noqa: E731  # a name makes the table readable
NEW_MISSION = "a new run"
CAUSES: tuple[Cause, ...] = (
    Cause("an operator says stop", "every link, woken at once", AT_ONCE, 1.1, "drive stopped", "FAILURE stopped", "resume, or a new command",
          stop=True),
    Cause("the mission halts the leaf", "the leaf posts zero velocity in the same tick", AT_ONCE, 1.1, "–", "FAILURE timeout",
          "the next motion leaf", tree=f'<Timeout msec="{1000 * T_S:g}">{DRIVING}</Timeout>'),
    Cause("no new command", "drive", lambda robot: robot.drive.timeout_s, 5.0, "drive [0] = −1", "STOPPED max-time", "a new command",
          tree="<SaysItOnce/>", from_s=0.0),
    Cause("laser: fatal error", "avoidance, at the next scan", scan_s, 1.3, "avoid [0] = 7", "STOPPED max-time",
          "ranges come again (about 20 s); the drive goes on by itself", fault("laser", "fatal")),
    Cause("laser: silent", "stop filter, by the scan's age", scan_age_s, 1.2, "avoid [0] = 6",
          "FAILURE laser-stale", "scans come again within 5 s", fault("laser", "off")),
    Cause("laser: no numbers", "avoidance, by the share of holes", scan_s, 1.3, "avoid [0] = 6", "FAILURE laser-stale", "as above",
          fault("laser", "nan")),
    Cause("laser: always the same", "stop filter, after 2 cm of driving, avoidance after 3 cm", scan_s, 1.3, "avoid [0] = 6", "FAILURE laser-stale",
          "as above", fault("laser", "stuck")),
    Cause("sonar: silent", "avoidance, by the echoes' age; the stop filter slows before",
          lambda robot: robot.avoid.sonar_stale_s + robot.avoid.period_s, 1.3, "avoid [0] = 3",
          "FAILURE sonar-stale", "echoes come again within 5 s", fault("sonar", "off")),
    Cause("bumpers: silent", "stop filter, by their age", lambda robot: robot.filter.bumper_stale_s + robot.filter.period_s, 1.3,
          "drive: bumper-stale", "FAILURE bumper-stale", "readings come again within 5 s", fault("bumpers", "off")),
    Cause("odometry: silent", "drive, by its age", lambda robot: robot.drive.odometry_stale_s + robot.drive.period_s, 1.3,
          "drive: odometry-stale", "STOPPED base-lost", "odometry comes again within 2 s", fault("odometry", "off")),
    Cause("no position", "avoidance, by its age", lambda robot: robot.avoid.pose_stale_s + robot.avoid.period_s, 1.3, "avoid: no-pose",
          "FAILURE no-pose", "a position comes again within 3 s", fault("module:local", "off")),
    Cause("base: off or unplugged", "the base itself", lambda robot: DEAD_MAN_S, 1.3, "–", "STOPPED base-lost", NEW_MISSION, fault("base", "off")),
    Cause("module drive is stopped", "base has zero velocity at once", AT_ONCE, 1.1, "drive [0] = −10", "FAILURE chain-stopped",
          "start the module", fault("module:drive", "off")),
    Cause("module avoid is stopped", "drive has zero velocity at once", AT_ONCE, 1.1, "avoid [0] = −10", "FAILURE chain-stopped",
          "start the module", fault("module:avoid", "off")),
    Cause("module motion is stopped", "the leaf; avoidance goes on till then", lambda robot: WAITING["chain-stopped"] + 0.1, 2.1,
          "motion [3] = −10", "FAILURE chain-stopped", "start the module", fault("module:motion", "off")),
    Cause("the executive is stopped", "itself", AT_ONCE, 1.1, "drive stopped", "STOPPED max-time", "start the module",
          fault("module:executive", "off")),
    Cause("module drive, avoid, motion, local or executive raises", "supervision", AT_ONCE, 1.1, "drive stopped", "STOPPED module-error",
          "it is started again after 0.1, 0.2, 0.4 s, and the mission goes on by itself; the fourth failure ends the run",
          fault("module:avoid", "raise")),
    Cause("module base raises", "the base: no command for 0.3 s", lambda robot: DEAD_MAN_S, 1.3, "–", "STOPPED module-error", "as above",
          fault("module:base", "raise")),
    Cause("a leaf raises, or gives no status", "the executive, in the same tick", AT_ONCE, 1.1, "drive stopped", "STOPPED leaf-error", NEW_MISSION,
          fault("leaf:drive", "raise")),
    Cause("a leaf or module hangs", "the watchdog; in lockstep a scripted hang at once", lambda robot: THREADS_LIMIT_S, 1.1, "drive stopped",
          "STOPPED hung", NEW_MISSION, fault("leaf:drive", "hang")),
    Cause("the run's time is over (`--max-time`), Ctrl-C", "the run", AT_ONCE, 1.1, "drive stopped", "STOPPED max-time", NEW_MISSION, from_s=14.0),
)  # fmt: skip
