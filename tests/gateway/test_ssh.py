"""The ssh door, from outside: the real OpenSSH client against the real process, over a robot in memory."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import stat
import subprocess
import threading
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest

from pluto_bt.cli import main as pluto
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.port import RunState
from pluto_bt.runtime.clock import NS, wall_ns
from pluto_bt.source import Faults, InputError

from .conftest import Running

pytest.importorskip("asyncssh")
pytest.importorskip("prompt_toolkit")
if shutil.which("ssh") is None or shutil.which("ssh-keygen") is None:
    pytest.skip("the OpenSSH client is not installed", allow_module_level=True)

from pluto_bt.gateway.ssh_keys import check_keys, host_key
from pluto_bt.gateway.ssh_link import SshLink, SshRequest

needs_tmux = pytest.mark.skipif(shutil.which("tmux") is None, reason="tmux is not installed")
PATIENCE_S = 60.0


class Door:
    """A served door, and the client's command line for it."""

    def __init__(self, folder: Path) -> None:
        for name in ("mine", "strange"):
            subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", "", "-f", folder / name], check=True)
        self.folder = folder
        self.keys = folder / "operators"
        shutil.copy(folder / "mine.pub", self.keys)
        self.keys.chmod(0o600)
        self.running = Running()
        self.running.pump()
        self.link = SshLink(SshRequest(Address("127.0.0.1", 0), self.keys), host_key())
        self.link.start(0.0, self.running.address)

    def words(self, *more: str, key: str = "mine", program: str = "ssh") -> list[str]:
        """The client with its options; `more` are further options, then the host, then the command."""
        options = [f"UserKnownHostsFile={self.folder / 'known'}", "StrictHostKeyChecking=no", "IdentitiesOnly=yes", "LogLevel=ERROR"]
        port = ["-p" if program == "ssh" else "-P", str(self.link.address.port)]
        return [program, "-F", "none", *(word for option in options for word in ("-o", option)), *port, "-i", str(self.folder / key), *more]

    def say(self, *more: str, text: str = "", key: str = "mine", program: str = "ssh") -> subprocess.CompletedProcess[str]:
        """Run the client to its end."""
        return subprocess.run(self.words(*more, key=key, program=program), input=text, capture_output=True, text=True, timeout=PATIENCE_S)

    def begin(self, *more: str) -> subprocess.Popen[str]:
        """Start the client."""
        return subprocess.Popen(self.words(*more), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)


HOST = "robot@127.0.0.1"


@pytest.fixture(scope="module")
def lasting(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Door]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        door = Door(tmp_path_factory.mktemp("ssh"))
        yield door
        door.link.stop()
        door.running.end()


@pytest.fixture
def door(lasting: Door) -> Door:
    lasting.running.renew()
    return lasting


def until(holds: Callable[[], bool], within_s: float = PATIENCE_S, told: Callable[[], str] = lambda: "") -> None:
    """Wait until it does."""
    begun_s = wall_ns() / NS
    while not holds():
        assert wall_ns() / NS - begun_s < within_s, f"it did not come to pass: {told()}"
        threading.Event().wait(0.002)


def stops(door: Door) -> int:
    return sum(did[0] == "stop" for did in door.running.robot.did)


def has_run(door: Door) -> Callable[[], bool]:
    return lambda: any(did[0] == "run" for did in door.running.robot.did)


def test_one_line_commands_have_exit_codes(door: Door) -> None:
    done = door.say(HOST, "stop")
    assert (done.returncode, done.stdout, done.stderr, stops(door)) == (0, "stopped\n", "", 1)
    failed = door.say(HOST, "start", "slem")
    assert (failed.returncode, failed.stderr) == (1, 'pluto shell: unknown-module: unknown module "slem"\n')
    wrong = door.say(HOST, "goto 3")
    assert (wrong.returncode, wrong.stderr) == (2, "pluto shell: goto: expected X Y, found 3; usage: goto X Y\n")
    assert door.say(HOST, 'goto "3').returncode == 2


def test_a_script_comes_through_the_pipe(door: Door) -> None:
    done = door.say(HOST, text="# first\nstop\nstatus\nquit\nstpo\n")
    assert done.returncode == 0 and done.stdout.startswith("stopped\nmission -: idle")
    failed = door.say(HOST, text="stop\nstpo\nstop")
    assert failed.returncode == 2 and "line 2: stpo" in failed.stderr and failed.stdout == "stopped\n"


def test_a_file_of_the_robot_is_out_of_reach(door: Door, tmp_path: Path) -> None:
    assert "out of reach" in door.say(HOST, "record", "1", str(tmp_path / "x")).stderr and not (tmp_path / "x").exists()
    secret = tmp_path / "secret.xml"
    secret.write_text("<root secret='1'/>")
    door.say(HOST, "run", str(secret), "&")
    assert not any("secret=" in str(did) for did in door.running.robot.did)


def test_one_login_serves_many_stops(door: Door) -> None:
    control = str(door.folder / "c")
    master = door.begin("-M", "-S", control, "-N", HOST)
    try:
        until(Path(control).exists)
        for number in range(1, 4):
            assert door.say("-S", control, HOST, "stop").returncode == 0 and stops(door) == number
    finally:
        master.terminate()
        master.wait(PATIENCE_S)


@pytest.mark.parametrize(
    ("options", "key"),
    [
        ((), "strange"),
        (("-o", "PreferredAuthentications=password", "-o", "NumberOfPasswordPrompts=0"), "mine"),
        (("-o", "PreferredAuthentications=keyboard-interactive"), "mine"),
        (("-o", "PreferredAuthentications=none"), "mine"),
        (("-o", "PreferredAuthentications=gssapi-with-mic,hostbased"), "mine"),
    ],
)
def test_nobody_comes_in_without_a_key(door: Door, options: Sequence[str], key: str) -> None:
    refused = door.say("-o", "BatchMode=yes", *options, HOST, "stop", key=key)
    assert refused.returncode == 255 and "Permission denied (publickey)" in refused.stderr and stops(door) == 0


def test_a_key_that_is_taken_out_opens_no_more(door: Door) -> None:
    held = door.keys.read_text()
    try:
        door.keys.write_text("# nobody\n")
        assert door.say("-o", "BatchMode=yes", HOST, "stop").returncode == 255
        door.keys.unlink()
        assert door.say("-o", "BatchMode=yes", HOST, "stop").returncode == 255
    finally:
        door.keys.write_text(held)
    assert door.say("-o", "BatchMode=yes", HOST, "stop").returncode == 0


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("{key} anna@desk", "shell anna@desk"),
        ('from="127.0.0.1",environment="A={key} b" {key}  Anna\x1b[2J  Meier', "shell Anna [2J Meier"),
        ("{key}", "shell robot"),
        ("# {key} nobody\n{key} anna", "shell anna"),
    ],
)
def test_who_comes_is_known_by_the_comment_of_his_key(door: Door, line: str, name: str) -> None:
    held = door.keys.read_text()
    try:
        door.keys.write_text(line.format(key=" ".join(held.split()[:2])) + "\n")
        assert door.say(HOST, "stop").returncode == 0
    finally:
        door.keys.write_text(held)
    assert door.running.robot.did == [("stop", name)]


def test_who_drives_by_ssh_is_told_by_his_name(door: Door) -> None:
    client = door.begin(HOST, "goto", "3", "4")
    try:
        until(has_run(door))
        assert door.say(HOST, "status").stdout.endswith("shell robot drives\n")
        refused = door.say(HOST, "goto", "5", "6")
        assert refused.returncode == 1 and "the lease is held by shell robot" in refused.stderr
    finally:
        client.kill()
        client.wait()
        until(lambda: door.say(HOST, "status").stdout.endswith("nobody drives\n"))


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def test_forwarding_is_refused(door: Door) -> None:
    gateway, near, far = door.running.address.port, free_port(), free_port()
    assert door.say("-W", f"127.0.0.1:{gateway}", HOST, text="<stop/>\n").returncode == 255
    remote = door.say("-o", "ExitOnForwardFailure=yes", "-R", f"{far}:127.0.0.1:{gateway}", HOST, "stop")
    assert remote.returncode == 255 and "forwarding failed" in remote.stderr
    client = door.begin("-N", "-L", f"{near}:127.0.0.1:{gateway}", HOST)
    try:
        def is_open() -> bool:
            with socket.socket() as probe:
                return probe.connect_ex(("127.0.0.1", near)) == 0

        until(is_open)
        with socket.create_connection(("127.0.0.1", near), PATIENCE_S) as through:
            through.settimeout(PATIENCE_S)
            assert through.recv(1) == b"", "the client listens, but nobody is at the other end"
    finally:
        client.kill()
        client.wait()
    assert door.say("-A", "-X", HOST, "status").returncode == 0  # asked for, not given, not missed
    assert stops(door) == 0


def test_sftp_scp_and_other_programs_are_refused(door: Door, tmp_path: Path) -> None:
    there = f"{HOST}:/etc/passwd"
    assert door.say(HOST, program="sftp", text="ls\n").returncode == 255
    for more in ((), ("-O",)):
        assert door.say(*more, there, str(tmp_path / "p"), program="scp").returncode != 0
        assert not (tmp_path / "p").exists()
    assert door.say("-s", HOST, "netconf").returncode == 255
    assert door.say(HOST, "sh -c id").returncode == 2


def test_a_killed_client_leaves_nothing_behind(door: Door) -> None:
    client = door.begin(HOST, "goto", "3", "4")
    until(has_run(door))
    client.kill()
    client.wait()
    until(lambda: stops(door) > 0)
    until(lambda: door.say(HOST, "status").stdout.endswith("nobody drives\n"))


def test_the_door_is_opened_again_after_a_crash_and_what_it_drove_stops(door: Door) -> None:
    client = door.begin(HOST, "goto", "3", "4")
    until(has_run(door))
    first = door.link.pid
    assert first is not None
    os.kill(first, signal.SIGKILL)
    until(lambda: stops(door) > 0)
    assert client.wait(PATIENCE_S) == 255
    until(lambda: door.link.step(100.0, door.running.address))
    door.link.step(200.0, door.running.address)
    assert door.link.pid not in (None, first)
    assert door.say(HOST, "stop").returncode == 0


def test_a_door_that_hangs_is_opened_again_and_what_it_drove_stops(door: Door) -> None:
    client = door.begin(HOST, "goto", "3", "4")
    until(has_run(door))
    first = door.link.pid
    assert first is not None and not door.link.step(300.0, door.running.address)
    os.kill(first, signal.SIGSTOP)
    until(lambda: door.link.step(300.0, door.running.address))
    until(lambda: stops(door) > 0)
    assert client.wait(PATIENCE_S) == 255
    door.link.step(400.0, door.running.address)
    assert door.link.pid not in (None, first)
    assert door.say(HOST, "stop").returncode == 0


def test_twenty_come_at_once(door: Door) -> None:
    clients = [door.begin(HOST, "status") for _ in range(20)]
    assert [client.wait(PATIENCE_S) for client in clients] == [0] * 20
    assert all("nobody drives" in (client.stdout.read() if client.stdout else "") for client in clients)


def test_a_large_paste_holds_up_nobody(door: Door) -> None:
    with subprocess.Popen(door.words("-tt", HOST), stdin=subprocess.PIPE, stdout=subprocess.PIPE) as paster:
        assert paster.stdin is not None and paster.stdout is not None
        out = paster.stdout.fileno()
        shown: list[bytes] = []
        reads = iter(lambda: os.read(out, 65536), b"")  # he reads what he is sent: it is the keys that are too many
        threading.Thread(target=shown.extend, args=(reads,), daemon=True).start()
        try:
            until(lambda: b"pluto>" in b"".join(shown))
            paster.stdin.write(b"x" * 208_000)
            paster.stdin.flush()
            assert door.say(HOST, "stop").returncode == 0 and stops(door) == 1
            paster.stdin.write(b"\x03")
            paster.stdin.flush()
            until(lambda: stops(door) == 2)
        finally:
            paster.kill()


def test_a_script_that_runs_ahead_of_what_it_drives_is_ended(door: Door) -> None:
    done = door.say(HOST, text="goto 3 4\n" + "status\n" * 200_000)
    assert done.returncode == 1 and "characters that wait for the line before them" in done.stderr
    until(lambda: stops(door) > 0)


class Terminal:
    """The client in a tmux window."""

    def __init__(self, door: Door, *more: str) -> None:
        self._tmux = ["tmux", "-L", f"pluto-{os.getpid()}-{id(self)}", "-f", "/dev/null"]
        words = " ".join(f"'{word}'" for word in door.words("-t", *more))
        subprocess.run([*self._tmux, "new-session", "-d", "-x", "110", "-y", "24", f"{words}; echo EXIT $?; sleep 60"], check=True)

    def keys(self, *keys: str) -> None:
        subprocess.run([*self._tmux, "send-keys", *keys], check=True)

    def screen(self) -> str:
        return subprocess.run([*self._tmux, "capture-pane", "-p"], capture_output=True, text=True, check=True).stdout

    def shows(self, text: str) -> None:
        until(lambda: text in self.screen(), told=self.screen)

    def close(self) -> None:
        subprocess.run([*self._tmux, "kill-server"], check=False)


@pytest.fixture
def window(door: Door) -> Iterator[Callable[..., Terminal]]:
    opened: list[Terminal] = []

    def open_one(*more: str) -> Terminal:
        opened.append(Terminal(door, *more))
        return opened[-1]

    yield open_one
    for terminal in opened:
        terminal.close()


@needs_tmux
def test_a_conversation_on_a_terminal(door: Door, window: Callable[..., Terminal]) -> None:
    terminal = window(HOST)
    terminal.shows("pluto>")
    terminal.shows("no mission")
    terminal.keys("wallf")
    terminal.shows("follow the wall on that side")
    terminal.keys("Tab")
    terminal.shows("pluto> wallfollow")
    terminal.keys(" x", "Enter")
    terminal.shows('wallfollow: SIDE: expected one of left, right, found "x"')
    terminal.keys("goto 3 4", "Enter")
    until(has_run(door))
    before = stops(door)
    terminal.keys("C-c")
    until(lambda: stops(door) > before)
    terminal.shows("stopped")
    terminal.keys("C-d")
    terminal.shows("EXIT 0")


@needs_tmux
def test_ctrl_c_in_one_command_on_a_terminal_is_stop(door: Door, window: Callable[..., Terminal]) -> None:
    terminal = window(HOST, "goto", "3", "4")
    until(has_run(door))
    terminal.keys("C-c")
    until(lambda: stops(door) > 0)
    terminal.shows("EXIT 130")
    assert "stopped" in terminal.screen()


# ---------------------------------------------------------------------- before it starts


KEY = "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIJhxbGYTWpEBiWTHcjCbPdUQ4sKbp8Wz4bMMyH0T9Z4q me"


@pytest.mark.parametrize(
    ("text", "mode", "codes"),
    [
        (f"# me\n{KEY}\n", 0o600, []),
        (None, 0o600, [(0, "no-keys")]),
        ("", 0o600, [(0, "no-keys")]),
        ("# nobody yet\n\n", 0o600, [(0, "no-keys")]),
        (f"{KEY}\nssh-ed25519 AAAA\nhello\n", 0o600, [(2, "bad-key"), (3, "bad-key")]),
        (f"{KEY}\n", 0o622, [(0, "unsafe-keys")]),
    ],
)
def test_a_file_of_keys_is_read_before_anything_moves(tmp_path: Path, text: str | None, mode: int, codes: list[tuple[int, str]]) -> None:
    file, faults = tmp_path / "keys", Faults()
    if text is not None:
        file.write_text(text)
        file.chmod(mode)
    check_keys(file, faults)
    found = [(fault.line, fault.code) for fault in faults.in_order()]
    assert found == codes
    assert all(fault.mend for fault in faults.in_order())


def test_without_keys_a_run_does_not_start(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["run", "t01_say_hello.xml", "--ssh", "127.0.0.1:0", "--ssh-keys", str(tmp_path / "none")]
    assert pluto(arguments) == 2
    said = capsys.readouterr().err
    assert "none: error: nobody could log in by ssh" in said and "ssh-keygen -t ed25519" in said
    assert pluto(["run", "t01_say_hello.xml", "--ssh-keys", "x"]) == 2
    assert pluto(["run", "t01_say_hello.xml", "--ssh", "127.0.0.1:99999", "--ssh-keys", "x"]) == 2
    assert "--ssh: error: bad address" in capsys.readouterr().err


def test_the_host_key_is_made_once_and_is_its_owners_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    path = host_key()
    made = path.read_bytes()
    assert stat.S_IMODE(path.stat().st_mode) == 0o600 and host_key().read_bytes() == made
    path.chmod(0o644)
    with pytest.raises(InputError, match="others may read the host key"):
        host_key()
    path.chmod(0o600)
    path.write_text("no key")
    with pytest.raises(InputError, match="is no host key"):
        host_key()


def test_ports_that_are_taken_are_told(door: Door) -> None:
    with pytest.raises(InputError, match="cannot listen on"):
        SshLink(SshRequest(door.link.address, door.keys), host_key())


def test_a_failed_run_over_ssh_is_exit_1(door: Door) -> None:
    door.running.on_step = lambda: door.running.robot.runs.update(dict.fromkeys(door.running.robot.runs, RunState("failed", "stuck", "a wall")))
    try:
        failed = door.say(HOST, "goto", "3", "4")
        assert (failed.returncode, failed.stdout) == (1, "failed: stuck: a wall\n")
    finally:
        door.running.on_step = lambda: None
