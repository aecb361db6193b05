"""A person by ssh at a whole robot, beside a gateway that asks programs for TLS and a token."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

pytest.importorskip("asyncssh")
pytest.importorskip("prompt_toolkit")
NEEDED = ("ssh", "ssh-keygen", "openssl")
if any(shutil.which(program) is None for program in NEEDED):
    pytest.skip(f"one of {', '.join(NEEDED)} is not installed", allow_module_level=True)

TOKEN = "0123456789abcdef-anna"
MORNING = """\
pause
goto 3 3.2          # on the way
maketurn 20
wrist point 20 5
wrist>
state
home
back
setpose 3 3.2 0
loc get 2
stop motion
avoid velocity 0.1 0 0.5
avoid release
drive velocity 0.1 0 0.5
start motion
params avoid.goto_tolerance_m=0.25
params avoid.goto_tolerance_m
events warning
resume
status
"""


class Robot:
    """A run in a process of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", "anna@desk", "-f", folder / "id"], check=True)
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-keyout", "key.pem", "-out", "cert.pem", "-days", "1",
                        "-subj", "/CN=robot"], cwd=folder, check=True, capture_output=True)  # fmt: skip
        (folder / "people.toml").write_text(f'[anna]\ntoken = "{TOKEN}"\nscopes = ["watch", "drive"]\n')
        (folder / "people.toml").chmod(0o600)
        command = [sys.executable, "-m", "pluto_bt", "run", "patrol.xml", "--port", "goals=8,3;10.5,8;2,3.5", "--port", "rounds=50", "--realtime",
                   "--speed", "4", "--gateway", "127.0.0.1:0", "--gateway-tls", f"{folder}/cert.pem,{folder}/key.pem", "--gateway-tokens",
                   f"{folder}/people.toml", "--ssh", "127.0.0.1:0", "--ssh-keys", f"{folder}/id.pub"]  # fmt: skip
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.gateway, self.ssh = self._told(r"listening on 127\.0\.0\.1:(\d+)"), self._told(r"ssh -p (\d+)")

    def _told(self, pattern: str) -> str:
        assert self.process.stdout is not None
        heard = ""
        for line in self.process.stdout:
            heard += line
            found = re.search(pattern, line)
            if found:
                return found[1]
        raise AssertionError(f"the run ended without a line like {pattern}:\n{heard}")

    def by_ssh(self, *words: str, text: str = "") -> subprocess.CompletedProcess[str]:
        options = [f"UserKnownHostsFile={self.folder}/known", "StrictHostKeyChecking=no", "IdentitiesOnly=yes", "LogLevel=ERROR"]
        command = ["ssh", "-F", "none", *(part for option in options for part in ("-o", option)), "-i", f"{self.folder}/id", "-p", self.ssh]
        return subprocess.run([*command, "127.0.0.1", *words], input=text, capture_output=True, text=True, timeout=60)

    def pluto(self, *words: str, **environment: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "pluto_bt", "shell", f"127.0.0.1:{self.gateway}", *words]
        return subprocess.run(command, capture_output=True, text=True, timeout=60, env={**os.environ, **environment})


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Robot]:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    one = Robot(tmp_path)
    yield one
    if one.process.poll() is None:
        one.process.kill()
    one.process.communicate()


def test_a_morning_round_by_ssh(robot: Robot) -> None:
    done = robot.by_ssh(text=MORNING)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert done.stdout.count("succeeded\n") == 5
    for line in ("wrist/state  at ", "  pose             3 3.2 0 0 0 0", "motion stopped", "avoidance released", "motion started",
                 "avoid.goto_tolerance_m                   0.25 m", "mission Patrol: running"):  # fmt: skip
        assert line in done.stdout, done.stdout
    assert robot.by_ssh("stop").stdout == "stopped\n"
    assert "operator-stop" in robot.by_ssh("status").stdout
    assert "shell anna@desk stopped the robot" in robot.by_ssh("why").stdout, "the door's own token has no name of its own"

    assert "unknown node" in robot.by_ssh("do", "GoTu", "goal=1,2").stderr

    certificate = {"PLUTO_CERTIFICATE": f"{robot.folder}/cert.pem"}
    assert robot.pluto("stop", **certificate).stdout == "stopped\n", "a stop is for anyone"
    stranger = robot.pluto("pose", **certificate)
    assert stranger.returncode == 1 and "unauthorised" in stranger.stderr
    anna = {**certificate, "PLUTO_TOKEN": TOKEN}
    assert robot.pluto("pose", **anna).stdout.startswith("x ")
    tuned = robot.pluto("params", "avoid.goto_tolerance_m=0.2", **anna)
    assert tuned.returncode == 1 and "expected somebody with the scope tune, found anna" in tuned.stderr

    robot.process.send_signal(signal.SIGINT)
    assert robot.process.wait(60) == 130
    assert robot.by_ssh("stop").returncode == 255, "who is at the door goes with the run"
