"""Reads the contracts of a mission and of all it includes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, Final

from pluto_bt.maps.numbers import NUMBER
from pluto_bt.source import Faults, did_you_mean
from pluto_bt.source.xml_reader import XmlElement
from pluto_bt.trees.contracts import Contract
from pluto_bt.trees.loader.files import MissionFiles
from pluto_bt.trees.loader.literal_check import check_script
from pluto_bt.trees.loader.report import Report
from pluto_bt.trees.script import ScriptSyntaxError, parse_script
from pluto_bt.trees.script.terms import Assignment

ATTRIBUTES: Final = ("name", "always", "when", "within_s", "then")
THEN: Final = ("stop", "ask", "tell")


def contracts_in(path: Path, shown: str) -> list[Contract]:
    """The contracts of a file, which need not have a tree. Raises: InputError with every fault of them."""
    faults = Faults()
    files = MissionFiles(faults)
    files.read_file(path, shown)
    contracts = read_contracts(files.contracts, Report(faults))
    faults.raise_errors()
    return contracts


def read_contracts(elements: Sequence[XmlElement], report: Report) -> list[Contract]:
    """The contracts of a mission; the faulty ones are left out and told (`check` and `run` refuse them)."""
    return [contract for number, element in enumerate(elements, 1) if (contract := _read(element, number, report)) is not None]


def _read(element: XmlElement, number: int, report: Report) -> Contract | None:
    is_good = _check_names(element, report)
    for name in ("always", "when"):
        is_good = _check_look(element, name, report) and is_good
    within_s = _seconds(element.get("within_s", "0"))
    if within_s is None:
        place, found = element.attributes["within_s"].value_place, element.get("within_s")
        report.late(place, "bad-literal", "within_s takes seconds", expected="a number, 0 or more", found=found or "nothing")
    then = element.get("then", "stop")
    if then not in THEN:
        place, mend = element.attributes["then"].value_place, did_you_mean(then, THEN)
        report.late(place, "bad-literal", f'a contract cannot "{then}"', expected=", ".join(THEN), found=then or "nothing", mend=mend)
    if not is_good or within_s is None or then not in THEN:
        return None
    where = f"{element.place.file}:{element.place.line}" if element.place.file else ""
    return Contract(element.get("name") or f"contract {number}", element.get("always"), element.get("when"), within_s, then, where)


def _check_names(element: XmlElement, report: Report) -> bool:
    is_good = True
    for attribute in element.attributes.values():
        if attribute.name not in ATTRIBUTES:
            mend = did_you_mean(attribute.name, ATTRIBUTES)
            what = f'unknown attribute "{attribute.name}" of <Contract>'
            report.late(attribute.place, "unknown-attribute", what, expected=", ".join(ATTRIBUTES), found=attribute.name, mend=mend)
            is_good = False
    if not element.get("always"):
        report.late(element.place, "missing-port", "this <Contract> does not say what must hold", expected='always="a script"', found="nothing")
        is_good = False
    return is_good


def _check_look(element: XmlElement, name: str, report: Report) -> bool:
    """A script that parses and writes nothing."""
    attribute = element.attributes.get(name)
    if attribute is None or not attribute.value:
        return True
    try:
        program = parse_script(attribute.value)
    except ScriptSyntaxError:
        check_script(attribute, report)
        return False
    if any(isinstance(term, Assignment) for term in _terms(program.statements)):
        mend = "compare with =="
        report.late(attribute.value_place, "script-writes", "a contract only looks, it changes nothing", expected="a condition", mend=mend)
        return False
    return True


def _terms(value: Any) -> Iterator[Any]:
    """Every term of a script."""
    if isinstance(value, tuple):
        for item in value:
            yield from _terms(item)
    elif is_dataclass(value):
        yield value
        for one in fields(value):
            yield from _terms(getattr(value, one.name))


def _seconds(text: str) -> float | None:
    value = float(text) if NUMBER.fullmatch(text) else math.nan
    return value if 0.0 <= value < math.inf else None
