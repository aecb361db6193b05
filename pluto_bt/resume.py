"""Going on after a crash: what the journal tells, whether it is sane to go on, and what the policy makes of it.

The robot stays still until that is decided. `hold` waits for an operator, `ask` asks at the terminal, `resume` goes on at the step that was
running; whatever is not sane is held, whatever the policy.
"""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pluto_bt.inputs.reading import Inputs
from pluto_bt.modules.resume_parameters import ResumeParameters
from pluto_bt.runtime.state_folder import state_path
from pluto_bt.source import Faults, Place
from pluto_bt.trees import Mission, memory
from pluto_bt.trees.journal import NoJournalError, Past, Pose, read_journal

HELD = "held"


@dataclass(frozen=True)
class ResumeRequest:
    """What a person asked for.

    Attributes:
        policy: hold, ask or resume.
        journal: where the journal lies; None = `journal_path`.
        is_placed: he gave the start pose, and so says where the robot stands; else it stands where it was left.
        confirm: asks a person a question; used by the policy `ask` alone.
    """

    policy: str
    journal: Path | None = None
    is_placed: bool = False
    confirm: Callable[[str], bool] = lambda question: False


@dataclass
class Resumption:
    """What was decided.

    Attributes:
        path: the journal to keep from now on. `past`: what it begins with.
        start: where the robot was left; None = as asked for.
        told: "" or what there was to go on with. `held`: "" or the sentence that tells why the mission waits for an operator.
        is_resumed: the mission goes on, now or when an operator says so, where an earlier run was cut off.
    """

    path: Path
    past: Past
    start: Pose | None = None
    told: str = ""
    held: str = ""
    is_resumed: bool = False


def journal_path(inputs: Inputs) -> Path:
    """Where the journal of these inputs lies if no file is named: one for each mission, with its tree and ports, and world."""
    key = "\n".join([os.path.realpath(inputs.mission_path), str(inputs.tree), repr(sorted(inputs.ports.items())), inputs.world.file, inputs.platform])
    return state_path() / "journals" / f"{inputs.mission_path.stem}-{hashlib.sha256(key.encode()).hexdigest()[:12]}.jsonl"


def hashes_of(inputs: Inputs, mission: Mission) -> dict[str, str]:
    """What must be the same for a mission to go on: its text, the map, the robot. Raises: OSError if a file has gone."""
    asked = f"{inputs.tree} {sorted(inputs.ports.items())}"
    a_priori = inputs.map or inputs.world
    return {"mission": _hash(mission.origin.files, asked), "map": _hash(a_priori.files, ""), "platform": _hash((), repr(inputs.robot))}


def _hash(files: Sequence[str], words: str) -> str:
    digest = hashlib.sha256(words.encode())
    for path in files:
        digest.update(Path(path).read_bytes())
    return digest.hexdigest()


def decide(request: ResumeRequest, inputs: Inputs, mission: Mission, now_ns: int) -> Resumption:
    """Look at the journal, and let the mission remember what it tells; `now_ns` of the calendar.

    Raises: InputError if the journal's file is something else. OSError if a file of the run cannot be read.
    """
    path, start = request.journal or journal_path(inputs), inputs.start if request.is_placed else None
    hashes = hashes_of(inputs, mission)
    past = _read(path)
    if past is None or not past.has_begun:
        return Resumption(path, Past(hashes))
    doubts = _doubts(past, hashes, start, now_ns, inputs.robot.resume)
    is_same = past.damaged_line != 1 and past.hashes.get("mission") == hashes["mission"]
    if is_same and past.state["nodes"]:
        doubts += [f"entry {key} could not be kept" for key in memory.give_back(mission, past.state)]
    told = _told(past, now_ns)
    if doubts:
        on = "goes on all the same" if is_same else "begins it anew"
        held = f"{told}; going on is in doubt: {'; '.join(doubts)}. `pluto shell resume` {on}"
    elif request.policy == "resume" or (request.policy == "ask" and request.confirm(f"{told}. Go on where it was?")):
        held = ""
    else:
        held = f"{told}; it waits for an operator: `pluto shell resume`, or --resume resume"
    where = past.truth if start is None else None
    kept = replace(past, hashes=hashes) if is_same else Past(hashes, damaged_line=past.damaged_line)
    return Resumption(path, kept, where, told, held, is_same)


def _read(path: Path) -> Past | None:
    """The journal. Raises: InputError for a file that is none, or cannot be read: it must not be written over."""
    try:
        return read_journal(path)
    except (NoJournalError, OSError) as error:
        faults = Faults()
        found = error.strerror or str(error) if isinstance(error, OSError) else "something else"
        what, expected = "this file is no journal of a mission, and is left as it is", "a journal that `pluto run --resume` has kept, or no file"
        mend = "name another file with --journal, or move this one away"
        faults.error(Place(str(path)), "no-journal", what, expected=expected, found=found, mend=mend)
        faults.raise_errors()
        raise


def _told(past: Past, now_ns: int) -> str:
    ago = f" {(now_ns - past.wall_ns) / 1e9:.0f} s ago" if past.wall_ns else ""
    return f"a run of this mission was cut off{ago}, " + (f"after {past.finished[-1][0]} had ended" if past.finished else "before a step had ended")


def _doubts(past: Past, hashes: dict[str, str], start: Pose | None, now_ns: int, limits: ResumeParameters) -> list[str]:
    """Why going on may not be sane; one sentence each."""
    found = [f"the journal is damaged at line {past.damaged_line}, and what was done after that is not known"] if past.damaged_line else []
    if past.hashes:
        found += [f"the {name} has changed" for name, digest in hashes.items() if past.hashes.get(name) != digest]
    age_s = (now_ns - past.wall_ns) / 1e9
    if past.wall_ns and not 0.0 <= age_s <= limits.max_age_s:
        found.append(f"the journal is {age_s:.0f} s old; {limits.max_age_s:g} s are allowed (resume.max_age_s)")
    if start is not None and past.pose is not None:
        away_m = math.hypot(start[0] - past.pose[0], start[1] - past.pose[1])
        turned_deg = abs(math.degrees(math.remainder(start[2] - past.pose[2], math.tau)))
        if away_m > limits.max_distance_m or turned_deg > limits.max_turn_deg:
            found.append(f"the robot is {away_m:.2f} m and {turned_deg:.0f} deg from where it was left")
    if past.state["nodes"] and past.pose is None and past.truth is None:
        found.append("it is not known where the robot was left")
    return found
