"""Commands that only ask."""

from __future__ import annotations

import math

from pluto_bt.gateway.client import GatewayError
from pluto_bt.gateway.shell.codes import DONE, FailedError
from pluto_bt.gateway.shell.driving import Act
from pluto_bt.gateway.shell.face import Face
from pluto_bt.gateway.shell.robot import Robot
from pluto_bt.gateway.shell.telling import event_line, shown
from pluto_bt.gateway.why import causes_of, lines
from pluto_bt.gateway.xml_text import Attribute

EVENTS_SHOWN = 20
POSES = ("Localization/Dead-Reckoning", "Localization/Laser_Dead-Reckoning", "Localization/Post_Pose", "Localization/Pose", "Localization/Laser_Pose")


async def pose(robot: Robot, face: Face) -> int:
    """Where the robot believes to be; degrees, for a person reads it."""
    value = await robot.request("get", topic="Localization/Pose")
    x_m, y_m, _, theta_rad, *_ = map(float, (value.findtext("pose") or "").split())
    face.say(f"x {x_m:.3f} m   y {y_m:.3f} m   theta {math.degrees(theta_rad):.1f}°   (age {value.get('age')} s)")
    return DONE


async def tree(robot: Robot, face: Face) -> int:
    """The tree now."""
    face.say(((await robot.request("tree", format="ascii")).text or "").rstrip("\n"))
    return DONE


async def why(robot: Robot, face: Face, at_s: float | None) -> int:
    """Why the robot is, or was, not moving."""
    at: dict[str, Attribute] = {} if at_s is None else {"at": at_s}
    face.say("\n".join(lines(*causes_of(await robot.request("why", **at)))))
    return DONE


async def modules(robot: Robot, face: Face) -> int:
    """Every module, as `pluto ps`."""
    rows = [[module.get(key, "") for key in ("name", "group", "state", "steps", "failures", "text")] for module in await robot.request("modules")]
    table = [["module", "thread", "state", "steps", "failures", ""], *rows]
    widths = [max(len(row[i]) for row in table) for i in range(6)]
    face.say("\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in table))
    return DONE


def module(op: str, name: str = "") -> Act:
    """Start or stop a module."""

    async def act(robot: Robot, face: Face, given: str = "") -> int:
        await robot.request("module", name=name or given, op=op)
        face.say(f"{name or given} {'started' if op == 'start' else 'stopped'}")
        return DONE

    return act


async def topics(robot: Robot, face: Face) -> int:
    """Every topic with its meaning."""
    items = [item for item in await robot.request("describe") if item.get("kind") == "topic"]
    face.say("\n".join(f"{item.get('name', ''):<36} {item.findtext('doc') or ''}" for item in items))
    return DONE


async def get(robot: Robot, face: Face, topic: str) -> int:
    """The newest value of a topic, a line a field."""
    face.say(shown(await robot.request("get", topic=topic)))
    return DONE


async def pose_interface(robot: Robot, face: Face, number: str) -> int:
    """One of the five pose interfaces, numbered as the manual's loc_proxy does."""
    return await get(robot, face, POSES[int(number)])


def state_of(*topics: str) -> Act:
    """The newest values of these topics; one that nobody has written is told, not failed, unless it is the only one."""

    async def act(robot: Robot, face: Face) -> int:
        told = 0
        for topic in topics:
            try:
                face.say(shown(await robot.request("get", topic=topic)))
                told += 1
            except GatewayError as error:
                if error.code != "no-value":
                    raise
                face.say(f"{topic}: no value; nobody writes it in this run, or not yet")
        if not told:
            raise FailedError(f"no value of {', '.join(topics)}")
        return DONE

    return act


async def events(robot: Robot, face: Face, level: str) -> int:
    """The last events."""
    client = await robot.client()
    async with client.stream("log", level=level) as told:
        await client.lease("query")  # the executive answers one after the other: by then all events are here
        found = [event_line(event) for event in told.waiting]
    face.say("\n".join(found[-EVENTS_SHOWN:]) or "no events")
    return DONE
