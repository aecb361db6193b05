"""What the two clients say and hear in common: the words of a command, the parts of a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element

from pluto_bt.gateway.xml_text import numbers


@dataclass(frozen=True, slots=True)
class RunResult:
    """How a run ended. `state` is succeeded, failed, cancelled, preempted or timeout; `outputs` are the output ports of the node."""

    state: str
    reason: str = ""
    text: str = ""
    outputs: dict[str, str] = field(default_factory=dict)

    @property
    def is_success(self) -> bool:
        """It did what it was to do."""
        return self.state == "succeeded"


OnProgress = Callable[[str, str], None]
"""(state, text) of a run, as it goes on."""


def no_progress(state: str, text: str) -> None:
    """Nobody wants to know."""


def result_of(message: Element) -> RunResult:
    """What a `<result>` says."""
    outputs = {out.get("name", ""): out.text or "" for out in message.findall("out")}
    return RunResult(message.get("state", ""), message.get("reason", ""), message.get("text", ""), outputs)


def tell_progress(told: Element, on_progress: OnProgress) -> None:
    """Pass on what a run says, if it is progress."""
    if told.tag == "progress":
        on_progress(told.get("state", ""), told.get("text", ""))


def command_body(position: Sequence[float], velocity: Sequence[float], acceleration: Sequence[float], force: Sequence[float]) -> str:
    """The children of `<command>`; what is empty is left out."""
    parts = (("position", position), ("velocity", velocity), ("acceleration", acceleration), ("force", force))
    return "".join(f"<{name}>{numbers([float(value) for value in values])}</{name}>" for name, values in parts if len(values))


def hello_of(name: str, session: str, token: str) -> dict[str, str]:
    """What `<hello>` says of us."""
    return {"name": name, "session": session, "token": token}


def said_by(source: str, text: str) -> str:
    """`source: text`; the text alone where it begins with its source ("anna stopped the robot")."""
    return text if source and text.startswith(f"{source} ") else f"{source}: {text}"
