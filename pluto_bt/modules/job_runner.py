"""Runs the jobs of motion: takes its orders, loads the library tree of the job, and tells how it stands in `motion/job`."""

from __future__ import annotations

from collections.abc import Callable
from importlib import resources
from typing import Any

import msgspec

from pluto_bt.behaviours.ports import text_of
from pluto_bt.blackboard.codes import Avoidance, MotionCommand, MovetoStatus, code_name
from pluto_bt.blackboard.messages import JobState
from pluto_bt.modules.context import Context
from pluto_bt.modules.job_link import JobLink
from pluto_bt.modules.local_map_shown import LocalMapShown
from pluto_bt.modules.robot_link import RobotLink
from pluto_bt.skills.jobs import Job
from pluto_bt.trees import Mission
from pluto_bt.trees.activity import PAUSED, RUNNING, SUCCEEDED
from pluto_bt.trees.executive import Executive

DONE = {MotionCommand.INVESTIGATE: MovetoStatus.INVESTIGATE_DONE}


class JobRunner:
    """Beside the executive's mission: at most one job."""

    def __init__(self, context: Context, core: Executive, robot: RobotLink, load: Callable[..., Mission]) -> None:
        self._context, self._core, self._robot, self._read = context, core, robot, load
        self._state = context.board.publisher("motion/job", "executive")
        self._map = LocalMapShown(context)
        self._job: Job | None = None
        self._link: JobLink | None = None
        self._shown: JobState | None = None

    def take_orders(self) -> None:
        """Begin or end what motion has ordered."""
        is_new, job = self._context.jobs.take()
        if not is_new:
            return
        self._core.note("job", text=msgspec.json.encode(job).decode())
        self._core.end_job("stopped")
        self._job = self._link = None
        if job is not None:
            self._begin(job)

    def tell(self, now_s: float) -> None:
        """Publish how the job stands, if that has changed; and its map."""
        activity = self._core.job
        if self._job is None or self._link is None or activity is None:
            return
        state = {SUCCEEDED: "succeeded", RUNNING: "running", PAUSED: "running"}.get(activity.state, "failed")
        self._tell(now_s, JobState(0.0, self._job.number, state, self._link.moveto, self._link.motion, activity.reason, activity.text))
        self._map.show(self._link.surroundings, now_s, is_last=state != RUNNING)
        if state != RUNNING:
            self._job = None

    def _begin(self, job: Job) -> None:
        self._job, self._link = job, JobLink(self._context, self._robot, job)
        self._link.surroundings.begin(job.rectangle, job.goes_on)
        mission = self._load(job)
        mission.attach(self._link)
        self._core.start_job(mission, self._link)

    def _load(self, job: Job) -> Mission:
        """The tree of a job with its ports."""
        avoid, parameters = code_name(Avoidance(job.avoid)), self._robot.surroundings.parameters
        home = job.place if job.rectangle is None else job.rectangle.inside(*job.place, parameters.home_depth_m)
        own: dict[MotionCommand, dict[str, Any]] = {
            MotionCommand.MOVETO: {"goal": job.place, "tolerance_m": parameters.tolerance_m},
            MotionCommand.EXPLORE: {"home": home},
            MotionCommand.INVESTIGATE: {"radius_m": job.radius_m, "turns": job.turns},
        }
        ports = {"avoid": avoid, "max_speed_mps": job.speed_mps, **own[job.kind]}
        path = resources.files("pluto_bt.trees") / "library" / f"{job.tree}.xml"
        return self._read(str(path), ports={name: text_of(value) for name, value in ports.items()})

    def _tell(self, now_s: float, state: JobState) -> None:
        if state != self._shown:
            self._shown = state
            self._state.put(msgspec.structs.replace(state, stamp_s=now_s), now_s)
