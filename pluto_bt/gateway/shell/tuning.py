"""`params`: look at parameters and change them."""

from __future__ import annotations

from pluto_bt.gateway.client import Element
from pluto_bt.gateway.shell.codes import DONE, FailedError, UsageError
from pluto_bt.gateway.shell.face import Face
from pluto_bt.gateway.shell.robot import Robot
from pluto_bt.gateway.xml_text import element, escape


async def params(robot: Robot, face: Face, words: tuple[str, ...]) -> int:
    """`params [NAME|BEGINNING*]` shows, `params NAME=VALUE …` sets all or none, `params rollback` and `params save` do what they say."""
    if words in (("rollback",), ("save",)):
        reply = await robot.request("params", op=words[0])
    elif words and all("=" in word for word in words):
        body = "".join(element("p", {"name": name}, escape(value)) for name, _, value in (word.partition("=") for word in words))
        reply = await robot.request("params", body, op="set")
    elif len(words) <= 1 and not any("=" in word for word in words):
        reply = await robot.request("params", **({"name": words[0]} if words else {}))
    else:
        raise UsageError(f"expected one name, or settings as NAME=VALUE, found {' '.join(words)}")
    rows = [_row(row) for row in reply.iter("p")]
    if words and not rows and not any("=" in word for word in words) and words[0] not in ("rollback", "save"):
        raise FailedError(f'no parameter "{words[0]}"; `params` lists them')
    face.say("\n".join([*rows, f"revision {reply.get('rev')}"]))
    return DONE


def _row(row: Element) -> str:
    default = f"default {row.get('default')}" if row.get("default") else ""
    more = ", ".join(filter(None, (row.get("range"), default, "" if row.get("live") == "true" else "at start only")))
    unit = f" {row.get('unit')}" if row.get("unit") else ""
    return f"{row.get('name', ''):<40} {row.text or ''}{unit}   ({more})"
