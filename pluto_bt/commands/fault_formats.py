"""Faults as people and programs read them: plain text, JSON, workflow commands of GitHub, SARIF 2.1.0."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote

from pluto_bt import __version__
from pluto_bt.source import Fault

SCHEMA: Final = "https://json.schemastore.org/sarif-2.1.0.json"


def as_text(faults: Sequence[Fault]) -> str:
    """The reports one under the other."""
    return "\n".join(fault.as_text() for fault in faults)


def as_json(faults: Sequence[Fault]) -> str:
    """One object on one line (DESIGN.md, section 4)."""
    return json.dumps({"faults": [fault.as_json() for fault in faults]}, ensure_ascii=False)


def as_github(faults: Sequence[Fault]) -> str:
    """One workflow command a fault: GitHub shows it beside the line in a pull request."""
    return "\n".join(_workflow_command(fault) for fault in faults)


def as_sarif(faults: Sequence[Fault]) -> str:
    """A log that code-scanning services read; columns count characters. What is at no place of a file is a word about the call, not a result."""
    codes = sorted({fault.code for fault in faults})
    rules = [{"id": code, "shortDescription": {"text": code.replace("-", " ")}} for code in codes]
    driver = {"name": "pluto check", "version": __version__, "rules": rules}
    results = [_sarif_result(fault, codes.index(fault.code)) for fault in faults if fault.line]
    notes = [_sarif_note(fault, codes.index(fault.code)) for fault in faults if not fault.line]
    call = {"executionSuccessful": not any(note["level"] == "error" for note in notes), "toolConfigurationNotifications": notes}
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "invocations": [call], "results": results}
    return json.dumps({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2, ensure_ascii=False)


FORMATS: Final[dict[str, Callable[[Sequence[Fault]], str]]] = {"text": as_text, "json": as_json, "github": as_github, "sarif": as_sarif}


def _sentences(fault: Fault) -> str:
    """The message and what belongs to it, one line each."""
    details = (("expected", fault.expected), ("found", fault.found), ("mend", fault.mend))
    return "\n".join([fault.message, *(f"{word}: {text}" for word, text in details if text)])


def _workflow_command(fault: Fault) -> str:
    properties = [("file", fault.file)] if fault.line else []  # an option of the command line is no file
    properties += [(name, str(number)) for name, number in (("line", fault.line), ("col", fault.column)) if number]
    properties.append(("title", fault.code))
    text = _sentences(fault) if fault.line else f"{fault.file}: {_sentences(fault)}"
    shown = ",".join(f"{name}={_escaped(value, ',:')}" for name, value in properties)
    return f"::{fault.severity} {shown}::{_escaped(text)}"


def _escaped(text: str, more: str = "") -> str:
    text = text.encode("utf-8", "backslashreplace").decode().replace("%", "%25")
    for sign in "\r\n" + more:
        text = text.replace(sign, f"%{ord(sign):02X}")
    return text


def _sarif_result(fault: Fault, rule: int) -> dict[str, Any]:
    region = {"startLine": fault.line} | ({"startColumn": fault.column} if fault.column else {})
    place = {"artifactLocation": {"uri": _uri(fault.file)}, "region": region}
    return {"ruleId": fault.code, "ruleIndex": rule, **_sarif_words(fault, _sentences(fault)), "locations": [{"physicalLocation": place}]}


def _sarif_note(fault: Fault, rule: int) -> dict[str, Any]:
    return {"associatedRule": {"id": fault.code, "index": rule}, **_sarif_words(fault, f"{fault.file}: {_sentences(fault)}")}


def _sarif_words(fault: Fault, text: str) -> dict[str, Any]:
    return {"level": fault.severity, "message": {"text": text.encode("utf-8", "backslashreplace").decode()}}


def _uri(file: str) -> str:
    """The file as seen from the working folder, which is the root of the checkout where services look; elsewhere, by its full path."""
    path = Path(file)
    if path.is_absolute() and path.is_relative_to(Path.cwd()):
        path = path.relative_to(Path.cwd())
    uri = quote(str(path.as_posix()).encode("utf-8", "surrogateescape"))
    return f"file://{uri}" if path.is_absolute() else uri
