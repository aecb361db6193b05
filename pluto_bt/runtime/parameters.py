"""Typed parameters from one declaration: a tree of msgspec Structs gives names, types, ranges, defaults and descriptions.

The unit of a parameter is the ending of its name. Values come from TOML tables and from `--set a.b=VALUE`; every fault is told at
once, each at its key. (Constructors of Structs do not check ranges; `convert` does, so everything goes through it.)
"""

from __future__ import annotations

import json
import math
import types
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin

import msgspec

from pluto_bt.source import Faults, Place, did_you_mean

T = TypeVar("T", bound=msgspec.Struct)
Locate = Callable[[tuple[str, ...]], Place]

UNITS = {
    "m": "m", "s": "s", "rad": "rad", "deg": "°", "mps": "m/s", "mps2": "m/s²", "radps": "rad/s", "radps2": "rad/s²", "dps": "°/s", "dps2": "°/s²",
    "hz": "Hz", "v": "V", "a": "A", "ms": "ms", "percent": "%", "hours": "h",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Parameter:
    """One row of a description of parameters."""

    name: str
    unit: str
    kind: str
    range: str
    default: str
    doc: str


def unit_of(name: str) -> str:
    """The unit that the ending of a name says, or "". That of `drift_dps_per_sqrt_s` is °/s/√s."""
    above, per, below = name.partition("_per_")
    if per:
        root = "√" if below.startswith("sqrt_") else ""
        below = below.removeprefix("sqrt_")
        return f"{unit_of(above) or above.rsplit('_', 1)[-1]}/{root}{UNITS.get(below, below)}"
    return UNITS.get(name.rsplit("_", 1)[-1], "")


def build(kind: type[T], table: Mapping[str, Any], locate: Locate, faults: Faults, path: tuple[str, ...] = ()) -> T | None:
    """A `kind` from a table of plain values; None if there was a fault (all of them are in `faults`, at their keys)."""
    fields = {field.encode_name: field for field in msgspec.structs.fields(kind)}
    values: dict[str, Any] = {}
    complete = True
    for key, raw in table.items():
        here = (*path, key)
        if key not in fields:
            faults.error(locate(here), "unknown-parameter", f'unknown parameter "{".".join(here)}"', expected=f"one of: {', '.join(fields)}",
                         found=key, mend=did_you_mean(key, fields))  # fmt: skip
            complete = False
            continue
        value = _value(fields[key].type, raw, locate, faults, here)
        complete = complete and value is not _FAULTY
        values[fields[key].name] = value
    for name, field in fields.items():
        if name not in table and field.required:
            where = locate(path) if path else locate(())
            missing = ".".join((*path, name))
            faults.error(where, "missing-parameter", f'missing parameter "{missing}"', expected=_kind_text(field.type), mend=f"add {name} = …")
            complete = False
    return kind(**values) if complete else None


_FAULTY: Any = object()


def _value(declared: Any, raw: Any, locate: Locate, faults: Faults, path: tuple[str, ...]) -> Any:
    """`raw` as the declared type: structs by `build`, the rest by msgspec, with the fault at the key."""
    struct = _struct_in(declared)
    if struct is not None and isinstance(raw, Mapping):
        built = build(struct, raw, locate, faults, path)
        return _FAULTY if built is None else built
    try:
        value = msgspec.convert(raw, declared, strict=True)
        if _is_finite(value):
            return value
        faults.error(locate(path), "bad-value", f"{'.'.join(path)}: not a finite number", expected=_kind_text(declared), found=shown(raw))
        return _FAULTY
    except msgspec.ValidationError as error:
        message = str(error).replace("`", "").partition(" - at ")[0]
        what = f"{'.'.join(path)}: {message[0].lower()}{message[1:]}"
        faults.error(locate(path), "bad-value", what, expected=_kind_text(declared), found=shown(raw))
        return _FAULTY


def _is_finite(value: Any) -> bool:
    """No parameter may be endless or undefined: a robot with a top speed of infinity is none."""
    if isinstance(value, (list, tuple)):
        return all(map(_is_finite, value))
    return not isinstance(value, float) or math.isfinite(value)


def shown(raw: Any) -> str:
    """A value as a settings file or `--set` would hold it; long lists are cut."""
    text = json.dumps(raw, default=str)
    return text if len(text) <= 80 else text[:77] + "..."


def _struct_in(declared: Any) -> type[msgspec.Struct] | None:
    """The Struct class inside `Struct`, `Struct | None` or `Annotated[Struct, …]`, if there is one."""
    if get_origin(declared) is Annotated:
        return _struct_in(get_args(declared)[0])
    if get_origin(declared) in (Union, types.UnionType):
        return next((struct for struct in map(_struct_in, get_args(declared)) if struct is not None), None)
    return declared if isinstance(declared, type) and issubclass(declared, msgspec.Struct) else None


def override(table: dict[str, Any], settings: Sequence[str], kind: type[msgspec.Struct], faults: Faults) -> dict[tuple[str, ...], Place]:
    """Write `--set a.b=VALUE` settings into a table, in place. VALUE is read as JSON if it is that, else as text.

    Returns: which parameters were set, each with its option as the place of a fault.
    """
    known = [row.name for row in describe(kind)] if settings else []
    set_at: dict[tuple[str, ...], Place] = {}
    for setting in settings:
        place = Place(f"--set {setting}")
        name, equals, text = setting.partition("=")
        if not equals or not name:
            faults.error(place, "bad-setting", "a setting has the form PARAM=VALUE", expected="for example drive.max_speed_mps=0.4", found=setting)
        elif name not in known:
            inside = [row for row in known if row.startswith(f"{name}.")]
            expected = f"one of: {', '.join(inside[:20])}" if inside else "the name of a parameter of the platform file"
            what, mend = (f'"{name}" is a table' if inside else f'unknown parameter "{name}"'), did_you_mean(name, known)
            faults.error(place, "unknown-parameter", what, expected=expected, found=name, mend=mend)
        else:
            path = tuple(name.split("."))
            _put(table, path, _read(text))
            set_at[path] = place
    return set_at


def _put(table: dict[str, Any], path: tuple[str, ...], value: Any) -> None:
    for parent in path[:-1]:
        inner = table.setdefault(parent, {})
        if not isinstance(inner, dict):
            return  # the file has no table there, which is told when it is built
        table = inner
    table[path[-1]] = value


def _read(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):  # no JSON, or some thousand brackets
        return float(text) if text.strip().lower().lstrip("+-") in ("nan", "inf", "infinity") else text  # numbers, though none that will do


def describe(kind: type[msgspec.Struct], prefix: str = "") -> tuple[Parameter, ...]:
    """Every parameter below `kind`, depth first, dotted."""
    rows: list[Parameter] = []
    for field in msgspec.structs.fields(kind):
        name = f"{prefix}{field.encode_name}"
        struct = _struct_in(field.type)
        if struct is not None:
            rows += describe(struct, name + ".")
            continue
        default = "" if field.required else shown(field.default) if field.default is not msgspec.NODEFAULT else "…"
        rows.append(Parameter(name, unit_of(field.encode_name), _kind_text(field.type), _range_text(field.type), default, _doc(field.type)))
    return tuple(rows)


def _metas(declared: Any) -> list[msgspec.Meta]:
    """All Meta annotations of a type, outermost first."""
    if get_origin(declared) is not Annotated:
        return []
    inner, *extras = get_args(declared)
    return [extra for extra in reversed(extras) if isinstance(extra, msgspec.Meta)] + _metas(inner)


def _doc(declared: Any) -> str:
    return next((meta.description for meta in _metas(declared) if meta.description), "")


def _range_text(declared: Any) -> str:
    words = []
    for meta in _metas(declared):
        words += [f"{sign} {bound:g}" for sign, bound in ((">", meta.gt), (">=", meta.ge), ("<", meta.lt), ("<=", meta.le)) if bound is not None]
    return ", ".join(words)


def _kind_text(declared: Any) -> str:
    """The type as a person would say it, with its range."""
    if get_origin(declared) is Annotated:
        limits = _range_text(declared)
        return _kind_text(get_args(declared)[0]) + (f" {limits}" if limits else "")
    names = {float: "a number", int: "a whole number", bool: "true or false", str: "text"}
    if declared in names:
        return names[declared]
    if str(declared).startswith("typing.Literal"):
        return "one of: " + ", ".join(map(str, get_args(declared)))
    if _struct_in(declared) is not None:
        return "a table"
    if get_origin(declared) is tuple and get_args(declared)[-1] is Ellipsis:
        item = get_args(declared)[0]
        struct = _struct_in(item)
        return "a list of " + (f"tables ({', '.join(field.encode_name for field in msgspec.structs.fields(struct))})" if struct else _kind_text(item))
    if get_origin(declared) is tuple and set(get_args(declared)) == {float}:
        return f"[{', '.join(['number'] * len(get_args(declared)))}]"
    return str(declared).replace("typing.", "")
