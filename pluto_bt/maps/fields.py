"""The attributes and points of one element of a world file, each checked when it is asked for; what nobody asked for is unknown."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from pluto_bt.maps.numbers import MAX_METRES, NUMBER
from pluto_bt.maps.world import Points
from pluto_bt.source import Faults, Place, XmlElement, did_you_mean

W = TypeVar("W", bound=str)
MAX_BAD_POINTS = 20  # told of one element
MAX_STRANGERS = 100
_WORD = re.compile(r"\S++")


class Fields:
    """One element. After the last attribute was asked for, `done()` reports the others."""

    def __init__(self, element: XmlElement, faults: Faults) -> None:
        self.element, self._faults = element, faults
        self._asked: dict[str, None] = {}

    @property
    def place(self) -> Place:
        """Where the element begins."""
        return self.element.place

    def fault(self, place: Place, code: str, message: str, *, expected: str = "", found: str = "", mend: str = "") -> None:
        """Note an error."""
        self._faults.error(place, code, message, expected=expected, found=found, mend=mend)

    def done(self, children: Sequence[str] = (), *, has_text: bool = False) -> None:
        """Report attributes that were not asked for, children that are not in `children`, and text that does not belong here."""
        tag, known = self.element.tag, list(self._asked)
        for name, attribute in self.element.attributes.items():
            if name not in self._asked:
                expected = f"one of: {', '.join(known)}" if known else "no attributes"
                what = f'unknown attribute "{name}" of <{tag}>'
                self.fault(attribute.place, "unknown-attribute", what, expected=expected, found=name, mend=did_you_mean(name, known))
        strangers = [child for child in self.element.children if child.tag not in children]
        for child in strangers[:MAX_STRANGERS]:
            expected = f"one of: {', '.join(children)}" if children else "no elements"
            what = f"unknown element <{child.tag}> in <{tag}>"
            self.fault(child.place, "unknown-element", what, expected=expected, found=f"<{child.tag}>", mend=did_you_mean(child.tag, children))
        if not has_text and self.element.text.strip():
            found = self.element.text.split(None, 1)[0]
            self.fault(self.element.text_place, "unexpected-text", f"<{tag}> has no text", expected="attributes only", found=found)

    def has(self, name: str) -> bool:
        """True if the attribute is given."""
        self._asked[name] = None
        return name in self.element.attributes

    def text(self, name: str, default: str | None = None) -> str:
        """A text that is not empty; a fault if it is missing and there is no default."""
        if not self.has(name):
            if default is None:
                what = f'<{self.element.tag}> needs the attribute "{name}"'
                self.fault(self.place, "missing-attribute", what, expected=f'{name}="…"', found="nothing", mend=self._similar(name))
            return default or ""
        value = self.element.get(name).strip()
        if not value:
            self._bad(name, f'attribute "{name}" is empty', f'{name}="…"')
        return value

    def number(self, name: str, default: float | None = None, low: float = -MAX_METRES, high: float = MAX_METRES, *, above: bool = False) -> float:
        """A finite number from `low` (above it, if `above`) to `high`; `low` after a fault."""
        if not self.has(name):
            return default if default is not None else float(self.text(name) or low)
        text = self.element.get(name).strip()
        value = float(text) if NUMBER.fullmatch(text) else math.nan
        if low <= value <= high and not (above and value == low):
            return value
        needed = "a number" if math.isnan(value) else f"greater than {low:g}" if above and value <= low else f"from {low:g} to {high:g}"
        expected = f"a number {'greater than' if above else 'from'} {low:g}{' up' if above else ''} to {high:g}"
        self._bad(name, f'attribute "{name}" must be {needed}', expected)
        return low

    def angle_rad(self, name: str, default_deg: float = 0.0, limit_deg: float = MAX_METRES) -> float:
        """Degrees in the file, radians here."""
        return math.radians(self.number(name, default_deg, -limit_deg, limit_deg))

    def whole(self, name: str, default: int | None, high: int) -> int:
        """A whole number from 0 to `high`; 0 after a fault."""
        if not self.has(name):
            if default is None:
                self.text(name)
            return default or 0
        text = self.element.get(name).strip()
        if text.isascii() and text.isdigit() and len(text) <= 20 and int(text) <= high:
            return int(text)
        self._bad(name, f'attribute "{name}" must be a whole number', f"a whole number from 0 to {high}")
        return 0

    def flag(self, name: str) -> bool:
        """`true` or `false`, which is also the default."""
        if not self.has(name):
            return False
        value = self.element.get(name).strip()
        if value not in ("true", "false", "1", "0"):
            self._bad(name, f'attribute "{name}" must be true or false', "true or false")
        return value in ("true", "1")

    def choice(self, name: str, words: tuple[W, ...]) -> W:
        """One of `words`; the first after a fault."""
        value = self.text(name)
        for word in words:
            if word == value:
                return word
        if value:
            self._bad(name, f'unknown {name} "{value}"', f"one of: {', '.join(words)}", did_you_mean(value, words))
        return words[0]

    def points(self, least: int) -> Points | None:
        """The points `x,y x,y …` that are the element's text; (n, 2) metres, read-only, or None and faults."""
        numbers: list[tuple[float, float]] = []
        bad = 0
        for word in _WORD.finditer(self.element.text):
            point = _point(word.group())
            if point is not None:
                numbers.append(point)
            else:
                bad += 1
                if bad > MAX_BAD_POINTS:
                    break
                mend = "no blank before or after the comma" if word.group().strip(",") != word.group() or "," not in word.group() else ""
                expected = f"x,y in metres, at most {MAX_METRES:g}"
                self.fault(self.element.place_at(word.start()), "bad-point", "this is no point", expected=expected, found=word.group(), mend=mend)
        if bad:
            return None
        if len(numbers) < least:
            what = f"<{self.element.tag}> needs at least {least} point{'s' if least > 1 else ''}"
            found = f"{len(numbers)} point{'s' if len(numbers) != 1 else ''}"
            self.fault(self.element.text_place, "too-few-points", what, expected="x,y x,y …", found=found)
            return None
        points = np.array(numbers, dtype=np.float64)
        points.setflags(write=False)
        return points

    def _bad(self, name: str, message: str, expected: str, mend: str = "") -> None:
        attribute = self.element.attributes[name]
        self.fault(attribute.value_place, "bad-value", message, expected=expected, found=attribute.value or "nothing", mend=mend)

    def _similar(self, name: str) -> str:
        """The attribute that was probably meant to be `name`."""
        near = next((given for given in self.element.attributes if given not in self._asked and did_you_mean(given, [name])), "")
        return f'is "{near}" meant to be "{name}"?' if near else f"add {name}"


def _point(word: str) -> tuple[float, float] | None:
    x, comma, y = word.partition(",")
    if not comma or not NUMBER.fullmatch(x) or not NUMBER.fullmatch(y):
        return None
    point = (float(x), float(y))
    return point if abs(point[0]) <= MAX_METRES and abs(point[1]) <= MAX_METRES else None
