"""The values of options, read from what was typed; each that does not fit is a fault at its option."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pluto_bt.maps.numbers import MAX_METRES, NUMBER
from pluto_bt.source import Faults, Place

Pose = tuple[float, float, float]
MAX_SEED = 2**63 - 1
MAX_SECONDS = 1e9


def read_start(text: str | None, faults: Faults) -> Pose | None:
    """`--start X,Y,DEG` as x m, y m, theta rad; None if it is not given or no pose."""
    if text is None:
        return None
    words = text.split(",")
    numbers = [number for word in words if (number := _number(word)) is not None and abs(number) <= MAX_METRES]
    if len(words) != 3 or len(numbers) != 3:
        expected = f"X,Y,DEG, for example 0.5,12,90; none beyond {MAX_METRES:g}"
        faults.error(Place(f"--start {text}"), "bad-value", "a start pose is three numbers", expected=expected, found=text or "nothing")
        return None
    return (numbers[0], numbers[1], math.remainder(math.radians(numbers[2]), math.tau))


def read_seed(text: str | None, faults: Faults) -> int | None:
    """`--seed N`."""
    if text is None:
        return None
    if text.isascii() and text.isdigit() and len(text) <= 20 and int(text) <= MAX_SEED:
        return int(text)
    faults.error(Place(f"--seed {text}"), "bad-value", "a seed is a whole number", expected="0 to 2^63 - 1", found=text or "nothing")
    return None


def read_positive(text: str | None, option: str, faults: Faults) -> float | None:
    """A number above 0, for `--max-time` and `--speed`."""
    if text is None:
        return None
    number = _number(text)
    if number is not None and 0.0 < number <= MAX_SECONDS:
        return number
    what = f"{option} takes a number above 0"
    faults.error(Place(f"{option} {text}"), "bad-value", what, expected=f"a number above 0, at most {MAX_SECONDS:g}", found=text or "nothing")
    return None


def read_time(text: str | None, option: str, faults: Faults) -> float | None:
    """`--at T`: seconds of the run."""
    if text is None:
        return None
    time_s = _number(text)
    if time_s is not None and 0.0 <= time_s < MAX_SECONDS:
        return time_s
    what = f"{option} takes seconds of the run"
    faults.error(Place(f"{option} {text}"), "bad-value", what, expected=f"a number from 0 to below {MAX_SECONDS:g}", found=text or "nothing")
    return None


def read_ports(settings: Sequence[str], faults: Faults) -> dict[str, str]:
    """`--port NAME=VALUE` settings as a table."""
    ports: dict[str, str] = {}
    for setting in settings:
        name, equals, value = setting.partition("=")
        place = Place(f"--port {setting}")
        if not equals or not name:
            faults.error(place, "bad-port", "an input has the form NAME=VALUE", expected="NAME=VALUE", found=setting or "nothing")
        elif name in ports:
            faults.error(place, "bad-port", f'input "{name}" is given twice', expected="each input once", found=setting)
        else:
            ports[name] = value
    return ports


def _number(text: str) -> float | None:
    number = float(text) if NUMBER.fullmatch(text.strip()) else math.nan
    return number if math.isfinite(number) else None
