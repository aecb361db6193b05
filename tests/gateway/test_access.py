"""Clients from elsewhere: TLS, tokens, client certificates, scopes; and the audit log of what they changed."""

from __future__ import annotations

import asyncio
import json
import math
import shutil
import socket
import ssl
import subprocess
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.gateway.access import Access, read_access
from pluto_bt.gateway.audit import Audit
from pluto_bt.gateway.client import AsyncClient, Client
from pluto_bt.gateway.errors import TurnedAwayError
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.link import GatewayLink
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.local import LocalGateway
from pluto_bt.gateway.replies import Ok
from pluto_bt.gateway.requests import MissionOp
from pluto_bt.gateway.tally import Tally
from pluto_bt.gateway.wire import Ask, Refused
from pluto_bt.source import Faults

from .conftest import Running
from .robot import FakeRobot

PEOPLE = """
[anna]
token = "0123456789abcdef-anna"
scopes = ["watch", "drive"]
[panel]
certificate = "panel"
scopes = ["watch"]
[chief]
token = "0123456789abcdef-chief"
scopes = ["admin"]
"""
WAIT_S = 60.0


def people_file(folder: Path, text: str = PEOPLE) -> Path:
    file = folder / "people.toml"
    file.write_text(text, encoding="utf-8")
    file.chmod(0o600)
    return file


def access_of(tls: str | None, tokens: str | None) -> Access:
    faults = Faults()
    access = read_access(tls, tokens, faults)
    faults.raise_errors()
    return access


def said(client: object, text: str, gateway: LocalGateway) -> list[str]:
    client.send(text)  # type: ignore[attr-defined]
    gateway.step(gateway.now_s + 0.02)
    return [line.decode() for line in client.received().splitlines()]  # type: ignore[attr-defined]


def code(line: str) -> str:
    return line.split('code="')[1].split('"')[0] if 'code="' in line else line.split(" ")[0].strip("</>")


def test_a_scope_says_what_a_person_may_do(tmp_path: Path) -> None:
    gateway = LocalGateway(FakeRobot(), access=access_of(None, str(people_file(tmp_path))))
    anna, chief, stranger = gateway.connect(), gateway.connect(), gateway.connect()
    assert code(said(anna, '<hello name="boss" token="0123456789abcdef-anna"/>', gateway)[0]) == "hello"
    asked = '<lease op="acquire"/><params/><params op="set"><p name="x">1</p></params><module name="slam" op="stop"/><get topic="tree"/>'
    assert sorted(map(code, said(anna, asked, gateway))) == ["lease_state", "no-value", "params", "read-only", "read-only"]
    (state,) = said(anna, '<lease op="query"/>', gateway)
    assert 'holder="anna"' in state, "the token says who he is, not hello"
    said(chief, '<hello token="0123456789abcdef-chief"/>', gateway)
    assert code(said(chief, '<module name="slam" op="stop"/>', gateway)[0]) == "ok"
    assert code(said(stranger, '<hello token="0123456789abcdef-nobody"/>', gateway)[0]) == "unauthorised"


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("", "no-person"),
        ('[a]\ntoken = "short"\nscopes = ["watch"]\n', "bad-value"),
        ('[a]\nscopes = ["watch"]\n', "missing-parameter"),
        ('[a]\ntoken = "0123456789abcdef"\nscopes = ["wach"]\n', "bad-value"),
        ('[a]\ntoken = "0123456789abcdef"\nscopes = []\n', "bad-value"),
        ("a = 1\n", "bad-value"),
    ],
)
def test_a_bad_file_of_people_is_refused(tmp_path: Path, text: str, code: str) -> None:
    faults = Faults()
    read_access(None, str(people_file(tmp_path, text)), faults)
    (fault,) = faults.in_order()
    assert fault.code == code and (fault.line > 0) == (text != "")


def test_secrets_that_others_may_read_are_refused(tmp_path: Path) -> None:
    file = people_file(tmp_path)
    file.chmod(0o644)
    faults = Faults()
    read_access("one.pem", str(file), faults)
    assert [(fault.code, fault.mend.split(" ")[0]) for fault in faults.in_order()] == [("open-secret", "chmod"), ("bad-option", "openssl")]


def test_the_audit_log_keeps_what_changes_something(tmp_path: Path) -> None:
    audit = tmp_path / "state" / "audit.jsonl"
    gateway = LocalGateway(FakeRobot(), access=access_of(None, str(people_file(tmp_path))), audit=Audit(audit))
    anna = gateway.connect()
    said(anna, '<hello token="0123456789abcdef-anna" session="s"/><get topic="tree"/><stop/><lease op="acquire"/><lease op="renew"/>', gateway)
    said(anna, '<run node="GoTo" goal="1;2"/><run node="Nothing"/><mission op="state"/>', gateway)
    lines = [json.loads(line) for line in audit.read_text(encoding="utf-8").splitlines()]
    assert [(line["name"], line["request"], line["outcome"]) for line in lines] == [
        ("anna", "stop", "ok"), ("anna", "lease", "ok"), ("anna", "run", "ok"), ("anna", "run", "unknown-node"),
    ]  # fmt: skip
    assert lines[2]["content"]["ports"] == {"goal": "1;2"} and "0123456789abcdef" not in audit.read_text(encoding="utf-8")


def test_an_audit_log_that_cannot_be_written_is_told_and_stops_nobody(tmp_path: Path) -> None:
    told: list[str] = []
    (tmp_path / "file").write_text("", encoding="utf-8")
    gateway = LocalGateway(FakeRobot(), audit=Audit(tmp_path / "file" / "audit.jsonl", told.append))
    client = gateway.connect()
    assert [code(line) for line in said(client, "<stop/>", gateway) + said(client, "<stop/>", gateway)] == ["ok", "ok"]
    assert len(told) == 1 and "cannot be written" in told[0]


def test_the_audit_log_keeps_what_was_refused_at_the_door(tmp_path: Path) -> None:
    audit = tmp_path / "audit.jsonl"
    gateway = LocalGateway(FakeRobot(), Limits(outstanding=1), access_of(None, str(people_file(tmp_path))), Audit(audit))
    said(gateway.connect(), '<hello name="eve" token="a guess that is wrong"/>', gateway)
    said(gateway.connect(), '<command target="drive" flags="0"/>', gateway)
    anna = gateway.connect()
    said(anna, '<hello token="0123456789abcdef-anna"/><module name="slam" op="stop"/><get topic="nothing"/>', gateway)
    said(anna, '<command target="drive" flags="0"><velocity>nan 0</velocity></command><lease op="acquire"/><lease op="release"/>', gateway)
    lines = [json.loads(line) for line in audit.read_text(encoding="utf-8").splitlines()]
    assert [(line["name"], line["request"], line["outcome"]) for line in lines] == [
        ("", "hello", "unauthorised"), ("", "command", "unauthorised"), ("anna", "module", "read-only"), ("anna", "command", "bad-value"),
        ("anna", "lease", "busy"), ("anna", "lease", "ok"),
    ]  # fmt: skip
    assert "eve" in lines[0]["content"]["text"] and "a guess" not in audit.read_text(encoding="utf-8")


def test_an_audit_log_goes_on_when_it_can_and_tells_what_it_lost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pluto_bt.gateway.audit.WAITING", 3)
    told: list[str] = []
    folder = tmp_path / "folder"
    folder.write_text("in the way", encoding="utf-8")
    audit = Audit(folder / "audit.jsonl", told.append)
    for number in range(5):
        audit.note_refused(Refused(number, "", "eve", "", "run", "read-only", "no"), 0.0)
    audit.step(0.0)
    folder.unlink()
    audit.step(0.5)
    assert not folder.exists(), "not at each step"
    audit.step(1.0)
    lines = [json.loads(line) for line in (folder / "audit.jsonl").read_text(encoding="utf-8").splitlines()]
    assert ([line.get("client") for line in lines], lines[3]["lines"], len(told)) == ([0, 1, 2, None], 2, 1)
    audit.step(2.0)
    assert len((folder / "audit.jsonl").read_text(encoding="utf-8").splitlines()) == 4


def test_old_audit_logs_move_on_and_long_contents_are_counted_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pluto_bt.gateway.audit.LIMIT_BYTES", 100)
    audit = Audit(tmp_path / "audit.jsonl")
    for number in range(7):
        audit.note_refused(Refused(number, "", "", "", "run", "busy", "x" * 1000), 0.0)
        audit.step(0.0)
    kept = {path.name: json.loads(path.read_text(encoding="utf-8")) for path in tmp_path.iterdir()}
    assert {name: line["client"] for name, line in kept.items()} == {"audit.jsonl": 6} | {f"audit.jsonl.{n}": 6 - n for n in (1, 2, 3, 4)}
    assert kept["audit.jsonl"]["content"] == {"bytes": 1011}


def test_a_flood_of_refusals_is_summed_and_what_was_done_stays_readable(tmp_path: Path) -> None:
    audit = Audit(tmp_path / "audit.jsonl")
    done = Ask(500, "", "anna", MissionOp(op="pause"), "10.0.0.9:1")
    for second in range(60):
        for number in range(640):
            client = number % 64 if second < 30 else second * 640 + number  # in the end each of them calls anew
            audit.note_refused(Refused(client, "", "eve", f"10.0.0.7:{client}", "run", ("no-lease", "busy")[second % 2], "no"), float(second))
        audit.note(done, Ok(), float(second))
        audit.step(float(second))
    audit.note(Ask(500, "", "anna", MissionOp(op="resume"), "10.0.0.9:1"), Ok(), 60.0)
    audit.note(done, Ok(), 61.0)
    audit.end(62.0)
    lines = [json.loads(line) for line in (tmp_path / "audit.jsonl").read_text(encoding="utf-8").splitlines()]
    assert len(lines) < 1_000
    deeds = [(line["content"].get("op"), line.get("times")) for line in lines if line["outcome"] == "ok"]
    assert deeds == [("pause", None), (None, 30), ("pause", None), (None, 28), ("resume", None), ("pause", None)]
    refused = [line for line in lines if line["outcome"] != "ok"]
    assert sum(line.get("times", 1) for line in refused) == 60 * 640, "none is missing in the sums"
    assert {line["since_s"] for line in refused if "times" in line} >= {0.0, 1.0}


@given(st.lists(st.tuples(st.integers(0, 3), st.sampled_from(["a", "b", "no"]), st.floats(0.0, 20.0)), max_size=60))
def test_first_ones_and_sums_come_to_all_that_was_said(said: list[tuple[int, str, float]]) -> None:
    tally, now_s, told = Tally(), 0.0, 0
    for client, kind, later_s in said:
        now_s += later_s
        sums = tally.due(now_s) + (tally.deed(kind) if kind != "no" else [])
        told += sum(one["times"] for one in sums) + tally.is_first((client, kind), ("", kind), {}, now_s)
    assert told + sum(one["times"] for one in tally.due(math.inf)) == len(said)


def test_a_tls_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    faults = Faults()
    (tmp_path / "cert.pem").write_text("")
    read_access(f"{tmp_path / 'cert.pem'},{tmp_path / 'nix.pem'}", None, faults)
    (fault,) = faults.in_order()
    assert "nix.pem" in fault.message and "cert.pem" not in fault.message and fault.found == "No such file or directory"


# real TLS ------------------------------------------------------------------------------------------------------------
def make_certificates(folder: Path) -> None:
    """An authority, a server and a client named `panel`, as a person would make them."""
    def openssl(*words: str) -> None:
        subprocess.run(["openssl", *words], cwd=folder, check=True, capture_output=True)

    key = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes")
    openssl("req", "-x509", *key, "-keyout", "ca.key", "-out", "ca.pem", "-days", "2", "-subj", "/CN=test authority")
    name = ("-subj", "/CN=robot", "-addext", "subjectAltName=IP:127.0.0.1")
    openssl("req", "-x509", *key, "-keyout", "key.pem", "-out", "cert.pem", "-days", "2", *name)
    openssl("req", *key, "-keyout", "panel.key", "-out", "panel.csr", "-subj", "/CN=panel")
    openssl("x509", "-req", "-in", "panel.csr", "-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial", "-out", "panel.pem", "-days", "2")


async def greet_over_tls(address: tuple[str, int], authority: ssl.SSLContext) -> None:
    async with AsyncClient(*address, token="0123456789abcdef-anna", tls=authority) as client:
        assert (await client.request("ping", t="1")).get("t") == "1"


@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed")
def test_over_tls_people_come_by_token_or_certificate(tmp_path: Path, unpumped: Running) -> None:
    make_certificates(tmp_path)
    access = access_of(f"{tmp_path / 'cert.pem'},{tmp_path / 'key.pem'},{tmp_path / 'ca.pem'}", str(people_file(tmp_path)))
    unpumped.link.stop()
    unpumped.link = GatewayLink(unpumped.robot, Address("0.0.0.0", 0), access, Limits(linger_s=0.3, hello_s=1.0))
    unpumped.link.start(0.0)
    unpumped.pump()
    address = ("127.0.0.1", unpumped.address.port)

    def talk(text: str, certificate: str = "") -> str:
        context = ssl.create_default_context(cafile=str(tmp_path / "cert.pem"))
        if certificate:
            context.load_cert_chain(tmp_path / f"{certificate}.pem", tmp_path / f"{certificate}.key")
        with socket.create_connection(address, timeout=WAIT_S) as plain, context.wrap_socket(plain, server_hostname="127.0.0.1") as connection:
            connection.sendall(text.encode())
            heard = b""
            try:
                while data := connection.recv(65536):
                    heard += data
            except ssl.SSLEOFError:
                pass
            return heard.decode()

    assert "<pong" in talk('<hello token="0123456789abcdef-anna"/><ping/><bye/>')
    assert 'code="unauthorised" fatal="true"' in talk("<ping/>")
    assert 'code="timeout" fatal="true"' in talk(""), "hello within hello_s"
    assert "<pong" in talk("<ping/><bye/>", "panel"), "the certificate says who it is"
    assert 'code="read-only"' in talk("<lease op='acquire'/>" + "x", "panel")
    authority = ssl.create_default_context(cafile=str(tmp_path / "cert.pem"))
    with Client(*address, token="0123456789abcdef-anna", tls=authority) as client:
        assert client.lease("query").get("mine") == "false"
    with pytest.raises(TurnedAwayError, match="none of those"):
        Client(*address, token="0123456789abcdef-nobody", tls=authority)
    asyncio.run(greet_over_tls(address, authority))
    talk("<stop/>x")
    assert unpumped.robot.did[-1][0] == "stop", "anyone may stop"
    with socket.create_connection(address, timeout=WAIT_S) as plain:
        plain.sendall(b"<ping/>")  # no TLS: the library ends it
        assert b"<pong" not in plain.recv(4096)


def test_the_audit_log_is_for_the_user_alone(tmp_path: Path) -> None:
    gateway = LocalGateway(FakeRobot(), audit=Audit(tmp_path / "audit.jsonl"))
    said(gateway.connect(), "<stop/>", gateway)
    assert (tmp_path / "audit.jsonl").stat().st_mode & 0o777 == 0o600


def test_who_listens_everywhere_is_called_by_a_name() -> None:
    assert Address("0.0.0.0", 7580).reachable.host not in ("", "0.0.0.0")
    assert Address("127.0.0.1", 7580).reachable == Address("127.0.0.1", 7580)
