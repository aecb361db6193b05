"""Where the wrist holds the laser: what it said around a moment, or, where it has fallen silent, whether it can be anywhere else."""

from __future__ import annotations

from pluto_bt.blackboard import Blackboard, Snapshot
from pluto_bt.blackboard.messages import ActuatorState, Pair
from pluto_bt.blackboard.poses import actuator_at

SOON_S = 0.1  # two periods: the next reading is on its way
STILL_RADPS, THERE_RAD = 0.02, 0.035  # slower, and so near to where it was sent, it stands


def wrist_at(board: Blackboard | Snapshot, stamp_s: float) -> Pair | None:
    """Pan and tilt in radians at a time; None if nobody knows.

    A silent wrist still is where it stood when it was last heard, unless it was sent elsewhere since: so one that was stopped at rest does
    not blind the robot, and one that falls silent in the middle of a sweep does.
    """
    then = actuator_at(board, "wrist/state", stamp_s)
    if then is not None:
        return then
    newest, sent = board.newest("wrist/state"), board.newest("wrist/command")
    if newest is None or not isinstance(state := newest.value, ActuatorState):
        return None
    if stamp_s < state.stamp_s - SOON_S:
        return None  # older than the history
    if stamp_s - state.stamp_s <= SOON_S:
        return state.position
    stands = max(map(abs, state.velocity)) < STILL_RADPS
    if sent is not None and isinstance(command := sent.value, ActuatorState):
        off_rad = max(abs(a - b) for a, b in zip(command.position, state.position, strict=True))
        stands = stands and command.stamp_s <= state.stamp_s and off_rad < THERE_RAD
    return state.position if stands else None
