"""The client over lines that break: what it says again, what it does not, when it tries, what it tells."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.client import Backoff, Client
from pluto_bt.gateway.dialogue import Dialogue
from pluto_bt.gateway.errors import (
    BadRequestError,
    EstoppedError,
    NoAnswerError,
    NoConnectionError,
    NoLeaseError,
    TurnedAwayError,
    WrongStateError,
)
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.port import RunState

from .lines import SOON, Bench


@pytest.fixture
def bench() -> Bench:
    return Bench()


def seqs(client: Client, count: int) -> list[str | None]:
    return [value.get("seq") for value in (client.receive(5.0) for _ in range(count)) if value is not None]


def test_it_subscribes_again_and_goes_on_as_if_nothing_had_been(bench: Bench) -> None:
    client = bench.client()
    client.subscribe("Localization/Pose")
    client.subscribe("tree")
    client.request("unsubscribe", topic="tree")
    bench.robot.write("Localization/Pose", m.Pose(0.0))
    assert seqs(client, 1) == ["1"]
    bench.cut()
    bench.on_step = lambda: bench.robot.write("Localization/Pose", m.Pose(bench.now_s))
    bench.on_step()
    assert len(seqs(client, 3)) == 3
    assert len(bench.lines) == 2
    assert {message.tag for message in client.pending} <= {"value"}, "the answers to what it said again are not for the program"


def test_it_tries_again_after_growing_waits_until_somebody_gives_up(bench: Bench) -> None:
    client = bench.client()
    bench.go_on(1.0 - bench.now_s)
    bench.is_down = True
    bench.cut()
    bench.tried_s.clear()
    with pytest.raises(NoConnectionError, match=r"no connection to 127\.0\.0\.1:7500"):
        client.receive(4.0)
    assert bench.tried_s == [1.1, 1.3, 1.7, 2.5, 3.5, 4.5]
    bench.is_down = False
    assert client.request("ping", t="1").get("t") == "1"
    assert client.is_connected


def test_a_gateway_that_turns_it_away_at_once_is_not_stormed(bench: Bench) -> None:
    client = bench.client()
    bench.on_step = lambda: bench.lines[-1].close()
    bench.cut()
    bench.tried_s.clear()
    with pytest.raises(NoConnectionError):
        client.receive(10.0)
    assert len(bench.tried_s) < 16, bench.tried_s


def test_a_stop_is_said_again_until_it_is_heard(bench: Bench) -> None:
    client = bench.client(name="anna")
    bench.is_deaf, bench.on_step = True, lambda: bench.now_s > 1.0 and bench.lines[-1].is_broken is False and bench.is_deaf and heal(bench)
    client.stop()
    assert bench.robot.did == [("stop", "anna")]


def heal(bench: Bench) -> None:
    bench.is_deaf = False
    bench.cut()


def test_what_may_not_be_done_twice_is_told_to_be_uncertain(bench: Bench) -> None:
    client = bench.client()
    client.lease()
    bench.is_silent = True
    bench.on_step = lambda: bench.now_s > 1.0 and bench.is_silent and recover(bench)
    with pytest.raises(NoConnectionError, match="before it answered <command>; whether that was done is not known"):
        client.command("drive", 0, velocity=(0.1, 0.0))


def recover(bench: Bench) -> None:
    bench.is_silent = False
    bench.cut()


def test_a_command_of_a_named_session_acts_once_although_its_answer_was_lost(bench: Bench) -> None:
    client = bench.client(session="anna")
    client.lease(ttl_s=30, on_loss="continue")
    bench.is_silent = True
    bench.on_step = lambda: bench.now_s > 1.0 and bench.is_silent and recover(bench)
    client.command("drive", 0, velocity=(0.1, 0.0))
    assert [deed[:3] for deed in bench.robot.did] == [("command", "drive", 0)]
    assert len(bench.lines) == 2


def test_a_run_of_a_named_session_is_followed_over_a_lost_line(bench: Bench) -> None:
    client = bench.client(session="anna")
    told: list[str] = []
    over = RunState("succeeded", "", "there", (("reason", "x"),))
    bench.on_step = lambda: cut_then_end(bench, over)
    with client.driving(on_loss="continue"):
        result = client.run("GoTo", goal="3;4", on_progress=lambda state, text: told.append(state))
    assert (result.is_success, result.text, result.outputs) == (True, "there", {"reason": "x"})
    assert [deed[0] for deed in bench.robot.did] == ["run"] and told
    other = bench.client(session="anna")
    with other.driving():
        assert other.run("GoTo", goal="3;4") == result, "the second program's ids are new: its run is another"
    assert [deed[0] for deed in bench.robot.did] == ["run", "run"]


def cut_then_end(bench: Bench, over: RunState) -> None:
    """The first run loses its line after a while and ends on the next one; the second ends at once."""
    for run, state in bench.robot.runs.items():
        if state.state == "running" and (run != "r1" or len(bench.lines) > 1):
            bench.robot.runs[run] = over
        elif run == "r1" and bench.now_s > 1.0 and len(bench.lines) == 1:
            bench.cut()


def test_a_lease_is_renewed_while_calls_go_on_and_no_longer(bench: Bench) -> None:
    client, other = bench.client(name="anna"), bench.client(name="bert")
    with client.driving(ttl_s=1.0):
        assert client.receive(5.0) is None
        assert client.lease("query").get("mine") == "true"
        bench.go_on(2.0)  # the program works on something else
        assert bench.robot.did == [("stop", "the lease of anna ran out")]
        other.lease()
        client.receive(1.0)
        assert isinstance(client.dialogue.lease_error, NoLeaseError)
        with pytest.raises(NoLeaseError, match="held by bert"):
            client.command("drive", 0)
    assert other.lease("query").get("mine") == "true", "what is not ours is not given back"


def test_a_lease_that_went_with_the_line_is_not_taken_again(bench: Bench) -> None:
    client = bench.client(name="anna")
    with client.driving(ttl_s=5.0):
        bench.cut()
        assert client.receive(1.0) is None
        with pytest.raises(NoLeaseError, match="held by nobody"):
            client.run("GoTo", goal="1;1")
    assert [deed[0] for deed in bench.robot.did] == ["stop"]


def test_whatever_interrupts_a_run_stops_the_robot(bench: Bench) -> None:
    client = bench.client(name="anna")

    def interrupt(state: str, text: str) -> None:
        raise KeyboardInterrupt

    with client.driving(), pytest.raises(KeyboardInterrupt):
        client.run("GoTo", goal="1;1", on_progress=interrupt)
    assert ("stop", "anna") in bench.robot.did


def test_a_refused_run_stops_nobody(bench: Bench) -> None:
    client = bench.client(name="anna")
    with client.driving(), pytest.raises(BadRequestError, match="unknown node"):
        client.run("Fly", goal="1;1")
    with client.driving():
        bench.robot.mission_now = m.MissionState(0.0, "patrol", 1, "running")
        with pytest.raises(WrongStateError, match="pause it first"):
            client.run("GoTo", goal="1;1")
        bench.robot.mission_now = m.MissionState(0.0)
        bench.robot.latched = "somebody fell"
        with pytest.raises(EstoppedError, match="somebody fell"):
            client.run("GoTo", goal="1;1")
    assert bench.robot.did == []


def test_a_line_that_fell_silent_is_noticed_and_replaced(bench: Bench) -> None:
    client = bench.client()
    client.subscribe("events")
    first = bench.lines[-1]
    bench.is_silent = bench.is_deaf = True
    bench.on_step = lambda: first.is_broken and revive(bench)
    assert client.receive(30.0) is not None, "what is said on the new line"
    assert 14.0 < bench.now_s < 17.0, "10 s of silence, 5 s for an answer to the ping"


def revive(bench: Bench) -> None:
    bench.is_silent = bench.is_deaf = False
    if not bench.robot.events and len(bench.lines) > 1:
        bench.robot.says("hello")


def test_a_connection_that_is_kept_open_survives_hours_without_a_word(bench: Bench) -> None:
    client = bench.client()
    assert client.receive(300.0) is None
    assert len(bench.lines) == 1


def test_who_only_listens_is_not_taken_for_gone(bench: Bench) -> None:
    bench.on_step = lambda: bench.robot.write("Localization/Pose", m.Pose(bench.now_s))
    client = bench.client()
    client.subscribe("Localization/Pose", max_rate_hz=1.0)
    while bench.now_s < 150.0:
        assert client.receive(5.0) is not None
    assert len(bench.lines) == 1


def test_without_a_backoff_the_end_of_the_line_is_the_end(bench: Bench) -> None:
    client = bench.client(backoff=None)
    bench.cut()
    for _ in range(2):
        with pytest.raises(NoConnectionError, match=r"closed the connection"):
            client.receive(1.0)


def test_the_end_of_the_run_is_the_end(bench: Bench) -> None:
    client = bench.client()
    bench.gateway.stop()
    for _ in range(2):
        with pytest.raises(TurnedAwayError) as error:
            client.request("ping")
        assert error.value.code == "shutdown"


@pytest.fixture
def full(bench: Bench) -> Bench:
    """All places but the operators' are taken, until the tenth second."""
    crowd = [bench.gateway.connect() for _ in range(Limits().clients - Limits().operator_places)]
    bench.on_step = lambda: [one.close() for one in crowd] if bench.now_s > 10.0 else None  # type: ignore[assignment,return-value]
    return bench


TURNED_AWAY = "the last places are for operators"


@pytest.mark.parametrize("backoff", [None, SOON])
def test_who_finds_no_place_hears_so_in_his_first_request(full: Bench, backoff: Backoff | None) -> None:
    for tag, more in (("ping", {}), ("lease", {"op": "acquire"})):
        with pytest.raises(TurnedAwayError, match=TURNED_AWAY) as error:
            full.client(backoff).request(tag, **more)
        assert error.value.code == "too-many-connections" and "not known" not in error.value.text
    with pytest.raises(TurnedAwayError, match=TURNED_AWAY):
        full.client(backoff, name="anna")


def test_who_finds_no_place_is_let_in_when_there_is_one(full: Bench) -> None:
    full.go_on(8.0)
    client = full.client(name="anna")
    client.lease()
    assert len(full.lines) > 2


def test_who_reads_too_slowly_hears_so_and_that_his_request_may_be_done(bench: Bench) -> None:
    client = bench.client(backoff=None)
    bench.is_silent = True
    one = client.dialogue.ask("lease", "", {"op": "acquire"}, bench.now_s)
    client.dialogue.feed(b'<error code="slow-consumer" fatal="true">600000 bytes wait</error>\n', bench.now_s)
    client.dialogue.closed("the gateway closed the connection")
    with pytest.raises(TurnedAwayError, match="600000 bytes wait; whether <lease> was done is not known"):
        one.answer()


def test_what_speaks_no_xml_is_no_gateway(bench: Bench) -> None:
    client = bench.client()
    client.dialogue.feed(b"HTTP/1.1 400 Bad Request\r\n", bench.now_s)
    with pytest.raises(TurnedAwayError, match="what answers is no gateway"):
        client.request("ping")


@given(st.lists(st.integers(1, 40), max_size=20))
def test_a_stream_in_pieces_says_what_it_says_whole(sizes: list[int]) -> None:
    lines = '<value topic="tree" seq="1"><text>grün &amp; 日本</text></value>\n \n<event level="info" seq="2">x</event>\n'.encode()
    whole, pieces = Dialogue({}, 5.0, "c"), Dialogue({}, 5.0, "c")
    whole.feed(lines, 0.0)
    at = 0
    for size in [*sizes, len(lines)]:
        pieces.feed(lines[at : at + size], 0.0)
        at += size
    assert [ElementTree.tostring(message) for message in pieces.inbox] == [ElementTree.tostring(message) for message in whole.inbox]
    assert [message.tag for message in pieces.inbox] == ["value", "event"] and pieces.final is None


def test_an_id_that_is_not_answered_is_not_used_again(bench: Bench) -> None:
    client = bench.client()
    client.dialogue.ask("ping", "", {"id": "p"}, bench.now_s)
    with pytest.raises(BadRequestError, match="another request"):
        client.request("ping", id="p", t="2")
    client.receive(0.1)
    assert client.request("ping", id="p", t="3").get("t") == "3"


def test_what_is_only_sent_is_answered_by_receive(bench: Bench) -> None:
    client = bench.client()
    id = client.send("lease", op="renew")
    answer = client.receive(1.0)
    assert answer is not None and (answer.tag, answer.get("id"), answer.get("code")) == ("error", id, "no-lease")
    bench.is_down = True
    bench.cut()
    with pytest.raises(NoConnectionError):
        client.receive(0.5)
    with pytest.raises(NoConnectionError, match="no connection"):
        client.send("ping")


def test_an_answer_that_does_not_come_is_told_and_one_that_comes_late_is_not_heard(bench: Bench) -> None:
    client = bench.client()
    bench.is_silent = True
    with pytest.raises(NoAnswerError, match="no answer to <ping> within 5 s"):
        client.request("ping")
    bench.is_silent = False
    assert client.receive(1.0) is None


def test_what_nobody_reads_is_dropped_at_last(bench: Bench) -> None:
    client = bench.client()
    client.dialogue.feed(b'<event level="info" seq="1">x</event>\n' * 10_007, bench.now_s)
    assert (len(client.pending), client.dialogue.dropped) == (10_000, 7)


def test_a_document_with_faults_tells_where(bench: Bench) -> None:
    client = bench.client()
    asked = client.dialogue.ask("mission", "", {"op": "check"}, bench.now_s)
    fault = f'<error id="{asked.id}" code="bad-mission" line="{{}}" col="7" fatal="false">unknown port</error>\n'
    client.dialogue.feed((fault.format(3) + fault.format(5)).encode(), bench.now_s)
    with pytest.raises(BadRequestError, match="unknown port") as error:
        asked.answer()
    assert (error.value.code, error.value.line, error.value.column) == ("bad-mission", 3, 7)
    assert [message.get("line") for message in client.pending] == ["5"], "further faults are there to be read"
