"""Values and events, told to a person or to a program."""

from __future__ import annotations

import json
import math

from pluto_bt.gateway.client import Element

LONG_LIST = 12  # numbers shown of a longer list


def event_line(event: Element) -> str:
    """An event for a person, from an `<event>` or a `<value>` of the topic."""
    part = {child.tag: child.text or "" for child in event} if event.tag == "value" else {**event.attrib, "text": event.text or ""}
    time = event.get("stamp") or event.get("time") or "0"
    return f"{float(time):9.2f} s  {part.get('level', ''):<7} {part.get('source', '')}: {part.get('text', '')}"


def shown(value: Element) -> str:
    """A value for a person: a line a field, long lists cut; codes with their names."""
    lines = [f"{value.get('topic')}  at {value.get('stamp')} s, age {value.get('age')} s"]
    for part in value:
        words = _short((part.text or "").split(" "))
        text = " ".join(words) or " ".join(f"{key}={word}" for key, word in part.attrib.items())
        cut = f"{' '.join(words[:LONG_LIST])} … ({len(words)} in all)" if len(words) > LONG_LIST and part.tag != "text" else text
        lines.append(f"  {part.tag:<16} {cut}")
    return "\n".join(lines)


def as_json(value: Element) -> str:
    """A value as one line of JSON: numbers as numbers, lists as lists, rows as objects."""
    fields: dict[str, object] = {}
    for part in value:
        if part.attrib:
            rows = fields.setdefault(part.tag, [])
            assert isinstance(rows, list)
            rows.append(dict(part.attrib))
        else:
            numbers = [_number(word) for word in (part.text or "").split()]
            is_numeric = bool(numbers) and None not in numbers
            fields[part.tag] = (numbers[0] if len(numbers) == 1 else numbers) if is_numeric else part.text or ""
    head = {"topic": value.get("topic"), "seq": int(value.get("seq", "0")), "stamp_s": float(value.get("stamp", "0"))}
    return json.dumps({**head, **fields}, ensure_ascii=False)


def _short(words: list[str]) -> list[str]:
    """Numbers without the digits that no sensor has; a text as it is."""
    values = [_number(word) for word in words]
    return words if None in values else [f"{value:.7g}" if "." in word else word for value, word in zip(values, words, strict=True)]


def _number(word: str) -> float | None:
    try:
        number = float(word)
    except ValueError:
        return None
    return number if math.isfinite(number) else None
