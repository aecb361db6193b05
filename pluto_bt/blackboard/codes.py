"""The codes of the command chain, as in the Pluto manual (DESIGN.md, section 3). The wire carries the number and, beside it, the name."""

from __future__ import annotations

from enum import IntEnum


class CommandType(IntEnum):
    """The ones digit T of `cmdFlags = 10*A + T`."""

    VELOCITY = 0
    REGULATOR = 1
    GOTO = 2
    WALL_FOLLOW = 3


class Avoidance(IntEnum):
    """The tens digit A of `cmdFlags = 10*A + T`: which sensors slow, stop and steer."""

    NONE = 0
    SONAR = 1
    LASER = 2
    BOTH = 3


class MotionCommand(IntEnum):
    """`cmdFlags` that only the motion link understands, and the release that every link does."""

    RELEASE = -1
    MOVETO = 42
    INVESTIGATE = 43
    EXPLORE = 44
    RESUME = 45
    SET_RECTANGLE = 46


class LinkStatus(IntEnum):
    """`element[0]` of drive, avoid and motion: why the velocity in force is not the one asked for."""

    NORMAL = 0
    COMMAND_TIMEOUT = -1
    STOPPED_THREAD = -10
    FRONT_BUMPER = 1
    BACK_BUMPER = 2
    SONAR_FRONT = 3
    SONAR_BACK = 4
    SONAR_SIDES = 5
    LASER_SLOW_STOP = 6
    LASER_FATAL = 7


class GotoStatus(IntEnum):
    """`element[1]` of avoid and motion."""

    NONE = 0
    REACHED = 1
    STUCK = 2
    RUNNING = -1
    STOPPED_THREAD = -10


class MovetoStatus(IntEnum):
    """`element[2]` of motion."""

    NONE = 0
    SET = -1
    NEAR_GOAL = -2
    AT_GOAL = 1
    INVESTIGATE_DONE = 2


class MotionStatus(IntEnum):
    """`element[3]` of motion."""

    STOPPED_THREAD = -10
    AT_REST_WITH_RECTANGLE = -1
    AT_REST = 0
    SCANNING_FOR_PATHS = 1
    FOLLOWING_PATH = 3
    APPROACHING_OBJECT = 11
    CIRCLING_OBJECT = 12


class Setter(IntEnum):
    """Who adjusts the pose: `cmdFlags` of the interfaces 2, 3 and 4."""

    JUST_SET = -1
    NOBODY = 0
    POSE = 1
    SLAM = 2
    SLAM_SAVING = 3


STATUS_ENUMS: tuple[type[IntEnum], ...] = (LinkStatus, GotoStatus, MovetoStatus, MotionStatus)


def code_name(code: IntEnum) -> str:
    """The name on the wire: `APPROACHING_OBJECT` becomes `approaching-object`."""
    return code.name.lower().replace("_", "-")


def status_name(element: int, code: int) -> str:
    """The name of `element[element] == code` of a chain status, or the number itself if it is not listed."""
    try:
        return code_name(STATUS_ENUMS[element](code))
    except (ValueError, IndexError):
        return str(code)


def split_flags(flags: int) -> tuple[Avoidance, CommandType] | None:
    """(A, T) of a pass-through `cmdFlags`, or None if the flags are not listed (they are refused with `bad-command`)."""
    avoidance, kind = divmod(flags, 10)
    if flags < 0 or avoidance > max(Avoidance) or kind > max(CommandType):
        return None
    return Avoidance(avoidance), CommandType(kind)
