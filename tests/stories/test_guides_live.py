"""What the guides say of a running robot, done to one: the shell commands, the lines typed by hand, the two Python programs.

The run goes twice as fast as the clock and listens on a free port; each command is given that address. All else is as it stands
in the pages.
"""

from __future__ import annotations

import os
import re
import shlex
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from pluto_bt.cli import main
from tests.doc_tables import ROOT
from tests.test_docs import blocks, commands

PAGE = ROOT / "docs" / "gateway.md"
LONG_S = 60.0


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    """HOST:PORT of a patrol that drives; it is ended by Ctrl-C, and must then be at rest."""
    line = next(line for line in commands(PAGE) if "--realtime" in line)
    assert line in commands(ROOT / "README.md"), "README begins in the same way"
    words = [sys.executable, "-m", "pluto_bt", *shlex.split(line)[1:], "--gateway", "127.0.0.1:0", "--speed", "2", "--max-time", "400"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(words, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as run:
        assert run.stdout is not None
        found = next(found for line in run.stdout if (found := re.search(r"listening on (\S+)", line)))
        yield found[1]
        run.send_signal(2)
        said, _ = run.communicate(timeout=LONG_S)
    assert run.returncode == 130, said
    assert "collisions 0" in said


def test_the_guides_hold_for_a_robot_that_drives(address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    host, port = address.split(":")
    for page in (PAGE, ROOT / "README.md"):
        for line in commands(page):
            if line.startswith(("pluto shell", "pluto ps")) and "<" not in line:  # a script needs its file
                _, command, *words = shlex.split(line)
                code = main(["ps", "--gateway", address] if command == "ps" else [command, address, *words])
                assert code == 0, f"{line}: {capsys.readouterr()}"
    session = next(text for _, name, text in blocks(PAGE) if name == "session")
    assert_answered(session, (host, int(port)))
    for _, name, code_text in blocks(PAGE):
        if name.endswith(".py"):
            program = code_text.replace("7500", port)
            done = subprocess.run([sys.executable, "-c", program], env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True,
                                  timeout=LONG_S, check=False)  # fmt: skip
            assert done.returncode == 0, done.stderr
            assert re.search(r"after [\d.]+ s at|succeeded", done.stdout), done.stdout


def assert_answered(session: str, target: tuple[str, int]) -> None:
    """Type line by line; each is answered by a line that is no error."""
    with socket.create_connection(target, timeout=LONG_S) as connection, connection.makefile("r", encoding="utf-8") as answers:
        for line in session.splitlines():
            connection.sendall(f"{line}\n".encode())
            answer = answers.readline()
            assert answer.startswith("<") and not answer.startswith("<error"), f"{line} {answer}"
