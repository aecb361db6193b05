"""The asyncio client and the real gateway process: many tasks at once, a gateway that is killed, a task that is cancelled."""

from __future__ import annotations

import asyncio
import os
import signal
import threading
from collections.abc import Awaitable, Callable

import pytest

from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.client import AsyncClient
from pluto_bt.gateway.errors import BadRequestError, NoConnectionError, TurnedAwayError
from pluto_bt.gateway.listen import Address, open_listener
from pluto_bt.gateway.port import RunState
from pluto_bt.runtime.clock import NS, wall_ns

from .conftest import Running

WAIT_S = 60.0


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


def test_streams_are_apart_and_go_on_over_a_killed_gateway(running: Running) -> None:
    robot = running.robot
    running.on_step = lambda: [robot.write(topic, m.Pose(robot.time_s)) for topic in ("Localization/Pose", "Localization/Dead-Reckoning")]  # type: ignore[assignment]

    async def story(client: AsyncClient) -> None:
        robot.says("first")
        async with client.stream("log", level="info") as log:
            await client.lease("query")
            assert [event.text for event in log.waiting] == ["first"]
        async with client.stream("subscribe", topic="Localization/Pose") as one, client.stream("subscribe", topic="Localization/D*") as other:
            assert {(await one.next()).get("topic") for _ in range(3)} == {"Localization/Pose"}
            assert {(await other.next()).get("topic") for _ in range(3)} == {"Localization/Dead-Reckoning"}
            assert running.link.pid is not None
            os.kill(running.link.pid, signal.SIGKILL)
            await asyncio.to_thread(wait_for, lambda: running.link.restarts > 0)
            one.waiting.clear()
            assert (await one.next()).get("topic") == "Localization/Pose"
        with pytest.raises(BadRequestError, match="unknown topic"):
            async with client.stream("subscribe", topic="Localisation/Pose"):
                pass
        await client.request("ping")
        assert not client.pending and not client.dialogue.streams, "nothing is left of them"

    talk(running, story)


def test_a_stop_that_was_given_up_is_not_said_again_later(running: Running) -> None:
    """The gateway is stopped for a moment: who gave the stop up has long found another way, and may have driven on."""

    async def story(client: AsyncClient) -> None:
        await client.request("ping")
        assert running.link.pid is not None
        os.kill(running.link.pid, signal.SIGSTOP)
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.1):
                await client.stop()
        os.kill(running.link.pid, signal.SIGKILL)
        await asyncio.to_thread(wait_for, lambda: running.link.restarts > 0)
        await client.request("ping")
        await client.lease("query")

    talk(running, story)
    assert running.robot.did == []


def wait_for(holds: Callable[[], bool]) -> None:
    begun_ns = wall_ns()
    while not holds():
        assert wall_ns() - begun_ns < 20 * NS
        threading.Event().wait(0.005)


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
