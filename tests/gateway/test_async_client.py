"""The asyncio client and the real gateway process: many tasks at once, a gateway that is killed, a task that is cancelled."""

from __future__ import annotations

import asyncio
import os
import signal
from collections.abc import Awaitable, Callable

import pytest

from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.client import AsyncClient
from pluto_bt.gateway.errors import BadRequestError, NoConnectionError, TurnedAwayError
from pluto_bt.gateway.listen import Address, open_listener
from pluto_bt.gateway.port import RunState

from .conftest import Running

WAIT_S = 20.0


def talk(running: Running, story: Callable[[AsyncClient], Awaitable[None]], **given: str) -> None:
    """Tell the story to a client of the gateway."""

    async def main() -> None:
        async with asyncio.timeout(3 * WAIT_S), AsyncClient(*running.address, timeout_s=WAIT_S, **given) as client:  # type: ignore[arg-type]
            await story(client)

    asyncio.run(main())


def test_many_tasks_ask_at_once_and_each_hears_its_own_answer(running: Running) -> None:
    async def story(client: AsyncClient) -> None:
        pongs = await asyncio.gather(*(client.request("ping", t=str(i)) for i in range(50)))
        assert [pong.get("t") for pong in pongs] == [str(i) for i in range(50)]
        with pytest.raises(BadRequestError, match="GoTo"):
            async with client.driving():
                await client.run("GoTu", goal="1;1")

    talk(running, story, name="anna")


def test_it_outlives_the_gateway_and_goes_on_with_its_run(running: Running) -> None:
    robot = running.robot
    running.on_step = lambda: robot.write("Localization/Pose", m.Pose(robot.time_s))

    async def story(client: AsyncClient) -> None:
        await client.subscribe("Localization/Pose", max_rate_hz=20)
        async with client.driving(ttl_s=30.0, on_loss="continue"):
            run = asyncio.create_task(client.run("GoTo", goal="3;4"))
            while not robot.runs:
                assert await client.receive(WAIT_S) is not None
            assert running.link.pid is not None
            os.kill(running.link.pid, signal.SIGKILL)
            while not running.link.restarts:
                await client.receive(WAIT_S)
            client.pending.clear()
            assert (await client.receive(WAIT_S)).tag == "value", "subscribed again"  # type: ignore[union-attr]
            robot.runs["r1"] = RunState("succeeded", "", "there")
            assert (await run).text == "there"
            assert (await client.lease("query")).get("mine") == "true"

    talk(running, story, session="anna")
    assert [deed[0] for deed in robot.did] == ["run"]
    assert running.link.restarts == 1


def test_a_cancelled_run_stops_the_robot(running: Running) -> None:
    async def story(client: AsyncClient) -> None:
        async with client.driving():
            run = asyncio.create_task(client.run("GoTo", goal="3;4"))
            while not running.robot.runs:
                await client.receive(0.05)
            run.cancel()
            with pytest.raises(asyncio.CancelledError):
                await run

    talk(running, story, name="anna")
    assert ("stop", "anna") in running.robot.did


def test_messages_end_with_the_run_of_the_robot(running: Running) -> None:
    async def story(client: AsyncClient) -> None:
        await client.subscribe("events")
        running.robot.says("hello")
        with pytest.raises(TurnedAwayError) as error:
            async for message in client.messages():
                assert message.findtext("text") == "hello"
                await asyncio.to_thread(running.end)
        assert error.value.code == "shutdown"

    talk(running, story, name="anna")


def test_a_client_without_a_gateway_is_told_so() -> None:
    async def main(port: int) -> None:
        async with AsyncClient("127.0.0.1", port):
            pass

    with open_listener(Address("127.0.0.1", 0)) as closed:
        port = closed.getsockname()[1]
    with pytest.raises(NoConnectionError, match=f"no gateway at 127.0.0.1:{port}: "):
        asyncio.run(main(port))
