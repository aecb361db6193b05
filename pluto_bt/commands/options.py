"""Command-line options whose values may begin with a minus sign, as in `--start -1,2,90`."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from pluto_bt.source import Place, did_you_mean
from pluto_bt.source.faults import fail


class Parser(argparse.ArgumentParser):
    """argparse, but the word after an option that takes a value is that value, whatever it looks like; and mistakes are faults."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(allow_abbrev=False, **settings)  # "--wor" must not become another option in the next version

    def error(self, message: str) -> NoReturn:
        """Raises InputError, after the usage."""
        self.print_usage(sys.stderr)
        fail(Place(self.prog), "bad-usage", message, mend=self._nearest(message) or f"`{self.prog} --help` tells more")

    def _nearest(self, message: str) -> str:
        strange = re.search(r"unrecognized arguments: (--?[\w-]+)", message)
        return did_you_mean(strange[1], self._option_string_actions) if strange else ""

    def parse_args(self, args: Sequence[str], namespace: None = None) -> argparse.Namespace:  # type: ignore[override]  # argv is always given here
        """Parse; options may stand between files. Raises InputError for what cannot be understood."""
        parse = super().parse_args if "--" in args else super().parse_intermixed_args  # the latter does not know "--"
        return parse(self._joined(list(args)))

    def _joined(self, args: list[str]) -> list[str]:
        takes_value = {name for action in self._actions if action.option_strings and action.nargs is None for name in action.option_strings}
        joined: list[str] = []
        words = iter(args)
        for word in words:
            if word == "--":
                return [*joined, word, *words]
            value = next(words, None) if word in takes_value and word.startswith("--") else None
            joined.append(word if value is None else f"{word}={value}")
        return joined
