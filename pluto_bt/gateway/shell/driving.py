"""Commands that drive: one node of the library, run under the lease, watched until its end."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import asynccontextmanager, suppress
from typing import Any

from pluto_bt.gateway.client import Element, GatewayError
from pluto_bt.gateway.shell.codes import DONE, FAILED, UsageError
from pluto_bt.gateway.shell.face import Face
from pluto_bt.gateway.shell.link import Link
from pluto_bt.gateway.shell.robot import Robot

TTL_S = 20.0  # of the run, which may be a hundred times as fast as we; a shell that dies is noticed by its connection, not by this
RENEW_S = 0.1
Act = Callable[..., Awaitable[int]]


@asynccontextmanager
async def driving(robot: Robot, ttl_s: float = TTL_S) -> AsyncIterator[Link]:
    """Hold the lease inside. Who is cancelled there stops the robot, before anything else. Raises: GatewayError."""
    link = await robot.link()
    await link.request("lease", op="acquire", ttl_s=ttl_s, on_loss="stop")
    renewing = asyncio.create_task(_renew(link))
    try:
        yield link
    except asyncio.CancelledError:
        tell(link, "stop")
        raise
    finally:
        renewing.cancel()
        tell(link, "lease", op="release")


def tell(link: Link, tag: str, /, **attributes: str) -> None:
    """Say it without waiting for the answer; harmless if nobody hears it."""
    with suppress(GatewayError):
        link.forget(link.ask(tag, **attributes).id)


async def _renew(link: Link) -> None:
    with suppress(GatewayError):  # taken away, or the connection is gone: what is driven ends by itself
        while True:
            await asyncio.sleep(RENEW_S)
            await link.request("lease", op="renew")


@asynccontextmanager
async def side_by_side() -> AsyncIterator[asyncio.TaskGroup]:
    """A group of tasks whose first failure is raised as it is. Raises: what a task raised."""
    try:
        async with asyncio.TaskGroup() as group:
            yield group
    except BaseExceptionGroup as errors:
        raise errors.exceptions[0] from None


async def run_node(robot: Robot, face: Face, node: str, **ports: str) -> int:
    """Run one node to its end and tell how it went."""
    async with driving(robot) as link:
        with link.ask("run", node=node, **ports) as talk:
            message = await talk.next()
            while message.tag != "result":
                face.progress(": ".join(filter(None, (message.get("state") or "running", message.get("text")))))
                message = await talk.next(None)
    return tell_result(face, message)


async def navigate(robot: Robot, face: Face, goal: str) -> int:
    """Plan the way to a place and drive it."""
    return await run_node(robot, face, "NavigateTo", goal=goal.replace(",", ";"))


async def do(robot: Robot, face: Face, name: str, settings: tuple[str, ...]) -> int:
    """Any node of the library."""
    return await run_node(robot, face, name, **inputs(settings))


def inputs(settings: Sequence[str]) -> dict[str, str]:
    """NAME=VALUE words as a table. Raises: UsageError."""
    given = {name: value for name, equals, value in (setting.partition("=") for setting in settings) if equals and name.isidentifier()}
    if len(given) != len(settings):
        raise UsageError(f"expected inputs as NAME=VALUE, each once, found {' '.join(settings)}")
    return given


def tell_result(face: Face, result: Element) -> int:
    """State, reason and text of a run, and what came out of it."""
    state = result.get("state", "")
    face.say(": ".join(word for word in (state, result.get("reason"), result.get("text")) if word))
    for out in result.iter("out"):
        if out.get("name") != "reason":
            face.say(f"  {out.get('name')} = {out.text or ''}")
    return DONE if state == "succeeded" else FAILED


def plain(value: Any) -> str:
    """A value as a port takes it."""
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def node(name: str, *ports: str, **fixed: str) -> Act:
    """A command that runs this node; its arguments are these ports, `goal=2` being one port made of two arguments. None = the port's default."""

    async def act(robot: Robot, face: Face, *values: Any) -> int:
        given, left = dict(fixed), list(values)
        for port in ports:
            key, _, count = port.partition("=")
            parts = [left.pop(0) for _ in range(int(count or 1))]
            if parts[0] is not None:
                given[key] = ";".join(map(plain, parts))
        return await run_node(robot, face, name, **given)

    return act
