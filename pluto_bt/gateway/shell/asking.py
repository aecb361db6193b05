"""Commands that only ask."""

from __future__ import annotations

import asyncio
import json
import math
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TextIO

from pluto_bt.gateway.client import Element, GatewayError
from pluto_bt.gateway.shell.codes import DONE, FailedError
from pluto_bt.gateway.shell.driving import Act, side_by_side
from pluto_bt.gateway.shell.face import Face
from pluto_bt.gateway.shell.link import Robot
from pluto_bt.gateway.why import causes_of, lines
from pluto_bt.gateway.xml_text import Attribute

EVENTS_SHOWN = 20
LONG_LIST = 12  # numbers shown of a longer list
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


async def watch(robot: Robot, face: Face, topic: str, rate_hz: float, for_s: float | None) -> int:
    """Values of a topic as they come."""
    await _listen(robot, (topic,), rate_hz, for_s, lambda value: face.say(shown(value)))
    return DONE


async def record(robot: Robot, face: Face, for_s: float, file: str, topics: tuple[str, ...]) -> int:
    """What topics say, as JSON, a line a value."""
    if file == "-":
        await _listen(robot, topics or ("*",), 0.0, for_s, lambda value: face.say(as_json(value)))
        return DONE
    if not face.may_read_files:
        mend = f"write - and redirect: ssh ROBOT record {for_s:g} - > FILE"
        raise FailedError(f'cannot write "{file}": your files are out of reach over ssh; {mend}')
    try:
        with Path(file).open("x", encoding="utf-8") as out:
            count = await _record(robot, topics, for_s, out)
    except FileExistsError:
        raise FailedError(f'"{file}" is there already; give another name') from None
    except OSError as error:
        raise FailedError(f'cannot write "{file}": {error.strerror or error}') from None
    face.say(f"{count} values in {file}")
    return DONE


async def _record(robot: Robot, topics: tuple[str, ...], for_s: float, out: TextIO) -> int:
    count = 0

    def write(value: Element) -> None:
        nonlocal count
        count += 1
        out.write(as_json(value) + "\n")

    await _listen(robot, topics or ("*",), 0.0, for_s, write)
    return count


async def _listen(robot: Robot, topics: tuple[str, ...], rate_hz: float, for_s: float | None, hear: Callable[[Element], None]) -> None:
    """Give each value of these topics to `hear`, for so long or until cancelled."""
    link = await robot.link()

    async def one(topic: str) -> None:
        with link.ask("subscribe", topic=topic, max_rate_hz=rate_hz) as talk:
            await talk.next()
            while True:
                hear(await talk.next(None))

    try:
        with suppress(TimeoutError):
            async with asyncio.timeout(for_s), side_by_side() as group:
                for topic in topics:
                    group.create_task(one(topic))
    finally:
        if not link.lost.is_set():
            for topic in topics:
                link.forget(link.ask("unsubscribe", topic=topic).id)


async def events(robot: Robot, face: Face, level: str) -> int:
    """The last events."""
    link = await robot.link()
    found: list[str] = []
    with link.ask("log", level=level) as talk:
        await talk.next()
        await link.request("lease", op="query")  # the executive answers one after the other: by then all events are here
        while not talk.heard.empty():
            found.append(event_line(await talk.next()))
    face.say("\n".join(found[-EVENTS_SHOWN:]) or "no events")
    return DONE


def event_line(event: Element) -> str:
    """An event for a person, from an `<event>` or a `<value>` of the topic."""
    part = {child.tag: child.text or "" for child in event} if event.tag == "value" else {**event.attrib, "text": event.text or ""}
    time = event.get("stamp") or event.get("time") or "0"
    return f"{float(time):9.2f} s  {part.get('level', ''):<7} {part.get('source', '')}: {part.get('text', '')}"


def shown(value: Element) -> str:
    """A value for a person: a line a field, long lists cut; codes with their names."""
    lines = [f"{value.get('topic')}  at {value.get('stamp')} s, age {value.get('age')} s"]
    for part in value:
        words = (part.text or "").split(" ")
        text = part.text or " ".join(f"{key}={word}" for key, word in part.attrib.items())
        cut = f"{' '.join(words[:LONG_LIST])} … ({len(words)} in all)" if len(words) > LONG_LIST and part.tag != "text" else text
        lines.append(f"  {part.tag:<16} {cut}")
    return "\n".join(lines)


def as_json(value: Element) -> str:
    """A value as one line of JSON: numbers as numbers, lists as lists, rows as objects."""
    fields: dict[str, object] = {}
    for part in value:
        if part.attrib:
            rows = fields.setdefault(part.tag, [])
            assert isinstance(rows, list)
            rows.append(dict(part.attrib))
        else:
            numbers = [_number(word) for word in (part.text or "").split()]
            is_numeric = bool(numbers) and None not in numbers
            fields[part.tag] = (numbers[0] if len(numbers) == 1 else numbers) if is_numeric else part.text or ""
    head = {"topic": value.get("topic"), "seq": int(value.get("seq", "0")), "stamp_s": float(value.get("stamp", "0"))}
    return json.dumps({**head, **fields}, ensure_ascii=False)


def _number(word: str) -> float | None:
    try:
        number = float(word)
    except ValueError:
        return None
    return number if math.isfinite(number) else None
