"""Every reason that a leaf of the library gives when it fails or waits: one word, what it means, what to do. A closed list.

`docs/reasons.md` is generated from it. The links of the chain have their own words in `pluto_bt.skills.reasons`; where both mean the
same they use the same word.
"""

from __future__ import annotations

from typing import Final, NamedTuple


class Reason(NamedTuple):
    """What a word means, what a person can do, and whether the same attempt made once more may come out otherwise."""

    meaning: str
    cure: str
    retry: bool = False


REASONS: Final[dict[str, Reason]] = {
    # ended by the run itself, not by a leaf: max-time, interrupted, and those of supervision
    "base-lost": Reason("the base delivers nothing any more", "check the base, its cable and its power"),
    "contract": Reason("a contract of the mission was broken", "see which one in the message, and `pluto replay FILE --contracts`"),
    "held": Reason("a run that was cut off waits for an operator", "`pluto shell resume`, or start it with --resume resume"),
    "hung": Reason("a leaf or a module did not return", "look at the name in the message; a leaf's update() must return at once"),
    "interrupted": Reason("the run was ended from the keyboard", "start it again"),
    "leaf-error": Reason("a leaf raised an exception or returned no status", "see the node, file and line in the message"),
    "max-time": Reason("the run has lasted as long as --max-time allows", "give it more time"),
    "module-error": Reason(
        "a module that is needed failed: the mission waits till it runs again, and ends if it fails too often",
        "see its name and error in the message and in `pluto ps`",
    ),
    # of leaves
    "bad-command": Reason("a link of the chain refused the command", "see the status text of motion, avoidance and drive"),
    "bumper": Reason("a bumper is pressed", "drive back with DriveVelocity until it is released, then send a new command", True),
    "bumper-stale": Reason("the bumpers deliver nothing any more", "check the bumpers and their cable"),
    "cancelled": Reason("another command took the place of this leaf's command", "let only one motion leaf be active at a time"),
    "chain-stopped": Reason("a link of the command chain is stopped or takes no commands", "start the modules motion, avoid, drive and filter"),
    "command-timeout": Reason("drive had no new command for 4 s and stopped", "send commands more often, or use a leaf that refreshes its command"),
    "estop": Reason("the emergency stop is latched", "see to the cause, release the stop, then resume the mission or command anew"),
    "executive-silent": Reason("the executive has stopped working, so nothing may move", "look at the leaf or module named in the events"),
    "gyro-stale": Reason("the gyro delivers nothing, and the car does not know where it points", "check the gyro and its cable"),
    "hindered": Reason("the car is told to drive and its wheels stand still", "remove the obstacle; the car has no sensor that would see it", True),
    "laser-fatal": Reason("the laser had a fatal error and did not come back in time", "wait for its reboot (about 20 s), then try again"),
    "laser-stale": Reason("the laser is asked for and delivers nothing that can be trusted", "check the laser, or choose avoid=sonar"),
    "lost": Reason("the robot is not where wheels and gyro brought it, or its position is too uncertain", "post its pose, then go on"),
    "marker-stale": Reason(
        "no marker has passed for long, and the car reckons with wheels and gyro alone", "bring it under a marker, or look at camera and server"
    ),
    "no-device": Reason("the platform has no such device", "run the mission on a platform that has it"),
    "no-goal": Reason("the leaf was given no goal", "give one: --port goal=VALUE, or an entry that is written before"),
    "no-input": Reason("a port that the leaf needs has no value on this way", "write its entry on every way that leads there, see the message"),
    "no-object": Reason("there is nothing to investigate", "bring the robot nearer to the object", True),
    "no-path": Reason(
        "there is no way to the goal, on the map or as far as was seen",
        "see in the message what is too narrow or in the way: open it, choose another goal, or correct the map",
        True,
    ),
    "no-pose": Reason("there is no position to steer by, or it is too old", "check localisation: odometry, gyro bias, and for the car a marker"),
    "not-connected": Reason("the mission runs without a robot", "run it with a world, or on the robot"),
    "no-wall": Reason("wall follow sees no wall within reach, or none with room beside it", "bring the robot nearer to a wall"),
    "nothing-to-resume": Reason("nothing was stopped, and no rectangle was ever set", "start the motion anew"),
    "odometry-frozen": Reason("the wheels are told to turn and the encoders stand still", "free the wheels, or check the encoders"),
    "odometry-stale": Reason("the base delivers no odometry", "check the base"),
    "operator-stop": Reason("an operator stopped the robot and the mission waits", "resume the mission or send a new command"),
    "outside-map": Reason("the goal, or the straight way to it, leaves the mapped area", "choose a goal inside the mapped area, in straight reach"),
    "outside-rectangle": Reason("the goal or the start is outside the rectangle", "choose a goal inside, or set another rectangle"),
    "sonar-stale": Reason("the sonar is asked for and delivers nothing that can be trusted", "check the sonar, or choose avoid=laser"),
    "speed-stale": Reason("the wheel speed sensor delivers nothing, and the car does not know how far it has driven", "check the sensor and its bus"),
    "stopped": Reason("an operator stopped the robot", "resume the mission or send a new command"),
    "stuck": Reason("the robot gets no farther towards its goal or along its wall", "choose a goal with a clear way, or free it by hand", True),
    "target-lost": Reason("the one who was followed is not seen any more", "start following again when the target is near", True),
    "tilted": Reason("the robot leans farther than the platform allows", "bring it to level ground"),
    "timeout": Reason("the leaf's time was over", "give it more time (timeout_s), or see in the message what it waited for", True),
    "unseen": Reason("the way leads where no sensor ever looked, and there the robot creeps", "let it look first: turn, or drive forwards", True),
    "wall-lost": Reason("the wall that was followed is not there any more", "look what became of it, then start again near a wall"),
    "walker": Reason("somebody walks near the way, or may do so where no sensor looks, and the robot creeps or waits", "let them pass", True),
    "wrist-stale": Reason("the wrist says nothing, so nobody knows where the laser looks", "check the wrist and its cable, or choose avoid=sonar"),
    "wrong-state": Reason("the mission does not own the command inbox now", "give the lease back, or start motion again"),
}

BLIND: Final = ("laser-fatal", "laser-stale", "wrist-stale")  # the laser shows nothing that can be used
SENSORS: Final = ("laser-stale", "wrist-stale", "sonar-stale", "bumper-stale")
OUTAGE_S: Final = 5.0  # a sensor that delivers again after so long ends no mission
SETTLE_S: Final = 1.5  # … so much longer a leaf waits: till who delivers again has shown two scans in time, and is believed

WAITING: Final[dict[str, float]] = {
    # word → seconds for which a motion leaf lets the chain wait before it fails with that word
    "bumper": 4.0,  # who bumped into the robot goes on
    **dict.fromkeys(SENSORS, OUTAGE_S + SETTLE_S),
    "laser-fatal": 30.0,  # the reboot takes about 20 s
    "no-pose": 3.0,
    "gyro-stale": 3.0,
    "speed-stale": 3.0,
    "lost": 3.0,
    "no-wall": 3.0,
    "wall-lost": 0.0,
    "odometry-stale": 3.0,
    "odometry-frozen": 10.0,  # the wheels try again every second; escaping from it is another leaf's work
    "chain-stopped": 1.0,
    "stopped": 1.0,
    "outside-map": 1.0,  # a car that left its area and is not on an arc that leads back
}


def sentence(word: str) -> str:
    """What the word means, or the word itself for one from a leaf of the user's own."""
    reason = REASONS.get(word)
    return word if reason is None else reason.meaning


def may_pass(word: str) -> bool:
    """Whether a second try may help; of a word that is not in the list nobody knows, so it is worth one."""
    reason = REASONS.get(word)
    return reason is None or reason.retry
