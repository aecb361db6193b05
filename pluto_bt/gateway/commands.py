"""What a person can say in the shell: one function a command, each over its own connection, each with an exit code."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TextIO

from pluto_bt.gateway.client import Client, Element, GatewayError
from pluto_bt.gateway.why import why_lines
from pluto_bt.runtime.clock import NS, wall_ns

DONE, FAILED, USAGE = 0, 1, 2
TTL_S = 3.0
RENEW_S = 1.0
POLL_S = 0.2


class UsageError(Exception):
    """The command was not said as it must be."""


@dataclass(frozen=True, slots=True)
class Command:
    """One row of the table: how it is said, what it does, who does it."""

    usage: str
    doc: str
    run: Callable[[Client, Sequence[str], TextIO], int]


def stop(client: Client, words: Sequence[str], out: TextIO) -> int:
    """Zero velocity at once."""
    _numbers(words, 0)
    client.request("stop")
    print("stopped", file=out)
    return DONE


def goto(client: Client, words: Sequence[str], out: TextIO) -> int:
    """Drive to a place on the map."""
    x_m, y_m = _numbers(words, 2)
    return _drive(client, out, "GoTo", goal=f"{x_m:g};{y_m:g}")


def maketurn(client: Client, words: Sequence[str], out: TextIO) -> int:
    """Turn; positive is clockwise, as `MakeTurn` in missions."""
    (angle_deg,) = _numbers(words, 1)
    return _drive(client, out, "MakeTurn", angle_deg=f"{angle_deg:g}")


def pose(client: Client, words: Sequence[str], out: TextIO) -> int:
    """Where the robot believes to be; degrees, for a person reads it."""
    _numbers(words, 0)
    value = client.request("get", topic="Localization/Pose")
    x_m, y_m, _, theta_rad, *_ = map(float, (value.findtext("pose") or "").split())
    print(f"x {x_m:.3f} m   y {y_m:.3f} m   theta {math.degrees(theta_rad):.1f}°   (age {value.get('age')} s)", file=out)
    return DONE


def tree(client: Client, words: Sequence[str], out: TextIO) -> int:
    """The tree now."""
    _numbers(words, 0)
    print((client.request("tree", format="ascii").text or "").rstrip("\n"), file=out)
    return DONE


def status(client: Client, words: Sequence[str], out: TextIO) -> int:
    """The mission and who drives, in one line."""
    _numbers(words, 0)
    mission, lease = client.request("mission", op="state"), client.lease("query")
    step = f" at {mission.get('step')}" if mission.get("step") else ""
    reason = f" ({mission.get('reason')})" if mission.get("reason") else ""
    driver = f"{lease.get('holder')} drives" if lease.get("holder") else "nobody drives"
    print(f"mission {mission.get('name') or '-'}: {mission.get('state')}{reason}{step}; {driver}", file=out)
    return DONE


def why(client: Client, words: Sequence[str], out: TextIO) -> int:
    """Why the robot is, or is not, moving."""
    _numbers(words, 0)
    print("\n".join(why_lines(client)), file=out)
    return DONE


def _mission(op: str) -> Callable[[Client, Sequence[str], TextIO], int]:
    def act(client: Client, words: Sequence[str], out: TextIO) -> int:
        _numbers(words, 0)
        client.request("mission", op=op)
        return status(client, (), out)

    return act


COMMANDS: dict[str, Command] = {
    "stop": Command("stop", "zero velocity at once; works for anyone, at any time", stop),
    "goto": Command("goto X Y", "drive to a place on the map (metres)", goto),
    "maketurn": Command("maketurn DEG", "turn by this angle, positive = clockwise", maketurn),
    "pose": Command("pose", "where the robot believes to be", pose),
    "tree": Command("tree", "the tree now", tree),
    "status": Command("status", "the mission, and who drives", status),
    "pause": Command("pause", "pause the mission", _mission("pause")),
    "resume": Command("resume", "go on with the mission", _mission("resume")),
    "abort": Command("abort", "end the mission", _mission("abort")),
    "why": Command("why", "why the robot is, or is not, moving", why),
}


def _numbers(words: Sequence[str], count: int) -> tuple[float, ...]:
    try:
        values = tuple(float(word) for word in words)
    except ValueError:
        raise UsageError(f"expected numbers, found {' '.join(words)}") from None
    if len(values) != count or not all(map(math.isfinite, values)):
        raise UsageError(f"expected {count} numbers, found {' '.join(words) or 'none'}")
    return values


def _drive(client: Client, out: TextIO, node: str, **ports: str) -> int:
    """Run one node under the lease, and tell how it went. Ctrl-C stops the robot."""
    client.lease("acquire", ttl_s=TTL_S, on_loss="stop")
    try:
        ack = client.request("run", node=node, **ports)
        result = _follow(client, ack.get("run", ""), out)
    except KeyboardInterrupt:
        client.request("stop")
        raise
    finally:
        _let_go(client)
    state, reason, text = (result.get(name, "") for name in ("state", "reason", "text"))
    print(": ".join(word for word in (state, reason, text) if word), file=out)
    return DONE if state == "succeeded" else FAILED


def _follow(client: Client, run: str, out: TextIO) -> Element:
    """Hold the lease and show progress until the run's result comes."""
    renew_ns = wall_ns()
    while True:
        message = client.receive(POLL_S)
        if message is not None and message.get("run") == run:
            if message.tag == "result":
                return message
            if out.isatty():
                print(f"\r\x1b[K{message.get('state')}: {message.get('text')}", end="\r", file=out, flush=True)
        elif message is not None and message.tag == "error":
            raise GatewayError(message.get("code", "internal"), message.text or "")
        if wall_ns() - renew_ns > RENEW_S * NS:
            renew_ns = wall_ns()
            client.send("lease", op="renew")


def _let_go(client: Client) -> None:
    """Release the lease, if it is still ours and anybody hears us."""
    try:
        client.lease("release")
    except GatewayError:
        return
