"""`pluto bench console`: how fast people stop a robot on patrol, by the web console and by ssh; what logins by ssh cost its ticks."""

from __future__ import annotations

import os
import pty
import select
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from pluto_bt.bench.live import PATIENCE_S, Live, drive_on, on_patrol, until
from pluto_bt.bench.row import BenchRow
from pluto_bt.gateway.client import Client
from pluto_bt.runtime.clock import NS, wait, wall_ns

TRIALS = 20
LOGINS, ROUNDS, ROUND_S = 20, 6, 10.0
HOST = "bench@127.0.0.1"


def run() -> Iterator[BenchRow]:
    """All rows; one whose program is not installed says so."""
    programs, libraries = ("ssh", "ssh-keygen"), ("asyncssh", "prompt_toolkit", "aiohttp")
    missing = [*(name for name in programs if shutil.which(name) is None), *(name for name in libraries if find_spec(name) is None)]
    if missing:
        yield _skipped("all of it", ", ".join(missing))
        return
    with tempfile.TemporaryDirectory() as folder:
        ssh = Ssh(Path(folder))
        with on_patrol(str(ssh.keys)) as live, live.client(name="operator") as operator:
            _, ssh.port, web = live.ports
            yield from _clicks(live, operator, web)
            yield from _commands(live, operator, ssh)
            yield from _keys(live, operator, ssh)
            drive_on(operator)
            yield _logins(live, ssh)


class Ssh:
    """The OpenSSH client, with a key of its own in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.port = 0
        key = folder / "key"
        subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", "bench", "-f", key], check=True)
        self.keys = key.with_suffix(".pub")
        self.keys.chmod(0o600)

    def words(self, *more: str) -> list[str]:
        """Its command line."""
        options = (f"UserKnownHostsFile={self.folder / 'known'}", "StrictHostKeyChecking=no", "IdentitiesOnly=yes", "LogLevel=ERROR")
        told = [word for option in options for word in ("-o", option)]
        return ["ssh", "-F", "none", *told, "-p", str(self.port), "-i", str(self.folder / "key"), *more]

    @contextmanager
    def login(self) -> Iterator[list[str]]:
        """One login that serves many commands; the options that use it."""
        control = self.folder / "control"
        master = subprocess.Popen(self.words("-M", "-S", str(control), "-N", HOST), stdin=subprocess.DEVNULL)
        try:
            until(lambda: control.exists() or None, "nobody logs in")
            yield ["-S", str(control)]
        finally:
            master.terminate()
            master.wait()


# stops ---------------------------------------------------------------------------------------------------------------
def _to_zero(name: str, target_s: float, live: Live, operator: Client, stop: Callable[[], object], prepare: Callable[[], object] = bool) -> BenchRow:
    """From the stop to the command of zero that the base is given, the robot driving before."""
    delays_ms = list[float]()
    while len(delays_ms) < TRIALS:
        prepare()
        drive_on(operator)
        begun_ns = wall_ns()
        stop()
        zero_ns = live.stood_ns()
        if zero_ns >= begun_ns:  # else something had stopped it just before
            delays_ms.append((zero_ns - begun_ns) / 1e6)
    note = f"{TRIALS} stops, median {float(np.median(delays_ms)):.1f} ms"
    return BenchRow(f"{name} to zero command, worst", max(delays_ms) / 1e3, "s", f"<= {target_s:g}", note)


def _clicks(live: Live, operator: Client, port: int) -> Iterator[BenchRow]:
    name, program = "STOP in the browser", shutil.which("chromium")
    if program is None or not find_spec("playwright"):
        yield _skipped(name, "playwright" if program else "chromium")
        return
    from playwright.sync_api import sync_playwright

    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=program, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.goto(f"http://127.0.0.1:{port}/")
        page.wait_for_function("() => document.querySelector('#link').textContent.includes('ms')")
        box = page.locator("#stop").bounding_box()
        assert box is not None
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        yield _to_zero("STOP click in the browser", 0.2, live, operator, lambda: page.mouse.click(x, y))
        yield _to_zero("space bar in the browser", 0.2, live, operator, lambda: page.keyboard.press("Space"))
        browser.close()


def _commands(live: Live, operator: Client, ssh: Ssh) -> Iterator[BenchRow]:
    with ssh.login() as logged_in:
        words = ssh.words(*logged_in, HOST, "stop")
        yield _to_zero("`ssh ROBOT stop`, logged in", 0.2, live, operator, lambda: subprocess.run(words, stdout=subprocess.DEVNULL, check=True))


def _keys(live: Live, operator: Client, ssh: Ssh) -> Iterator[BenchRow]:
    with _terminal(ssh.words("-t", HOST)) as terminal:
        terminal.shows("pluto>")
        yield _to_zero("Ctrl-C at the ssh prompt", 0.1, live, operator, lambda: terminal.types("\x03"))

        def watch() -> None:
            terminal.types("watch drive/status 4\r")
            terminal.shows("Ctrl-D leaves")

        yield _to_zero("Ctrl-C in an ssh command", 0.1, live, operator, lambda: terminal.types("\x03"), watch)


# logins --------------------------------------------------------------------------------------------------------------
def _logins(live: Live, ssh: Ssh) -> BenchRow:
    """Twenty at a time, again and again, in turns with nobody, so that what else goes on here meets both."""
    quiet, crowded, count = list[float](), list[float](), 0
    for _ in range(ROUNDS):
        live.tells()
        wait(threading.Event(), ROUND_S)
        quiet += live.tells()["late_ms"]
        until_ns = wall_ns() + round(ROUND_S * NS)
        while wall_ns() < until_ns:
            count += sum(visit.wait() == 0 for visit in [_visit(ssh) for _ in range(LOGINS)])
        crowded += live.tells()["late_ms"]
    without, with_them = (float(np.quantile(late_ms, 0.999, method="higher")) for late_ms in (quiet, crowded))
    note = f"without {without:.2f} ms, with {with_them:.2f} ms, {len(crowded)} ticks, {count} logins"
    return BenchRow(f"tick p99.9, {LOGINS} logins at once less without", with_them - without, "ms", "<= 2", note)


def _visit(ssh: Ssh) -> subprocess.Popen[bytes]:
    """A login with one command. The client would be another machine: it has here what nobody else wants of the processor."""
    return subprocess.Popen(
        ssh.words(HOST, "status"), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
        preexec_fn=lambda: os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0)),
    )  # fmt: skip


# a terminal ----------------------------------------------------------------------------------------------------------
class Terminal:
    """The end of a terminal at which a person sits."""

    def __init__(self, fd: int) -> None:
        self._fd = fd
        self._seen = b""

    def types(self, keys: str) -> None:
        """Hit these keys; what the screen showed is read, for a terminal that nobody reads stands still."""
        while select.select([self._fd], [], [], 0.0)[0]:
            self._seen = os.read(self._fd, 1 << 16)
        os.write(self._fd, keys.encode())

    def shows(self, text: str) -> None:
        """Wait until it is on the screen. Raises: TimeoutError; ConnectionError if the program ends before, with what it said."""
        until_ns = wall_ns() + round(PATIENCE_S * NS)
        while text.encode() not in self._seen:
            if not select.select([self._fd], [], [], max(0.0, (until_ns - wall_ns()) / NS))[0]:
                raise TimeoutError(f"{text} is not on the screen")
            try:
                self._seen += os.read(self._fd, 1 << 16)
            except OSError:  # nobody has the other end any more
                raise ConnectionError(f"the program has ended: {self._seen.decode(errors='replace').strip()}") from None


@contextmanager
def _terminal(words: list[str]) -> Iterator[Terminal]:
    """A program on a terminal of its own, ended at the end."""
    ours, theirs = pty.openpty()
    process = subprocess.Popen(words, stdin=theirs, stdout=theirs, stderr=theirs, start_new_session=True)
    os.close(theirs)
    try:
        yield Terminal(ours)
    finally:
        process.kill()
        process.wait()
        os.close(ours)


def _skipped(name: str, missing: str) -> BenchRow:
    return BenchRow(name, float("nan"), "", "", f"not measured: {missing} is not installed")
