"""Words for docs/reasons.md that the program itself does not hold: reasons of a whole run, meanings of the chain's status codes."""

from __future__ import annotations

RUN_REASONS: dict[str, tuple[str, str, str]] = {  # word → result, meaning, cure; the words are those of pluto_bt.behaviours.reasons if it has them
    "max-time": ("STOPPED", "", ""),
    "stopped": ("STOPPED", "", ""),
    "interrupted": ("STOPPED", "", ""),
    "leaf-error": ("STOPPED", "", ""),
    "module-error": ("STOPPED", "", ""),
    "hung": ("STOPPED", "", ""),
    "base-lost": ("STOPPED", "", ""),
    "skipped": ("FAILURE", "the root of the mission was skipped", "look at its `_skipIf` and at those of its children"),
    "failed": ("FAILURE", "the deciding leaf gave no reason of its own", "see the last statuses in `--json`, or `--watch`"),
    "bad-input": ("REFUSED", "a file or an option is wrong; nothing has moved", "each fault says what was expected, what was found, how to mend it"),
}

STATUS_MEANINGS: dict[tuple[str, str], tuple[str, str]] = {  # by enum and name: codes of equal value would be one key
    ("LinkStatus", "NORMAL"): ("the velocity in force is the one asked for", "–"),
    ("LinkStatus", "COMMAND_TIMEOUT"): ("no new command for 4 s; a controlled stop", "send a command"),
    ("LinkStatus", "STOPPED_THREAD"): ("the link's thread is stopped", "start the module"),
    ("LinkStatus", "FRONT_BUMPER"): ("the front bumper is or was pressed: no way forward, no turn", "back off until it is free, then send a command"),
    ("LinkStatus", "BACK_BUMPER"): ("the back bumper is or was pressed: no way back, no turn", "drive on until it is free, then send a command"),
    ("LinkStatus", "SONAR_FRONT"): ("slowed or stopped by an echo ahead, or by a silent sonar", "clear the way; see `reason`"),
    ("LinkStatus", "SONAR_BACK"): ("slowed or stopped by an echo behind", "clear the way"),
    ("LinkStatus", "SONAR_SIDES"): ("slowed or stopped by an echo at the side", "clear the way"),
    ("LinkStatus", "LASER_SLOW_STOP"): ("slowed or stopped by what the laser sees, or by an untrusted laser", "clear the way; see `reason`"),
    ("LinkStatus", "LASER_FATAL"): ("the laser had a fatal error and reboots", "wait about 20 s"),
    ("GotoStatus", "NONE"): ("no goto", "–"),
    ("GotoStatus", "REACHED"): ("the goal is reached; stays until the next command", "–"),
    ("GotoStatus", "STUCK"): ("goto gave up; stays until the next command", "another goal, or another way"),
    ("GotoStatus", "RUNNING"): ("goto drives", "–"),
    ("GotoStatus", "STOPPED_THREAD"): ("avoidance's thread is stopped", "start the module"),
    ("MovetoStatus", "NONE"): ("no moveto", "–"),
    ("MovetoStatus", "SET"): ("a moveto is set", "–"),
    ("MovetoStatus", "NEAR_GOAL"): ("near the goal, simple goto", "–"),
    ("MovetoStatus", "AT_GOAL"): ("at the goal", "–"),
    ("MovetoStatus", "INVESTIGATE_DONE"): ("the object has been circled", "–"),
    ("MotionStatus", "STOPPED_THREAD"): ("motion's thread is stopped", "start the module"),
    ("MotionStatus", "AT_REST_WITH_RECTANGLE"): ("at rest, a rectangle is set", "–"),
    ("MotionStatus", "AT_REST"): ("at rest, no rectangle", "–"),
    ("MotionStatus", "SCANNING_FOR_PATHS"): ("scans for paths", "–"),
    ("MotionStatus", "FOLLOWING_PATH"): ("follows a path", "–"),
    ("MotionStatus", "APPROACHING_OBJECT"): ("approaches an object", "–"),
    ("MotionStatus", "CIRCLING_OBJECT"): ("circles it", "–"),
}  # fmt: skip
