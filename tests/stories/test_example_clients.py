"""The example clients of other languages drive a real run: to a place, and until Ctrl-C."""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import pytest

from pluto_bt.gateway.client import Client

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "clients"
NEEDS = {"java": ("java", "javac"), "node": ("node",), "c++": ("g++",)}
LONG_S = 60.0
RUN = [sys.executable, "-m", "pluto_bt", "run", "patrol.xml", "--port", "goals=8,3;2,3.5", "--realtime", "--gateway", "127.0.0.1:0", "--json"]


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    """The gateway of a robot whose patrol is paused at its begin."""
    with subprocess.Popen(RUN, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as run:
        assert run.stderr is not None
        found = int(first_line(run.stderr, r"listening on 127\.0\.0\.1:(\d+)")[1])
        with Client(port=found, timeout_s=20.0) as client:
            client.request("mission", op="pause")
        yield found
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=LONG_S)


@pytest.fixture(scope="module", params=NEEDS)
def words(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """How the example is called, compiled where it must be."""
    language, folder = str(request.param), tmp_path_factory.mktemp("example")
    for tool in NEEDS[language]:
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed")
    if language == "c++":
        built = folder / "goto"
        subprocess.run(["g++", "-std=c++17", "-Wall", "-Wextra", "-Werror", "-o", str(built), str(EXAMPLES / "goto.cpp")], check=True)
        return [str(built)]
    if language == "java":
        subprocess.run(["javac", "-Xlint:all", "-Werror", "-d", str(folder), str(EXAMPLES / "Goto.java")], check=True)
        return ["java", "-cp", str(folder), "Goto"]
    return ["node", str(EXAMPLES / "goto.mjs")]


def first_line(stream: IO[str], pattern: str) -> re.Match[str]:
    said = []
    for line in stream:
        said.append(line)
        if found := re.search(pattern, line):
            return found
    raise AssertionError(f"it ended without a line like {pattern}: {said}")


def where(port: int) -> tuple[float, float]:
    with Client(port=port, timeout_s=20.0) as client:
        x_m, y_m, *_ = (client.request("get", topic="Localization/Pose").findtext("pose") or "").split()
    return float(x_m), float(y_m)


def test_it_drives_to_a_place_and_says_how_it_goes(words: list[str], port: int) -> None:
    x_m, y_m = where(port)
    goal = (x_m + 1.0, y_m) if x_m < 6.0 else (x_m - 1.0, y_m)
    done = subprocess.run([*words, "127.0.0.1", str(port), *map(str, goal)], capture_output=True, text=True, timeout=LONG_S, check=False)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[-1].split()[:2] == ["result", "succeeded"]
    poses = [tuple(map(float, line.split()[1:])) for line in lines if line.startswith("pose ")]
    assert len(poses) >= 3 and any(line.startswith("progress running ") for line in lines)
    assert abs(where(port)[0] - goal[0]) < 0.4
    with Client(port=port, timeout_s=20.0) as client:
        assert client.lease("query").get("holder") == "", "it gave the lease back"


def test_ctrl_c_stops_the_robot(words: list[str], port: int) -> None:
    x_m, y_m = where(port)
    goal = (x_m + 3.0, y_m) if x_m < 6.0 else (x_m - 3.0, y_m)
    with subprocess.Popen([*words, "127.0.0.1", str(port), *map(str, goal)], stdout=subprocess.PIPE, text=True) as run:
        assert run.stdout is not None
        first_line(run.stdout, "^progress running ")
        run.send_signal(signal.SIGINT)
        rest, _ = run.communicate(timeout=LONG_S)
    assert run.returncode == 130 and "stopped" in rest and "result succeeded" not in rest
    with Client(port=port, timeout_s=20.0) as client:
        client.subscribe("ATRV2/Drive/Raw", max_rate_hz=10)
        while (value := client.receive(10.0)) is not None and abs(float((value.findtext("velocity") or "").split()[0])) > 0.01:
            pass
        assert value is not None and client.lease("query").get("holder") == ""


def test_what_the_robot_refuses_is_told_and_stops_nobody(words: list[str], port: int) -> None:
    with Client(port=port, timeout_s=20.0) as client:
        client.request("mission", op="resume")
        refused = subprocess.run([*words, "127.0.0.1", str(port), "3", "3"], capture_output=True, text=True, timeout=LONG_S, check=False)
        assert refused.returncode == 1 and "wrong-state: a mission is running" in refused.stderr
        assert client.request("mission", op="state").get("state") == "running"
        client.request("mission", op="pause")
    for wrong in ([], ["127.0.0.1", str(port), "3", "b"], ["127.0.0.1", str(port), "nan", "3"]):
        usage = subprocess.run([*words, *wrong], capture_output=True, text=True, timeout=LONG_S, check=False)
        assert usage.returncode == 2 and "HOST PORT X Y" in usage.stderr
