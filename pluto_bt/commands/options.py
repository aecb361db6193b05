"""Command-line options whose values may begin with a minus sign, as in `--start -1,2,90`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence


class Parser(argparse.ArgumentParser):
    """argparse, but the word after an option that takes a value is that value, whatever it looks like."""

    def parse_args(self, args: Sequence[str], namespace: None = None) -> argparse.Namespace:  # type: ignore[override]  # argv is always given here
        """Parse; on a mistake print it with the usage and exit 2."""
        return super().parse_args(self._joined(list(args)))

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
