"""What the environment holds for a gateway beyond the loopback: every command shows it, and a stop needs no name."""

from __future__ import annotations

import io
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from pluto_bt.commands import ps, record, stop, tree, why
from pluto_bt.gateway.client import Client
from pluto_bt.gateway.errors import UnheardError
from pluto_bt.gateway.shell.main import main as shell

from .conftest import Running
from .test_access import access_of, make_certificates, people_file

TOKEN = "0123456789abcdef-anna"
needs_openssl = pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed")
COMMANDS = {"ps": ps.main, "why": why.main, "stop": stop.main, "tree": tree.main, "record": record.main}


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Running, Path]]:
    """A gateway with TLS that asks who comes, and the file of its certificate."""
    folder = tmp_path_factory.mktemp("guarded")
    make_certificates(folder)
    access = access_of(f"{folder / 'cert.pem'},{folder / 'key.pem'}", str(people_file(folder)))
    running = Running(access=access)
    running.pump()
    yield running, folder / "cert.pem"
    running.end()


@pytest.fixture
def at(guarded: tuple[Running, Path], monkeypatch: pytest.MonkeyPatch) -> str:
    running, certificate = guarded
    running.robot.did.clear()
    monkeypatch.setenv("PLUTO_CERTIFICATE", str(certificate))
    monkeypatch.setenv("PLUTO_TOKEN", TOKEN)
    return str(running.address)


def words_of(command: str, at: str, folder: Path) -> list[str]:
    return ["--gateway", at, *([str(folder / "box.mcap"), "--seconds", "0.1"] if command == "record" else [])]


@needs_openssl
@pytest.mark.parametrize("command", ["ps", "why", "stop"])
def test_a_command_shows_token_and_certificate(command: str, at: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert COMMANDS[command](words_of(command, at, tmp_path)) == 0, capsys.readouterr().err


@needs_openssl
@pytest.mark.parametrize("command", ["tree", "record"])
def test_a_command_that_finds_nothing_has_come_as_far_as_the_robot(
    command: str, at: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ["no/such/topic"] if command == "record" else []
    assert COMMANDS[command]([*words_of(command, at, tmp_path), *(["--topic", *words] if words else [])]) == 1
    told = capsys.readouterr().err
    assert "unknown-topic" in told if words else "no tree was ticked yet" in told


@needs_openssl
def test_anybody_stops_it_without_a_token_or_with_a_wrong_one(
    at: str, guarded: tuple[Running, Path], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for token in ("", "0123456789abcdef-nobody"):
        monkeypatch.setenv("PLUTO_TOKEN", token)
        out = io.StringIO()
        assert shell([at, "stop"], out, out) == 0, out.getvalue()
        assert stop.main(["--gateway", at]) == 0, capsys.readouterr().err
    assert [did[0] for did in guarded[0].robot.did].count("stop") == 4


@needs_openssl
def test_who_forgot_the_token_is_told_its_name(at: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.delenv("PLUTO_TOKEN")
    assert ps.main(["--gateway", at]) == 1
    out = io.StringIO()
    assert shell([at, "pose"], out, out) == 1
    for told in (capsys.readouterr().err, out.getvalue()):
        assert "unauthorised" in told and "PLUTO_TOKEN is not set" in told


@needs_openssl
def test_who_forgot_the_certificate_is_told_its_name(at: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.delenv("PLUTO_CERTIFICATE")
    out = io.StringIO()
    assert stop.main(["--gateway", at]) == 1
    assert shell([at, "stop"], out, out) == 1
    for told in (capsys.readouterr().err, out.getvalue()):
        assert "PLUTO_CERTIFICATE" in told and "pluto run" not in told
    host, _, port = at.rpartition(":")
    with pytest.raises(UnheardError, match="one with TLS"):
        Client(host, int(port), name="anna", timeout_s=1.0)


@needs_openssl
def test_a_certificate_for_a_gateway_without_tls_is_told(lasting: Running, guarded: tuple[Running, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PLUTO_CERTIFICATE", str(guarded[1]))
    out = io.StringIO()
    assert shell([str(lasting.address), "stop"], out, out) == 1
    assert "no TLS with" in out.getvalue() and "PLUTO_CERTIFICATE" in out.getvalue()


def test_nobody_there_is_told_how_to_begin(capsys: pytest.CaptureFixture[str]) -> None:
    assert stop.main(["--gateway", "127.0.0.1:9"]) == 1
    assert "pluto run MISSION.xml" in capsys.readouterr().err
