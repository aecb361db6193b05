"""One value to many real sockets, by every way to send it and on both event loops: whole lines, in order, to whom they are meant for."""

from __future__ import annotations

import asyncio
import re
import socket
import struct
from collections.abc import Awaitable, Callable

import pytest

from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.access import Access
from pluto_bt.gateway.burst import Burst
from pluto_bt.gateway.exchange import Exchange
from pluto_bt.gateway.hub import Hub
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.outlets import Outlets
from pluto_bt.gateway.server import Server
from pluto_bt.gateway.wire import Answer, Batch, Down

from .robot import FakeRobot

TOPIC = "operator/word"
LONG_S = 120.0
"""Only a test that hangs takes so long."""


class Visitor:
    """A client's socket."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader, self._writer = reader, writer

    def say(self, text: str) -> None:
        self._writer.write(text.encode())

    async def line(self) -> str:
        return (await self._reader.readuntil(b"\n")).decode()

    def vanish(self) -> None:
        """Gone without a word: the gateway gets a reset."""
        self._writer.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self._writer.transport.abort()


class House:
    """A robot and its gateway in this thread's event loop."""

    def __init__(self, burst: Burst) -> None:
        self.robot = FakeRobot()
        self._down: list[Down] = []
        self._exchange = Exchange(self.robot, self._down.append)
        welcome = self._exchange.welcome(Access(), Limits(messages_per_s=1e6), 1)
        self._server = Server(Hub(welcome, self._exchange.receive, asyncio.get_running_loop().time(), Outlets(burst)))
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.setblocking(False)

    async def open(self) -> None:
        self._server.begin()
        await self._server.listen(self._listener)

    async def visitor(self, *words: str, buffer_bytes: int = 0) -> Visitor:
        """One more client, who has said this and heard that it is well."""
        connection = socket.socket()
        if buffer_bytes:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer_bytes)
        connection.setblocking(False)
        await asyncio.get_running_loop().sock_connect(connection, self._listener.getsockname())
        visitor = Visitor(*await asyncio.open_connection(sock=connection, limit=4096))
        for word in words:
            visitor.say(word)
            assert (await visitor.line()).startswith(("<ok", "<pong"))
        return visitor

    def write(self, text: str) -> None:
        """A value for all: it is on its way to them when this returns."""
        self.robot.time_s += 0.02
        self.robot.write(TOPIC, m.Flag(self.robot.time_s, text))
        self.step()

    def step(self) -> None:
        self._exchange.step(self.robot.time_s)
        frames, self._down[:] = list(self._down), []
        for frame in frames:
            if isinstance(frame, Answer | Batch):
                self._server.flush(self._server.hub.receive(frame, asyncio.get_running_loop().time()))


def seq_of(line: str) -> int:
    found = re.search(r'<value topic="operator/word" seq="(\d+)"', line)
    assert found and line.endswith("</value>\n"), line
    return int(found[1])


Story = Callable[[House], Awaitable[None]]


@pytest.fixture(params=["asyncio", "uvloop"])
def play(request: pytest.FixtureRequest, burst: Burst) -> Callable[[Story], None]:
    """Runs a story in an event loop of this kind."""
    run = pytest.importorskip("uvloop").run if request.param == "uvloop" else asyncio.run

    async def whole(story: Story) -> None:
        async with asyncio.timeout(LONG_S):
            house = House(burst)
            await house.open()
            await story(house)

    return lambda story: run(whole(story))


def test_everybody_hears_each_value_once_and_in_order(play: Callable[[Story], None]) -> None:
    async def story(house: House) -> None:
        visitors = [await house.visitor(f'<subscribe topic="{TOPIC}"/>') for _ in range(40)]
        house.step()
        for k in range(1, 31):
            house.write(f"word {k}")
            if k % 3 == 0:
                visitors[k].say(f'<ping id="p{k}"/>')
            for visitor in visitors:
                line = await visitor.line()
                assert seq_of(line) == k and f"word {k}<" in line
            if k % 3 == 0:
                assert 'id="p' in await visitors[k].line()

    play(story)


def test_who_does_not_read_loses_values_is_told_how_many_and_holds_up_nobody(play: Callable[[Story], None]) -> None:
    async def story(house: House) -> None:
        sleeper = await house.visitor(f'<subscribe topic="{TOPIC}"/>', buffer_bytes=4096)
        awake = [await house.visitor(f'<subscribe topic="{TOPIC}"/>') for _ in range(5)]
        house.step()
        last = 600
        for k in range(1, last + 1):
            house.write("z" * 3000)
            for visitor in awake:
                assert seq_of(await visitor.line()) == k
        heard, lost = 0, 0
        while heard < last:
            line = await sleeper.line()
            dropped = re.search(r'dropped="(\d+)"', line)
            lost += int(dropped[1]) if dropped else 0
            assert seq_of(line) > heard and line.count("z") == 3000
            assert seq_of(line) - heard - 1 == (int(dropped[1]) if dropped else 0)
            heard = seq_of(line)
        assert lost > 0, "so much fits into no buffer"
        house.write("and then all is as before")
        assert seq_of(await sleeper.line()) == last + 1

    play(story)


def test_whoever_comes_in_the_place_of_one_who_went_hears_nothing_that_was_not_meant_for_him(play: Callable[[Story], None]) -> None:
    async def story(house: House) -> None:
        listeners = [await house.visitor(f'<subscribe topic="{TOPIC}"/>') for _ in range(6)]
        house.step()
        silent: list[Visitor] = []
        for k in range(1, 41):
            if k % 2 == 0:
                listeners.pop(0).vanish()
                house.write(f"word {k}")  # before the gateway can know it
                silent.append(await house.visitor())
                listeners.append(await house.visitor(f'<subscribe topic="{TOPIC}"/>'))
                assert seq_of(await listeners[-1].line()) == k, "what is there already"
            else:
                house.write(f"word {k}")
            for visitor in listeners[: 5 if k % 2 == 0 else 6]:
                assert seq_of(await visitor.line()) == k
        for visitor in silent:
            visitor.say('<ping id="there"/>')
            assert (await visitor.line()).startswith('<pong id="there"')

    play(story)
