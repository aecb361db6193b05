"""The value of one attribute that stands in the file: a literal of a port, or a script."""

from __future__ import annotations

import re
from typing import Final

from pluto_bt.source.xml_reader import XmlAttribute
from pluto_bt.trees.loader.pointers import key_of
from pluto_bt.trees.loader.report import Report
from pluto_bt.trees.ports import PortModel, range_problem
from pluto_bt.trees.script import ScriptSyntaxError, parse_script
from pluto_bt.trees.values import SCRIPT, STATUS, STRING, trailing_text

ENTRY_IN_TEXT: Final = re.compile(r"\{(@?[A-Za-z_]\w*)\}")


def check_literal(attribute: XmlAttribute, port: PortModel, report: Report, *, builtin: bool) -> None:
    """A fault if the literal does not fit its port. What BehaviorTree.CPP reads with a shrug is a warning for its own nodes."""
    text = attribute.value
    if port.kind is SCRIPT:
        check_script(attribute, report)
        return
    if key_of(port.name, text) is not None and not port.kind.typed:
        return
    try:
        value = port.kind.parse(text)
    except ValueError as error:
        # the names of statuses are only looked at while ticking
        tell = report.late if port.kind is STATUS else report.error
        what = f'"{text}" does not fit port "{port.name}"'
        mend = _mend(text, new_words(str(error), port.form))
        tell(attribute.value_place, "bad-literal", what, expected=port.form, found=text or "nothing", mend=mend)
        return
    problem = range_problem(port, value)
    if problem:
        what = f'"{text}" is outside what port "{port.name}" allows'
        report.error(attribute.value_place, "out-of-range", what, expected=port.form, found=text, mend=problem)
    elif rest := trailing_text(port.kind, text):
        _tell_rest(attribute, port, value, rest, report, builtin=builtin)
    elif port.kind is STRING and (found := ENTRY_IN_TEXT.search(text)):
        what = f"{found[0]} stands inside a text: only a whole port value is an entry"
        mend = f"a Script can join texts: whole := '…' .. {found[1]}, then {port.name}=" + '"{whole}"'
        report.warning(attribute.place_at(found.start()), "braces-in-text", what, expected="{key} alone, or a text", found=text, mend=mend)


def check_script(attribute: XmlAttribute, report: Report) -> None:
    """The syntax of a script, with the place of the fault inside it."""
    try:
        parse_script(attribute.value)
    except ScriptSyntaxError as error:
        what = f"script of {attribute.name}: {error.message}"
        report.error(attribute.place_at(error.position), "script-syntax", what, expected=error.expected, found=error.found)


def _tell_rest(attribute: XmlAttribute, port: PortModel, value: object, rest: str, report: Report, *, builtin: bool) -> None:
    """What follows a number is dropped; of a quantity it may be a unit, and another one than the port's."""
    text, place, unit = attribute.value, attribute.value_place, port.unit
    mend = f"give the number alone, in {unit}" if unit else ""
    if unit and not builtin and rest.strip() != unit and not rest.strip().isdecimal():
        report.late(place, "wrong-unit", f'"{text}" would be read as {value} {unit}', expected=port.form, found=text, mend=mend)
    else:
        report.warning(place, "trailing-text", f'"{text}" is read as {value}', expected=port.form, found=text, mend=mend)


def new_words(problem: str, form: str) -> str:
    """What a reader says of a text, unless it only says once more which form it expects."""
    return "" if problem.startswith("expected ") and problem.removeprefix("expected ") in form else problem


def _mend(text: str, problem: str) -> str:
    bare = text.strip()
    if bare != text and bare:
        return "remove the blanks"
    return "; ".join(filter(None, (problem, f"{{{text}}} would read an entry" if text.isidentifier() else "")))
