"""What a command takes: each argument knows how it is said, how it is read, and what to offer for it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

from pluto_bt.gateway.shell.codes import UsageError
from pluto_bt.source import did_you_mean

REQUIRED: Final[Any] = object()


@dataclass(frozen=True, slots=True)
class Argument:
    """One argument of a command.

    Attributes:
        read: its value from the word that was typed. Raises: ValueError.
        expected: what a person should type, in words.
        default: REQUIRED, or the value where the word is missing.
        is_rest: it takes all words that are left, as a tuple.
        words: what may be offered: the words themselves, or the name of a list that the robot knows (`topic`, `module`, …).
    """

    name: str
    read: Callable[[str], Any]
    expected: str
    default: Any = REQUIRED
    is_rest: bool = False
    words: tuple[str, ...] | str = ()

    @property
    def shown(self) -> str:
        """As usage lines show it."""
        name = "|".join(self.words) if isinstance(self.words, tuple) and self.words and not self.is_rest else self.name
        name = f"{name} …" if self.is_rest else name
        return name if self.default is REQUIRED else f"[{name}]"

    def value(self, word: str) -> Any:
        """The word's value. Raises: UsageError."""
        try:
            return self.read(word)
        except ValueError:
            hint = did_you_mean(word, self.words) if isinstance(self.words, tuple) and self.words else ""
            raise UsageError(f'{self.name}: expected {self.expected}, found "{word}"{"; " + hint if hint else ""}') from None


def number(name: str, unit: str = "", default: Any = REQUIRED, low: float = -math.inf, high: float = math.inf) -> Argument:
    """A finite number within bounds."""
    bounds = [f"at least {low:g}"] * (low > -math.inf) + [f"at most {high:g}"] * (high < math.inf)

    def read(word: str) -> float:
        value = float(word)
        if not (math.isfinite(value) and low <= value <= high) or "_" in word:
            raise ValueError(word)
        return value

    return Argument(name, read, ", ".join([f"a number in {unit}" if unit else "a number", *bounds]), default)


def whole(name: str, default: Any = REQUIRED, low: int = -(2**31), high: int = 2**31 - 1) -> Argument:
    """A whole number within bounds."""

    def read(word: str) -> int:
        value = int(word)
        if not low <= value <= high or "_" in word:
            raise ValueError(word)
        return value

    return Argument(name, read, f"a whole number from {low} to {high}", default)


def choice(name: str, words: Sequence[str], default: Any = REQUIRED) -> Argument:
    """One of a few words."""

    def read(word: str) -> str:
        if word not in words:
            raise ValueError(word)
        return word

    return Argument(name, read, "one of " + ", ".join(words), default, words=tuple(words))


def word(name: str, expected: str, offered: str = "", default: Any = REQUIRED) -> Argument:
    """Any word; `offered` names the robot's list that completes it."""
    return Argument(name, str, expected, default, words=offered)


def rest(name: str, expected: str, offered: str = "") -> Argument:
    """All further words; there may be none."""
    return Argument(name, str, expected, (), is_rest=True, words=offered)


def read_all(arguments: Sequence[Argument], words: Sequence[str]) -> list[Any]:
    """The values of all arguments, in order. Raises: UsageError."""
    values: list[Any] = []
    left = list(words)
    for argument in arguments:
        if argument.is_rest:
            values.append(tuple(argument.value(word) for word in left))
            left = []
        elif left:
            values.append(argument.value(left.pop(0)))
        elif argument.default is REQUIRED:
            raise UsageError(f"expected {' '.join(a.shown for a in arguments)}, found {' '.join(words) or 'nothing'}")
        else:
            values.append(argument.default)
    if left:
        wanted = " ".join(argument.shown for argument in arguments) or "nothing"
        raise UsageError(f"expected {wanted}, found {' '.join(words)}")
    return values
