"""Commands that drive: one node of the library, run under the lease, watched until its end."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from typing import Any

from pluto_bt.gateway.async_client import AsyncClient
from pluto_bt.gateway.shell.codes import DONE, FAILED, UsageError
from pluto_bt.gateway.shell.face import Face
from pluto_bt.gateway.shell.robot import Robot
from pluto_bt.gateway.shell.telling import brief
from pluto_bt.gateway.words import RunResult

TTL_S = 20.0  # of the run, which may be a hundred times as fast as we; a shell that dies is noticed by its connection, not by this
RENEW_S = 0.1
NO_PORTS = frozenset({"id", "node", "on_progress"})  # names that a run has for itself
Act = Callable[..., Awaitable[int]]


@asynccontextmanager
async def driving(robot: Robot, ttl_s: float = TTL_S) -> AsyncIterator[AsyncClient]:
    """Hold the lease inside. Who is cancelled there stops the robot, before anything else. Raises: GatewayError."""
    client = await robot.client()
    async with client.driving(ttl_s, renew_s=RENEW_S):
        try:
            yield client
        except asyncio.CancelledError:
            client.tell("stop")
            raise


@asynccontextmanager
async def side_by_side() -> AsyncIterator[asyncio.TaskGroup]:
    """A group of tasks whose first failure is raised as it is. Raises: what a task raised."""
    try:
        async with asyncio.TaskGroup() as group:
            yield group
    except BaseExceptionGroup as errors:
        raise errors.exceptions[0] from None


async def run_node(robot: Robot, face: Face, node: str, ports: Mapping[str, Any]) -> int:
    """Run one node to its end and tell how it went."""

    def progress(state: str, text: str) -> None:
        face.progress(": ".join(filter(None, (state or "running", text))))

    async with driving(robot) as client:
        result = await client.run(node, on_progress=progress, **ports)
    return tell_result(face, result)


async def navigate(robot: Robot, face: Face, goal: str) -> int:
    """Plan the way to a place and drive it."""
    return await run_node(robot, face, "NavigateTo", {"goal": goal.replace(",", ";")})


async def do(robot: Robot, face: Face, name: str, settings: tuple[str, ...]) -> int:
    """Any node of the library."""
    given = inputs(settings)
    if taken := sorted(given.keys() & NO_PORTS):
        raise UsageError(f"expected inputs of the node, found {', '.join(taken)}")
    return await run_node(robot, face, name, given)


def inputs(settings: Sequence[str]) -> dict[str, str]:
    """NAME=VALUE words as a table. Raises: UsageError."""
    given = {name: value for name, equals, value in (setting.partition("=") for setting in settings) if equals and name.isidentifier()}
    if len(given) != len(settings):
        raise UsageError(f"expected inputs as NAME=VALUE, each once, found {' '.join(settings)}")
    return given


def tell_result(face: Face, result: RunResult) -> int:
    """State, reason and text of a run, and what came out of it."""
    is_told = result.reason == result.state or f"{result.reason}:" in result.text  # no word twice
    face.say(": ".join(filter(None, (result.state, "" if is_told else result.reason, result.text))))
    for name, value in result.outputs.items():
        if name != "reason":
            face.say(f"  {name} = {brief(value)}")
    return DONE if result.is_success else FAILED


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
        return await run_node(robot, face, name, given)

    return act
