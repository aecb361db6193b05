"""Why the robot is, or is not, moving, as far as the topics tell: from the mission down to the motors, first cause first."""

from __future__ import annotations

from collections.abc import Iterator

from pluto_bt.gateway.client import Client, Element, GatewayError

LINKS = ("motion/status", "avoidance/status", "drive/status", "filter/status")
WATCHED = ("Localization/Pose", "sick/scan", "ATRV2/Drive/Raw")
_NORMAL = frozenset({"normal", "none", "at-rest", "at-rest-with-rectangle", "following-path", "running", "set"})
STILL_MPS, STILL_RADPS = 0.005, 0.005


def why_lines(client: Client) -> list[str]:
    """The verdict, then one line a cause."""
    limits = {item.get("name", ""): float(item.get("stale_after_s", "0")) for item in client.request("describe").iter("item")}
    speed_mps, turn_rate_radps = _velocity(_get(client, "ATRV2/Drive/Raw"))
    moving = abs(speed_mps) > STILL_MPS or abs(turn_rate_radps) > STILL_RADPS
    causes = [*_mission(client), *_links(client), *_stale(client, limits)]
    verdict = f"moving: {speed_mps:.2f} m/s, {turn_rate_radps:.2f} rad/s" if moving else "not moving"
    if not causes and not moving:
        causes = ["nothing hinders the robot, and nobody tells it to move"]
    return [verdict, *(f"  {cause}" for cause in causes)]


def _mission(client: Client) -> Iterator[str]:
    state = client.request("mission", op="state")
    if state.get("state") not in ("running", "idle"):
        yield ": ".join(word for word in (f"mission {state.get('name')}", state.get("state"), state.get("reason"), state.get("step")) if word)
    elif state.get("step"):
        yield f"mission {state.get('name')}: running {state.get('step')}"


def _links(client: Client) -> Iterator[str]:
    for topic in LINKS:
        value = _get(client, topic)
        if value is None:
            continue
        names = [status.get("name", "") for status in value.iter("status") if status.get("name") not in _NORMAL]
        said = [word for word in (value.findtext("reason"), value.findtext("text")) if word]
        if names or said:
            yield f"{topic.split('/')[0]}: {', '.join(names + said)} (age {value.get('age')} s)"


def _stale(client: Client, limits: dict[str, float]) -> Iterator[str]:
    for topic in (*LINKS, *WATCHED):
        limit_s = limits.get(topic, 0.0)
        value = _get(client, topic) if limit_s else None
        if value is not None and float(value.get("age", "0")) > limit_s:
            yield f"{topic}: too old, {value.get('age')} s (limit {limit_s:g} s)"


def _velocity(value: Element | None) -> tuple[float, float]:
    words = (value.findtext("velocity") or "0 0").split() if value is not None else ["0", "0"]
    return float(words[0]), float(words[1])


def _get(client: Client, topic: str) -> Element | None:
    """The newest value; None if this robot has none."""
    try:
        return client.request("get", topic=topic)
    except GatewayError as error:
        if error.code in ("no-value", "unknown-topic"):
            return None
        raise
