"""Why the robot is, or is not, moving, asked of the executive: the chain of causes, and how it is told to a person."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pluto_bt.gateway.client import Element


def causes_of(reply: Element) -> tuple[bool, list[dict[str, Any]]]:
    """(does it move, the causes) as a `<why>` tells them."""
    causes = [
        {"layer": cause.get("layer", ""), "code": cause.get("code", ""), "text": cause.get("text", ""), "since_s": float(cause.get("since", "0")),
         "age_s": float(cause.get("age", "0")), "unblock": cause.get("unblock", "")}
        for cause in reply.iter("cause")
    ]  # fmt: skip
    return reply.get("moving") == "true", causes


def lines(is_moving: bool, causes: Sequence[dict[str, Any]]) -> list[str]:
    """The verdict, then the first cause with what would help, then the way up to the mission.

    A sentence that one link hands to the next is told once.
    """
    if not causes:
        return ["moving" if is_moving else "not moving", "  nothing hinders the robot" + ("" if is_moving else ", and nobody tells it to move")]
    told, said = ["moving" if is_moving else "not moving"], ""
    for number, cause in enumerate(causes):
        age = f", {cause['age_s']:.2f} s old" if cause["age_s"] else ""
        text = _news(cause["text"], said) or "the same"
        told.append(f"{'  because ' if number == 0 else '  '}{cause['layer']}: {cause['code']} since {cause['since_s']:.1f} s{age}: {text}")
        if number == 0 and cause["unblock"]:
            told.append(f"          what would help: {cause['unblock']}")
        said += f"{cause['text']}\n"
    return told


def _news(text: str, said: str) -> str:
    """What of a text was not said before."""
    return "; ".join(part for part in text.split("; ") if not _is_in(part, said))


def _is_in(part: str, said: str) -> bool:
    _, _, sentence = part.partition(": ")  # behind a word or a device that it was told of
    return part in said or bool(sentence and sentence in said)
