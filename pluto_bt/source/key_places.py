"""Where the keys of a TOML or YAML text stand."""

from __future__ import annotations

from pluto_bt.source.faults import Place
from pluto_bt.source.text import SourceText

KeyPath = tuple[str, ...]  # from the top; elements of arrays are their index as text: ("sonar", "transducers", "3", "x_m")


class KeyPlaces:
    """Call it with a path: the place of that key (of the element, in an array), or of the nearest key above that is known."""

    def __init__(self, source: SourceText) -> None:
        self._source = source
        self._keys: dict[KeyPath, int] = {}
        self._values: dict[KeyPath, int] = {}

    def note(self, path: KeyPath, key_offset: int, value_offset: int | None = None) -> None:
        """The key of `path` stands at `key_offset`, its value at `value_offset`; the first note of a path holds."""
        self._keys.setdefault(path, key_offset)
        if value_offset is not None:
            self._values.setdefault(path, value_offset)

    def __contains__(self, path: KeyPath) -> bool:
        return path in self._keys

    def __call__(self, path: KeyPath) -> Place:
        """The place of a key."""
        return self._nearest(path, self._keys)

    def first(self) -> Place:
        """The beginning of the text: where something that is missing is told."""
        return self._source.place(0)

    def value(self, path: KeyPath) -> Place:
        """The place of a value."""
        return self._nearest(path, self._values) if path in self._values else self(path)

    def _nearest(self, path: KeyPath, offsets: dict[KeyPath, int]) -> Place:
        while path and path not in offsets:
            path = path[:-1]
        return self._source.place(offsets[path]) if path else Place(self._source.file)
