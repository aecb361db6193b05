"""The post box of localisation: where interface 2 (`Localization/Post_Pose`) takes improved poses from whoever has them.

A topic has one writer, but the pose and slam modules, the marker camera and an operator all improve the pose. They post here;
`local` takes the posts, and publishes the last accepted one as `Localization/Post_Pose`, as a link of the chain publishes its command.
"""

from __future__ import annotations

import threading
from collections import deque

from pluto_bt.blackboard.codes import Setter
from pluto_bt.blackboard.inbox import WRONG_STATE
from pluto_bt.blackboard.messages import Pose

CONFLICT = "conflict"
BAD_VALUE = "bad-value"
SLAM = (Setter.SLAM, Setter.SLAM_SAVING)


def refusal(setter: int, now_set_by: int) -> str:
    """ "" if a post with `setter` may follow `now_set_by`, else why not (DESIGN.md, section 9).

    A set-pose only from 0 or −1, else `wrong-state`; pose and slam at once, `conflict`; a setter that is not listed, `bad-value`.
    """
    if setter not in tuple(Setter):
        return BAD_VALUE
    if setter == Setter.JUST_SET:
        return "" if now_set_by in (Setter.NOBODY, Setter.JUST_SET) else WRONG_STATE
    both = {setter in SLAM, now_set_by in SLAM}
    is_other = setter > 0 and now_set_by > 0 and len(both) == 2
    return CONFLICT if is_other else ""


class PostBox:
    """Posts in the order they came, and who sets the pose now (kept by `local`). Thread-safe."""

    LIMIT = 64  # a poster that runs wild loses its oldest posts

    def __init__(self) -> None:
        self.set_by: int = Setter.NOBODY
        self._posts: deque[tuple[str, Pose]] = deque(maxlen=self.LIMIT)
        self._lock = threading.Lock()

    def post(self, source: str, pose: Pose) -> str:
        """Leave a pose: setter < 0 = the robot's at its stamp, > 0 = the laser's at its scan's stamp, 0 = nobody sets it any more.

        Returns "" or why it is refused.
        """
        refused = refusal(pose.setter, self.set_by)
        if not refused:
            with self._lock:
                self._posts.append((source, pose))
        return refused

    def take(self) -> list[tuple[str, Pose]]:
        """All posts since the last call, oldest first."""
        if not self._posts:
            return []
        with self._lock:
            posts = list(self._posts)
            self._posts.clear()
        return posts
