"""Commands about the mission."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

from pluto_bt.gateway.client import Element
from pluto_bt.gateway.shell.codes import DONE, FAILED, FailedError
from pluto_bt.gateway.shell.driving import Act, inputs
from pluto_bt.gateway.shell.face import Face
from pluto_bt.gateway.shell.robot import Robot
from pluto_bt.gateway.xml_text import element, escape

OVER = ("succeeded", "failed", "aborted")
_DECLARATION = re.compile(r"^\ufeff?\s*<\?xml[^>]*\?>")


async def status(robot: Robot, face: Face) -> int:
    """The mission and who drives, in one line."""
    mission, lease = await robot.request("mission", op="state"), await robot.request("lease", op="query")
    driver = f"{lease.get('holder')} drives" if lease.get("holder") else "nobody drives"
    face.say(f"mission {mission.get('name') or '-'}: {_told(mission)}; {driver}")
    return DONE


def order(op: str) -> Act:
    """Pause, resume or abort, then the status."""

    async def act(robot: Robot, face: Face) -> int:
        await robot.request("mission", op=op)
        return await status(robot, face)

    return act


async def missions(robot: Robot, face: Face) -> int:
    """The missions that can be run by name."""
    reply = await robot.request("mission", op="list")
    face.say("\n".join(mission.get("name", "") for mission in reply.iter("mission")))
    return DONE


async def run(robot: Robot, face: Face, name: str, settings: tuple[str, ...] = ()) -> int:
    """Load a mission, start it, and watch it to its end (not with a `&` at the end)."""
    waits = settings[-1:] != ("&",)
    ports = inputs(settings if waits else settings[:-1])
    before = await robot.request("mission", op="state")
    path = Path(name)
    given = "".join(element("p", {"name": port}, escape(value)) for port, value in ports.items())
    if face.may_read_files and path.is_file():
        await robot.request("mission", given + _document(path.read_text(encoding="utf-8"), name), op="load", name=path.name)
    else:
        await robot.request("mission", given, op="load", name=name if name.endswith(".xml") else f"{name}.xml")
    await robot.request("mission", op="start")
    if waits:
        return await _watch(robot, face, int(before.get("run", "0")))
    face.say(f"{name} runs")
    return DONE


async def trip2(robot: Robot, face: Face) -> int:
    """The car's scripted trip."""
    return await run(robot, face, "trip2.xml")


async def _watch(robot: Robot, face: Face, before: int) -> int:
    """Show the mission that began after run number `before`, until it is over."""
    async with (await robot.client()).stream("subscribe", topic="mission") as values:
        while True:
            state = {part.tag: part.text or "" for part in await values.next()}
            if int(state.get("run", "0")) <= before:
                continue
            if state.get("state") in OVER:
                face.say(": ".join(filter(None, (state["state"], state.get("reason")))))
                return DONE if state["state"] == "succeeded" else FAILED
            face.progress(f"{state.get('state')} at {state.get('step') or state.get('name')}")


def _told(mission: Element) -> str:
    reason, step = mission.get("reason"), mission.get("step")
    return f"{mission.get('state')}{f' ({reason})' if reason else ''}{f' at {step}' if step else ''}"


def _document(text: str, name: str) -> str:
    """The mission as it goes into a message: as it is, but for the declaration. Raises: FailedError for what is no XML."""
    text = _DECLARATION.sub("", text)
    try:
        ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        line, column = error.position
        raise FailedError(f"{name}:{line}:{column + 1}: {error}; `pluto check {name}` tells more, `pluto fmt` mends what it can") from None
    return text
