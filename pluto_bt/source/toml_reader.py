"""TOML with places: `tomllib` for the meaning, the key locator for line and column."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from pluto_bt.source.faults import Faults, Place
from pluto_bt.source.key_places import KeyPlaces
from pluto_bt.source.text import MIB, SourceText, read_text
from pluto_bt.source.toml_keys import MAX_PARTS, TomlKeys, TooDeepError

MAX_TOML_BYTES = MIB // 4  # parameters are written by people; tomllib reads about 2 MiB a second
_AT = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")


def read_toml(path_or_text: Path | str, file: str, faults: Faults, *, max_bytes: int = MAX_TOML_BYTES) -> tuple[dict[str, Any], KeyPlaces]:
    """The tables of a TOML file (a `Path`) or text (a `str`), and where their keys stand; empty and faults if it is not TOML.

    Args:
        file: the name to show in faults.
    """
    text = path_or_text if isinstance(path_or_text, str) else read_text(path_or_text, file, faults, max_bytes=max_bytes)
    if text is None:
        return {}, KeyPlaces(SourceText("", file))
    if len(text) > max_bytes:
        faults.error(Place(file), "too-large", "the text is too large", expected=f"at most {max_bytes} characters", found=str(len(text)))
        return {}, KeyPlaces(SourceText("", file))
    source = SourceText(text.removeprefix("\ufeff"), file)
    keys = TomlKeys(source)
    try:
        keys.scan()
        return tomllib.loads(source.text), keys.places
    except TooDeepError as error:
        expected = f"at most {MAX_PARTS} names in a key, and few arrays inside one another"
        faults.error(source.place(error.offset), "too-deep", "this is nested too deeply", expected=expected, found="more")
    except tomllib.TOMLDecodeError as error:
        _syntax_fault(str(error), source, keys, faults)
    except (ValueError, RecursionError, OverflowError) as error:  # a date that is none, a number of too many digits
        faults.error(Place(file), "toml-syntax", f"the file is not TOML: {error}", expected="TOML", found="a value that cannot be read")
    return {}, keys.places


def _syntax_fault(message: str, source: SourceText, keys: TomlKeys, faults: Faults) -> None:
    found = _AT.search(message)
    what = _AT.sub("", message)
    if keys.duplicate is not None and what.startswith("Cannot"):
        first, second = map(source.place, keys.duplicate)
        where = f"it already stands in line {first.line}, column {first.column}"
        faults.error(second, "duplicate-key", "this key or table stands twice", expected="each key once", found=where, mend="delete one")
        return
    place = source.at(int(found.group(1)), int(found.group(2))) if found and found.group(1) else source.place(len(source.text))
    rest = place.text[place.column - 1 :][:40].strip() or "the end of the line"
    faults.error(place, "toml-syntax", what[:1].lower() + what[1:], expected="TOML: key = value, [table] or [[table]]", found=rest)
