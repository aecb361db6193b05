"""One line to many sockets: the same contract for every way to send it, and for the table of sockets above it."""

from __future__ import annotations

import errno
import os
import socket
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.gateway.burst import Burst, Ints, Writes, fastest
from pluto_bt.gateway.outlets import Outlet, Outlets
from pluto_bt.gateway.uring import ENTRIES, Uring

from .conftest import uring

LINE = b'<value topic="operator/word" seq="1"/>\n'


class Ends:
    """Pairs of sockets: ours, which never block, and theirs."""

    def __init__(self, n: int) -> None:
        pairs = [socket.socketpair() for _ in range(n)]
        self.ours, self.theirs = [pair[0] for pair in pairs], [pair[1] for pair in pairs]
        for one in (*self.ours, *self.theirs):
            one.setblocking(False)

    @property
    def fds(self) -> Ints:
        return np.array([one.fileno() for one in self.ours], np.int32)

    def heard(self, i: int) -> bytes:
        """All that has come to this one."""
        heard = b""
        while True:
            try:
                data = self.theirs[i].recv(1 << 20)
            except BlockingIOError:
                return heard
            if not data:
                return heard
            heard += data

    def close(self) -> None:
        for one in (*self.ours, *self.theirs):
            one.close()


@pytest.fixture
def ends() -> Iterator[Ends]:
    made = Ends(8)
    yield made
    made.close()


@pytest.mark.parametrize("rounds", [0, 1, 3, ENTRIES // 8 + 3])
def test_a_line_goes_whole_to_every_socket(burst: Burst, ends: Ends, rounds: int) -> None:
    fds = np.tile(ends.fds, rounds)
    for _ in range(3):
        assert burst.send(fds, LINE).tolist() == [len(LINE)] * len(fds)
        assert [ends.heard(i) for i in range(8)] == [LINE * rounds] * 8


def test_lines_come_in_the_order_of_their_bursts_however_long_these_are(burst: Burst, ends: Ends) -> None:
    rng = np.random.default_rng(3)
    expected = [b""] * 8
    for k in range(400):
        chosen = rng.permutation(8)[: rng.integers(1, 9)]
        line = b"%d," % k * int(rng.integers(1, 20))
        assert (burst.send(ends.fds[chosen], line) == len(line)).all()
        for i in chosen.tolist():
            expected[i] += line
        if k % 20 == 19:
            assert [ends.heard(i) for i in range(8)] == expected
            expected = [b""] * 8


def test_each_socket_says_for_itself_how_much_it_took(burst: Burst, ends: Ends) -> None:
    big = bytes(range(256)) * 4096
    fds = ends.fds
    took = burst.send(fds[3:4], big).tolist()[0]
    assert 0 < took < len(big), "a socket that can take a part takes it"
    ends.theirs[5].close()
    closed = fds[6]
    ends.ours[6].close()
    said = burst.send(fds, LINE).tolist()
    assert said == [len(LINE)] * 3 + [-errno.EAGAIN, len(LINE), -errno.EPIPE, -errno.EBADF, len(LINE)] and closed == fds[6]
    assert ends.heard(3) == big[:took]
    assert ends.heard(2) == ends.heard(7) == LINE
    assert burst.send(fds[3:4], LINE).tolist() == [len(LINE)], "who has read may be sent to again"


class Moody(Uring):
    """A ring whose kernel takes no more than `takes` sends at a time; with less than one it has no memory at all."""

    takes = ENTRIES

    def _kernel(self, number: int, *words: int) -> int:
        if len(words) == 4:
            if self.takes < 1:
                self.takes += 1
                raise OSError(errno.EAGAIN, os.strerror(errno.EAGAIN))
            words = (words[0], min(self.takes, words[1]), min(self.takes, words[2]), words[3])
        return super()._kernel(number, *words)


def test_a_kernel_that_takes_a_few_at_a_time_is_asked_again(ends: Ends) -> None:
    uring().close()
    ring = Moody()
    ring.takes = 3
    assert ring.send(ends.fds, LINE).tolist() == [len(LINE)] * 8
    ring.takes = 0
    assert ring.send(ends.fds, LINE).tolist() == [-errno.EAGAIN] * 8, "nothing was sent, and it may be tried again"
    assert ring.send(ends.fds[:2], b"2").tolist() == [1, 1]
    assert [ends.heard(i) for i in range(8)] == [LINE + b"2"] * 2 + [LINE] * 6
    ring.close()


def test_there_is_always_a_way(monkeypatch: pytest.MonkeyPatch) -> None:
    def forbidden(self: Uring) -> None:
        raise PermissionError(errno.EPERM, os.strerror(errno.EPERM))

    monkeypatch.setattr(Uring, "__init__", forbidden)
    assert isinstance(fastest(), Writes)


class Owner:
    """Whose socket it is; what of a line the socket did not take is his."""

    def __init__(self) -> None:
        self.waits = b""

    def is_clear(self) -> bool:
        return not self.waits

    def send_rest(self, rest: bytes) -> None:
        self.waits += rest


def test_what_a_socket_did_not_take_goes_by_the_transport_before_all_else(burst: Burst, ends: Ends) -> None:
    table, owners = Outlets(burst), [Owner() for _ in range(8)]
    slots = np.array([table.add(fd, owner).slot for fd, owner in zip(ends.fds.tolist(), owners, strict=True)], np.intp)
    big = bytes(range(256)) * 4096
    assert table.send(slots[:1], big).all(), "it is on its way"
    assert owners[0].waits and big.endswith(owners[0].waits)
    assert table.send(slots, LINE).tolist() == [False] + [True] * 7, "nothing goes past what waits"
    assert ends.heard(0) + owners[0].waits == big
    owners[0].waits = b""
    assert table.send(slots, LINE).all() and ends.heard(0) == LINE
    ends.theirs[4].close()
    assert table.send(slots, LINE).tolist() == [True] * 4 + [False] + [True] * 3, "the transport shall hear that he is gone"


class Numbers:
    """A `Burst` over sockets whose numbers are given again as soon as they are free."""

    def __init__(self) -> None:
        self.heard: dict[int, list[bytes]] = {}

    def open(self) -> int:
        fd = next(fd for fd in range(3, 99) if fd not in self.heard)
        self.heard[fd] = []
        return fd

    def send(self, fds: Ints, line: bytes) -> Ints:
        assert len(set(fds.tolist())) == len(fds)
        for fd in fds.tolist():
            self.heard[fd].append(line)
        return np.full(len(fds), len(line), np.int32)


@settings(deadline=None)
@given(st.lists(st.one_of(st.just("come"), st.just("hold"), st.just("send"), st.integers(0, 30)), max_size=80))
def test_a_number_that_is_used_again_never_gets_what_was_meant_for_another(steps: list[str | int]) -> None:
    sockets = Numbers()
    table = Outlets(sockets)
    here: list[tuple[int, Outlet, list[bytes]]] = []  # number, outlet, what must come
    for k, step in enumerate(steps):
        if step == "come":
            fd = sockets.open()
            here.append((fd, table.add(fd, Owner()), []))
        elif step == "hold" and here:
            here[k % len(here)][1].hold()
        elif step == "send":
            line = b"%d" % k
            meant = here[k % 3 :: 2]
            assert table.send(np.array([outlet.slot for _, outlet, _ in meant], np.intp), line).all()
            for _, _, expected in meant:
                expected.append(line)
        elif isinstance(step, int) and here:
            fd, outlet, expected = here.pop(step % len(here))
            outlet.close()
            assert sockets.heard.pop(fd) == expected
            outlet.close()
            outlet.hold()
    for fd, _, expected in here:
        assert sockets.heard[fd] == expected
