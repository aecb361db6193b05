"""The door of the web console without a browser: who is let in, what is told to browsers, and a socket that is the gateway's own protocol."""

from __future__ import annotations

import asyncio
import json
import os
import shutil
import signal
import socket
import ssl
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path

import pytest

from pluto_bt.blackboard import messages as m
from pluto_bt.commands.doors import read_web
from pluto_bt.gateway.link import Console
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.wire import Scenery
from pluto_bt.source import Faults

from .conftest import Running, whole
from .test_access import access_of, make_certificates, people_file

aiohttp = pytest.importorskip("aiohttp", reason="the web console needs aiohttp (extra web)")
web = pytest.importorskip("aiohttp.web")
doorkeeper = pytest.importorskip("pluto_bt.gateway.web.doorkeeper")

SCENERY = Scenery(json.dumps({"robot": {"name": "pluto"}}).encode(), {"grid.png": b"\x89PNG"})
CONSOLE = Console(Address("127.0.0.1", 0), SCENERY)


@pytest.fixture(scope="module")
def door() -> Iterator[str]:
    """For who only looks at the door."""
    one = Running(CONSOLE)
    one.pump()
    yield one.url
    one.end()


@pytest.fixture
def running() -> Iterator[Running]:
    one = Running(CONSOLE)
    one.pump()
    yield one
    one.end()


def ask(url: str, **headers: str) -> tuple[int, dict[str, str], bytes]:
    async def get() -> tuple[int, dict[str, str], bytes]:
        async with aiohttp.ClientSession() as session, session.get(url, headers=headers) as answer:
            return answer.status, dict(answer.headers), await answer.read()

    return asyncio.run(get())


@asynccontextmanager
async def connected(url: str, origin: str | None = None, **how: object) -> AsyncIterator[aiohttp.ClientWebSocketResponse]:
    async with aiohttp.ClientSession() as session, session.ws_connect(f"{url}/socket", origin=origin or url, **how) as connection:
        yield connection


def talk(url: str, story: Callable[[aiohttp.ClientWebSocketResponse], Awaitable[None]]) -> None:
    async def go() -> None:
        async with connected(url) as connection:
            await asyncio.wait_for(story(connection), 20.0)

    asyncio.run(go())


@pytest.mark.parametrize("path", ["/", "/main.js", "/console.css", "/scenery.json", "/pictures/grid.png", "/nothing"])
def test_every_answer_tells_the_browser_to_load_nothing_from_elsewhere(door: str, path: str) -> None:
    status, headers, body = ask(door + path)
    assert status == (404 if path == "/nothing" else 200)
    policy = headers["Content-Security-Policy"]
    assert policy.startswith("default-src 'self';") and "unsafe" not in policy and "frame-ancestors 'none'" in policy
    assert headers["X-Content-Type-Options"] == "nosniff" and "Server" not in headers
    assert b"http://" not in body.replace(b"http://www.w3.org/", b"") and b"https://" not in body, "nothing is fetched from another host"


def test_the_page_has_no_script_or_style_within_itself(door: str) -> None:
    _, _, page = ask(door)
    assert b"<script>" not in page and b" style=" not in page and b" onclick=" not in page


@pytest.mark.parametrize(
    ("headers", "status"),
    [({}, 200), ({"Origin": "http://evil.org"}, 403), ({"Origin": "null"}, 403), ({"Host": "robot.evil.org"}, 403), ({"Host": "localhost"}, 200)],
)
def test_other_pages_and_names_that_were_pointed_here_are_refused(door: str, headers: dict[str, str], status: int) -> None:
    assert ask(f"{door}/scenery.json", **headers)[0] == status


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1"])
def test_a_socket_from_a_foreign_page_is_refused_and_stops_nothing(running: Running, origin: str) -> None:
    async def knock() -> int:
        try:
            async with connected(running.url, origin) as connection:
                await connection.send_str("<stop/>")
                return 200
        except aiohttp.WSServerHandshakeError as error:
            return error.status

    assert asyncio.run(knock()) == 403
    assert running.robot.did == []


def test_a_browser_speaks_the_protocol_with_its_limits_and_errors(running: Running) -> None:
    async def story(connection: aiohttp.ClientWebSocketResponse) -> None:
        await connection.send_str('<hello version="1.0" name="console"/><ping id="1" t="x"/><pign/>')
        said = "".join([await connection.receive_str() for _ in range(1)])
        while said.count("\n") < 3:
            said += await connection.receive_str()
        tags = [line.split()[0] for line in said.splitlines()]
        assert tags == ["<hello", "<pong", "<error"] and "ping" in said.splitlines()[2]
        await connection.send_str("<stop/>")
        assert (await connection.receive_str()).strip() == "<ok/>"
        await connection.send_str("&")
        assert 'code="not-well-formed"' in await connection.receive_str()
        assert (await connection.receive()).type is aiohttp.WSMsgType.CLOSE

    talk(running.url, story)
    assert running.robot.did == [("stop", "console")]


def test_the_lease_of_a_browser_that_is_gone_ends_with_its_connection(running: Running) -> None:
    async def story(connection: aiohttp.ClientWebSocketResponse) -> None:
        await connection.send_str('<hello version="1.0" name="console" session="s"/><lease op="acquire" ttl_s="60"/>')
        said = ""
        while "lease_state" not in said:
            said += await connection.receive_str()

    talk(running.url, story)
    with running.client() as client:
        while client.lease("query").get("holder"):
            pass
    assert running.robot.did == [("stop", "the lease of console ended with his connection")]


def test_a_browser_that_does_not_read_loses_values_and_nobody_else_does(running: Running) -> None:
    robot, scan = running.robot, m.read_only([12.34] * 2000)
    running.on_step = lambda: robot.write("sick/scan", m.LaserScan(robot.time_s, 0.0, 0.01, scan))
    host, port = running.url.removeprefix("http://").split(":")
    with socket.socket() as sleeper, running.client() as watcher:
        sleeper.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        sleeper.connect((host, int(port)))
        upgrade = ("Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==")
        lines = ("GET /socket HTTP/1.1", f"Host: {host}:{port}", f"Origin: {running.url}", *upgrade, "", "")
        sleeper.sendall("\r\n".join(lines).encode())
        text = b'<subscribe topic="sick/scan"/>'
        sleeper.sendall(bytes([0x81, 0x80 | len(text), 0, 0, 0, 0]) + text)
        watcher.subscribe("sick/scan")
        for _ in range(100):
            assert watcher.receive(20.0) is not None
        sleeper.settimeout(60.0)
        seen = b""
        while b"dropped=" not in seen or all(word.startswith(b'"0"') for word in seen.split(b"dropped=")[1:]):
            data = sleeper.recv(65536)
            assert data, "it was not ended for being slow: only values were lost"
            seen = seen[-40:] + data


def test_with_a_token_the_scenery_and_the_socket_want_it() -> None:
    running = Running(CONSOLE, whole("sesame"))
    running.pump()
    try:
        assert ask(f"{running.url}/")[0] == 200, "the page itself says nothing of the robot"
        assert ask(f"{running.url}/scenery.json")[0] == 401
        assert ask(f"{running.url}/pictures/grid.png", Authorization="Bearer sesam")[0] == 401
        assert ask(f"{running.url}/scenery.json", Authorization="Bearer sesame")[0] == 200

        async def story(connection: aiohttp.ClientWebSocketResponse) -> None:
            await connection.send_str('<get topic="Localization/Pose"/>')
            assert 'code="unauthorised"' in await connection.receive_str()

        talk(running.url, story)
    finally:
        running.end()


def test_the_console_comes_back_with_a_gateway_that_was_killed(running: Running) -> None:
    killed = running.link.pid
    assert killed is not None
    os.kill(killed, signal.SIGKILL)
    while running.link.pid == killed:
        pass
    assert ask(running.url)[0] == 200, "the socket was kept: the caller only waits"


@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed")
def test_from_elsewhere_it_is_tls_and_a_token_says_who_it_is(tmp_path: Path) -> None:
    make_certificates(tmp_path)
    access = access_of(f"{tmp_path / 'cert.pem'},{tmp_path / 'key.pem'},{tmp_path / 'ca.pem'}", str(people_file(tmp_path)))
    running = Running(Console(Address("0.0.0.0", 0), SCENERY), access)
    running.pump()
    url = running.url.replace("0.0.0.0", "127.0.0.1")
    tls = ssl.create_default_context(cafile=str(tmp_path / "cert.pem"))

    async def story() -> str:
        token = "0123456789abcdef-anna"
        async with aiohttp.ClientSession(connector=aiohttp.TCPConnector(ssl=tls)) as session:
            assert (await session.get(f"{url}/scenery.json")).status == 401
            assert (await session.get(f"{url}/scenery.json", headers={"Authorization": f"Bearer {token}", "Host": "robot.example"})).status == 200
            async with session.ws_connect(f"{url}/socket", origin=url) as connection:
                await connection.send_str(f'<hello name="console" token="{token}"/><module name="slam" op="stop"/>')
                said = ""
                while 'code="read-only"' not in said:
                    said += await connection.receive_str()
                return said

    try:
        assert "<hello" in asyncio.run(story()), "anna may drive, but start and stop no modules"
        assert running.robot.did == []
    finally:
        running.end()


def test_a_console_for_elsewhere_without_tls_and_tokens_is_refused() -> None:
    faults = Faults()
    read_web("0.0.0.0:0", faults)
    (fault,) = faults.in_order()
    assert (fault.code, fault.file) == ("not-loopback", "--web")
    assert "--gateway-tls" in fault.expected and "ssh -L" in fault.mend


ASK = b"GET / HTTP/1.1\r\nHost: x\r\n\r\n"


@asynccontextmanager
async def kept(may_end: asyncio.Event) -> AsyncIterator[tuple[tuple[str, int], asyncio.Semaphore]]:
    """A doorkeeper's address, and who has asked there; what is asked there is answered at `may_end`."""

    async def slow(request: web.Request) -> web.Response:
        arrived.release()
        await may_end.wait()
        return web.Response(text="here it is")

    app, arrived = web.Application(), asyncio.Semaphore(0)
    app.router.add_get("/", slow)
    listener = socket.create_server(("127.0.0.1", 0))
    serving = asyncio.create_task(doorkeeper.Doorkeeper(app).listen(listener))
    yield listener.getsockname(), arrived
    serving.cancel()


async def is_answered(reader: asyncio.StreamReader) -> bool:
    return b"here it is" in await asyncio.wait_for(reader.readuntil(b"here it is"), 10.0)


async def is_let_go(reader: asyncio.StreamReader) -> bool:
    with suppress(ConnectionError):
        return await asyncio.wait_for(reader.read(), 10.0) == b""
    return True


def test_connections_that_ask_for_nothing_are_ended_and_others_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doorkeeper, "PATIENCE_S", 1.0)

    async def story() -> None:
        may_end = asyncio.Event()
        async with kept(may_end) as (address, arrived):
            idle = [await asyncio.open_connection(*address) for _ in range(3)]
            idle[0][1].write(ASK[:-2])  # and never the rest
            asks = await asyncio.open_connection(*address)
            asks[1].write(ASK)
            await arrived.acquire()
            for reader, _ in idle:
                assert await is_let_go(reader)
            may_end.set()
            assert await is_answered(asks[0]), "it asked, and was waited for"

    asyncio.run(asyncio.wait_for(story(), 30.0))


def test_when_all_places_are_taken_who_has_not_asked_for_the_longest_time_gives_way(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doorkeeper, "CONNECTIONS", 3)

    async def story() -> None:
        may_end = asyncio.Event()
        may_end.set()
        async with kept(may_end) as (address, arrived):
            callers = [await asyncio.open_connection(*address) for _ in range(3)]
            for number in (1, 0, 2):  # each asks, and then sits there
                callers[number][1].write(ASK)
                await arrived.acquire()
                assert await is_answered(callers[number][0])
            may_end.clear()
            page = await asyncio.open_connection(*address)
            page[1].write(ASK)
            await arrived.acquire()
            assert await is_let_go(callers[1][0])
            for number in (0, 2):
                callers[number][1].write(ASK)
                await arrived.acquire()
            page_too = await asyncio.open_connection(*address)
            assert await is_let_go(page_too[0]), "each of the others is being answered"
            may_end.set()
            for reader, _ in (page, callers[0], callers[2]):
                assert await is_answered(reader)

    asyncio.run(asyncio.wait_for(story(), 30.0))

