"""What breaks, what becomes of the mission, and how soon the robot stands: one row a fault. `stories/test_faults.py` plays each; `docs/safety.md`
shows them.

A patrol drives through a hall at 0.5 m/s, past a post, with the default avoidance; at T_S the fault sets in.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

T_S = 5.0
GOES_ON = math.inf
HALL = """<world name="hall" seed="1">
  <wall id="fence">-6,-4 6,-4 6,4 -6,4 -6,-4</wall> <circle id="post" x="0.5" y="0.2" r="0.15"/> <polygon id="crate">3,-2 4,-2 4,-1 3,-1</polygon>
  <robot name="pluto" platform="{platform}" x="-4.5" y="0" theta_deg="0"/>
  <script>{script}</script>
</world>"""


@dataclass(frozen=True)
class FaultCase:
    """One row.

    Attributes:
        script: what happens at T_S.
        outcome: result and reason of the run; "" after SUCCESS.
        zero_within_s: from the fault to a command of zero; GOES_ON = it need not stop.
        said: a word that the run gives as reason of motion or as event meanwhile.
        first: the code that `why` gives as first cause, at the end of a run that failed, else while the robot stands; "" is `said`.
        how: what notices it, and what the robot does then.
    """

    name: str
    script: str
    outcome: str
    zero_within_s: float
    said: str
    how: str
    platform: str = "atrv2"
    first: str = ""

    @property
    def asked(self) -> str:
        """The first cause that `why` must name; "" where nothing stops the robot."""
        return "" if self.outcome == "SUCCESS" and self.zero_within_s == GOES_ON else self.first or self.said


def fault(device: str, kind: str, more: str = "") -> str:
    """A `<fault>` element."""
    return f'<fault device="{device}" kind="{kind}" {more}/>'


# fmt: off
CASES: tuple[FaultCase, ...] = (
    FaultCase("laser off", fault("laser", "off"), "FAILURE laser-stale", 0.5, "laser-stale", "stop filter, by the scan's age"),
    FaultCase("laser frozen: old scans again and again", fault("laser", "frozen"), "FAILURE laser-stale", 0.5, "laser-stale", "as above"),
    FaultCase("laser stuck while moving: new stamps, old content", fault("laser", "stuck"), "FAILURE laser-stale", 0.5, "laser-stale",
              "stop filter and avoidance: the same scan though the robot moves"),
    FaultCase("laser NaN", fault("laser", "nan"), "FAILURE laser-stale", 0.5, "laser-stale", "stop filter and avoidance, by the share of holes"),
    FaultCase("half the beams NaN", fault("laser", "nan", 'beams="0-180"'), "FAILURE laser-stale", 0.5, "laser-stale", "as above"),
    FaultCase("laser at 2 Hz", fault("laser", "slow", 'rate="2"'), "FAILURE laser-stale", 0.7, "laser-stale", "stop filter, by the scan's age"),
    FaultCase("laser 400 ms late", fault("laser", "late", 'delay="0.4"'), "FAILURE laser-stale", 0.5, "laser-stale", "as above"),
    FaultCase("laser fatal, back after 20 s", fault("laser", "fatal"), "SUCCESS", 0.5, "laser-fatal",
              "status 7: the mission waits, then goes on by itself"),
    FaultCase("sonar stuck at 8 m", fault("sonar", "stuck", 'value="8"'), "SUCCESS", GOES_ON, "", "nothing; the laser sees what stands in the way"),
    FaultCase("sonar stuck at 0", fault("sonar", "stuck", 'value="0"'), "FAILURE stuck", 0.5, "sonar",
              "drive: an echo at the skin on all sides; goto gives up"),
    FaultCase("bumper stuck", fault("bumpers", "stuck", 'value="1"'), "FAILURE bumper", 0.1, "bumper", "every link, at once"),
    FaultCase("bumpers off", fault("bumpers", "off"), "FAILURE bumper-stale", 0.5, "bumper-stale", "stop filter and drive, by their age"),
    FaultCase("odometry frozen: old readings", fault("odometry", "frozen"), "FAILURE no-pose", 0.5, "no-pose",
              "stop filter and drive, by its age", first="odometry-stale"),
    FaultCase("odometry stuck: new stamps, old counts", fault("odometry", "stuck"), "FAILURE odometry-frozen", 0.5, "odometry-frozen",
              "stop filter: commanded wheels that count nothing; tries again every second"),
    FaultCase("base 300 ms late", fault("base", "late", 'delay="0.3"'), "FAILURE odometry-stale", 0.5, "odometry-stale",
              "stop filter and avoidance: the odometry does not reach to where the scans were taken"),
    FaultCase("base blocked", fault("base", "blocked"), "FAILURE odometry-frozen", 0.5, "odometry-frozen", "as above"),
    FaultCase("full wheel slip", fault("base", "slip"), "FAILURE stuck", GOES_ON, "wheel-slip",
              "cross-check: the laser sees no way; it is believed, so goto sees that it comes no nearer"),
    FaultCase("a little wheel slip", fault("base", "slip", 'value="0.3"'), "SUCCESS", GOES_ON, "wheel-slip",
              "cross-check: the wheels' way is believed as far as they grip"),
    FaultCase("gyro bias jumps by 0.3 rad/s", fault("imu", "jump", 'value="0.3"'), "SUCCESS", GOES_ON, "gyro-drift",
              "cross-check: laser and wheels deny it; the drift is taken off, the heading put right"),
    FaultCase("gyro bias jumps by 0.03 rad/s", fault("imu", "jump", 'value="-0.03"'), "SUCCESS", GOES_ON, "gyro-drift",
              "as above, after some seconds"),
    FaultCase("gyro stuck", fault("imu", "stuck"), "SUCCESS", GOES_ON, "gyro-refused", "as above, again and again: then the wheels stand in"),
    FaultCase("gyro garbage", fault("imu", "garbage"), "SUCCESS", GOES_ON, "gyro-refused", "no robot turns so fast: the wheels stand in"),
    FaultCase("odometry jumps by 2 m", fault("odometry", "jump", 'value="2"'), "SUCCESS", GOES_ON, "odometry-jump",
              "localisation: no robot drives so fast; the step counts as standing still"),
    FaultCase("kidnapped, to another corner", '<place id="pluto" x="4.5" y="2.5" theta_deg="120"/>', "FAILURE lost", 1.0, "lost",
              "cross-check: the scan fits nowhere near; the robot stands until its pose is posted"),
    FaultCase("kidnapped, 0.8 m aside", '<place id="pluto" x="-3" y="0.8"/>', "FAILURE lost", 1.0, "lost",
              "cross-check: no wheels move a robot sideways"),
    FaultCase("wrist says 17° too much", fault("wrist", "jump", 'value="0.3"'), "FAILURE lost", GOES_ON, "lost",
              "cross-check: what the laser sees does not move as the robot does"),
    FaultCase("fatal laser while the gyro drifts", fault("laser", "fatal") + fault("imu", "jump", 'value="0.2"'), "SUCCESS", 0.5, "gyro-bias-changed",
              "while the robot waits it stands, and so finds the gyro's new bias", first="laser-fatal"),
    FaultCase("stop filter switched off", fault("module:filter", "off"), "FAILURE chain-stopped", 0.5, "chain-stopped",
              "the base, by its dead-man; drive, by the filter's silence", first="module-stopped"),
    FaultCase("the leaf raises", fault("leaf:go", "raise"), "STOPPED leaf-error", 0.2, "leaf-error", "the executive, in the same tick"),
)
# fmt: on
