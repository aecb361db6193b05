"""TOML and YAML with places: what is read, where its keys stand, how faults are told."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.source import Fault, Faults
from pluto_bt.source.toml_reader import read_toml
from pluto_bt.source.yaml_reader import read_yaml

TOML = """\
# a platform
name = "pluto"
"long name".x = 'y'

[body]
outline_m = [[0.6, 0.4],  # front left
             [0.6, -0.4], [-0.6, 0]]
text = \"\"\"
[not.a.table]
a = 1\"\"\"

[devices.sonar]
rate_hz = 10.0
inline = { a = 1, b = { c = "]}" } }

[[module]]
name = "a"
[[module]]
name = "b"
[module.limits]
top = 1979-05-27 07:32:00
"""

TOML_PLACES = [
    (("name",), 2, 1),
    (("long name", "x"), 3, 13),
    (("body",), 5, 2),
    (("body", "outline_m"), 6, 1),
    (("body", "outline_m", "1"), 7, 14),
    (("body", "outline_m", "1", "1"), 7, 20),
    (("body", "outline_m", "2", "0"), 7, 28),
    (("devices",), 12, 2),
    (("devices", "sonar"), 12, 10),
    (("devices", "sonar", "rate_hz"), 13, 1),
    (("devices", "sonar", "inline", "b", "c"), 14, 25),
    (("module", "0", "name"), 17, 1),
    (("module", "1", "name"), 19, 1),
    (("module", "1", "limits", "top"), 21, 1),
    (("module", "1", "absent", "deeper"), 18, 3),
]


@pytest.mark.parametrize(("path", "line", "column"), TOML_PLACES)
def test_toml_keys_have_places(path: tuple[str, ...], line: int, column: int) -> None:
    faults = Faults()
    tables, place = read_toml(TOML, "p.toml", faults)
    assert not faults and tables == tomllib.loads(TOML)
    assert (place(path).line, place(path).column, place(path).file) == (line, column, "p.toml")


def test_toml_values_have_places_too_and_an_unknown_key_has_only_the_file() -> None:
    _, places = read_toml("a =  1\r\n[b]\r\nc=2", "p.toml", Faults())
    assert (places.value(("a",)).column, places.value(("b", "c")).line, places.value(("b", "c")).column) == (6, 3, 3)
    assert (places(("x",)).file, places(("x",)).line) == ("p.toml", 0)


def toml_faults(text: str) -> tuple[Fault, ...]:
    faults = Faults()
    tables, _ = read_toml(text, "p.toml", faults)
    assert tables == {}
    return faults.in_order()


@pytest.mark.parametrize(
    ("text", "line", "column", "code", "message"),
    [
        ("a = 1\nb 2", 2, 3, "toml-syntax", "expected '=' after a key in a key/value pair"),
        ("a = 1\nb = nonsense", 2, 5, "toml-syntax", "invalid value"),
        ("a = [1\n", 2, 1, "toml-syntax", "unclosed array"),
        ("a = 1\nb = 2\na = 3", 3, 1, "duplicate-key", "this key or table stands twice"),
        ("[t]\na=1\n[u]\n[t]\n", 4, 2, "duplicate-key", "this key or table stands twice"),
        ("a = " + "[" * 100, 1, 37, "too-deep", "this is nested too deeply"),
        ("x = 1\n" + "a." * 100 + "b = 1", 2, 1, "too-deep", "this is nested too deeply"),
        ("a = 2001-02-30", 1, 5, "toml-syntax", "invalid date or datetime"),
        ("a = '\x01'", 1, 6, "toml-syntax", "found invalid character '\\x01'"),
    ],
)
def test_toml_faults(text: str, line: int, column: int, code: str, message: str) -> None:
    (fault,) = toml_faults(text)
    assert (fault.line, fault.column, fault.code, fault.message) == (line, column, code, message)
    assert fault.expected and fault.found


def test_toml_sizes(tmp_path: Path) -> None:
    assert [fault.code for fault in toml_faults("#" * (1 << 20))] == ["too-large"]
    assert len(toml_faults("a = " + "9" * 5000)) == 1
    faults = Faults()
    assert read_toml(tmp_path / "none.toml", "none.toml", faults)[0] == {}
    assert [fault.code for fault in faults.in_order()] == ["no-file"]


@settings(deadline=None)
@given(st.text(alphabet="ab.=[]{}\"',#\n 1\\-", max_size=40))
def test_any_toml_is_read_as_tomllib_reads_it_or_is_a_fault(text: str) -> None:
    faults = Faults()
    tables, _ = read_toml(text, "", faults)
    try:
        assert tables == tomllib.loads(text) and not faults
    except tomllib.TOMLDecodeError:
        assert faults.has_errors


KEYS = st.text(alphabet="abc-_1", min_size=1, max_size=3)
VALUES = st.recursive(st.integers(0, 9), lambda below: st.lists(below, max_size=3) | st.dictionaries(KEYS, below, max_size=3), max_leaves=6)


@settings(deadline=None)
@given(st.dictionaries(KEYS, VALUES, max_size=4))
def test_every_toml_key_is_found_where_it_stands(tables: dict[str, object]) -> None:
    def written(value: object) -> str:
        if isinstance(value, dict):
            return "{ " + ", ".join(f'"{key}" = {written(below)}' for key, below in value.items()) + " }"
        return "[" + ",\n ".join(map(written, value)) + "]" if isinstance(value, list) else str(value)

    faults = Faults()
    read, places = read_toml("\n".join(f'"{key}" = {written(value)}' for key, value in tables.items()), "", faults)
    assert read == tables and not faults
    todo: list[tuple[tuple[str, ...], object]] = [((key,), value) for key, value in tables.items()]
    while todo:
        path, value = todo.pop()
        assert path in places
        rest = places.value(path).text[places.value(path).column - 1 :]
        if isinstance(value, dict):
            assert rest.startswith("{")
            todo += [((*path, key), below) for key, below in value.items()]
        elif isinstance(value, list):
            assert rest.startswith("[")
            todo += [((*path, str(i)), below) for i, below in enumerate(value)]
        else:
            assert rest.startswith(str(value))


# --- YAML ---

YAML = """\
image: map.pgm
resolution: 0.05
origin: [-10.0, -10.0, 0.0]  # x y yaw
mode: "trinary"
deep:
  - a: 1
"""


def test_yaml_is_read_with_places() -> None:
    faults = Faults()
    values, place = read_yaml(YAML, "m.yaml", faults)
    assert not faults
    assert values == {"image": "map.pgm", "resolution": 0.05, "origin": [-10.0, -10.0, 0.0], "mode": "trinary", "deep": [{"a": 1}]}
    assert [(place(path).line, place(path).column) for path in (("resolution",), ("origin", "1"), ("deep", "0", "a"))] == [(2, 1), (3, 17), (6, 5)]
    assert (place.value(("resolution",)).line, place.value(("resolution",)).column) == (2, 13)


@pytest.mark.parametrize(
    ("text", "line", "column", "message"),
    [
        ("", 1, 1, "the file is not a mapping"),
        ("- 1\n- 2", 1, 1, "the file is not a mapping"),
        ("a: 1\nb: [1, 2", 2, 9, "the file is not YAML: expected ',' or ']', but got '<stream end>'"),
        ("a: 1\n\tb: 2", 2, 1, "the file is not YAML: found character '\\t' that cannot start any token"),
        ("a: &x [1]\nb: *x", 2, 4, "aliases are refused"),
        ("a: 1\nb: 2\na: 3", 3, 1, 'key "a" stands twice'),
        ("a: " + "[" * 30, 1, 23, "this is nested too deeply"),
        ("a: \x01", 1, 4, "a character that YAML does not allow"),
        ("a: !!python/none x", 1, 4, "the file is not YAML: could not determine a constructor for the tag 'tag:yaml.org,2002:python/none'"),
        ("a: !!int word", 1, 4, "this value cannot be read: invalid literal for int() with base 10: 'word'"),
        ("a: 2001-99-99", 1, 4, "this value cannot be read: month must be in 1..12"),
        ("{a: 1}: 2", 1, 1, "a key must be a word"),
        ("a: 1\n---\nb: 2", 2, 1, "the file is not YAML: but found another document"),
    ],
)  # fmt: skip
def test_yaml_faults(text: str, line: int, column: int, message: str) -> None:
    faults = Faults()
    read_yaml(text, "m.yaml", faults)
    (fault,) = faults.in_order()
    assert (fault.file, fault.line, fault.column, fault.message) == ("m.yaml", line, column, message)
    assert fault.expected and fault.found


def test_yaml_sizes() -> None:
    faults = Faults()
    assert read_yaml("#" * (1 << 17), "m.yaml", faults)[0] == {}
    assert [fault.code for fault in faults.in_order()] == ["too-large"]


@settings(deadline=None)
@given(st.text(alphabet="ab:-[]{}&*!|>'\"#\n ,?1.\x00\x85", max_size=40))
def test_any_yaml_is_a_mapping_or_a_fault(text: str) -> None:
    faults = Faults()
    values, _ = read_yaml(text, "", faults)
    assert isinstance(values, dict)
    assert values or faults.has_errors or "{}" in "".join(text.split()), "else only {} is a mapping without a key"
