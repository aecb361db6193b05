"""Commands that listen: what topics say, as it comes."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TextIO

from pluto_bt.gateway.client import Element
from pluto_bt.gateway.shell.codes import DONE, FailedError
from pluto_bt.gateway.shell.driving import side_by_side
from pluto_bt.gateway.shell.face import Face
from pluto_bt.gateway.shell.robot import Robot
from pluto_bt.gateway.shell.telling import as_json, shown


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
    client = await robot.client()

    async def one(topic: str) -> None:
        async with client.stream("subscribe", topic=topic, max_rate_hz=rate_hz) as values:
            async for value in values:
                hear(value)

    with suppress(TimeoutError):
        async with asyncio.timeout(for_s), side_by_side() as group:
            for topic in topics:
                group.create_task(one(topic))
