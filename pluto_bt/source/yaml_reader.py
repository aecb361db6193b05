"""YAML with places, for ROS map files: mappings, lists and plain values; no aliases (their expansion is a known bomb), no tags of Python."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pluto_bt.source.faults import Faults, Place
from pluto_bt.source.key_places import KeyPath, KeyPlaces
from pluto_bt.source.text import SourceText, read_text

MAX_YAML_BYTES = 1 << 15  # map files have ten lines; PyYAML reads about 0.2 MiB a second
MAX_DEPTH = 20


def read_yaml(path_or_text: Path | str, file: str, faults: Faults, *, max_bytes: int = MAX_YAML_BYTES) -> tuple[dict[str, Any], KeyPlaces]:
    """The mapping of a YAML file (a `Path`) or text (a `str`), and where its keys stand; empty and faults if it is none.

    Args:
        file: the name to show in faults.
    """
    text = path_or_text if isinstance(path_or_text, str) else read_text(path_or_text, file, faults, max_bytes=max_bytes)
    if text is not None and len(text) > max_bytes:
        faults.error(Place(file), "too-large", "the text is too large", expected=f"at most {max_bytes} characters", found=str(len(text)))
        text = None
    source = SourceText((text or "").removeprefix("\ufeff"), file)
    reading = _Reading(source, faults)
    return ({} if text is None else reading.mapping()), reading.places


class _Reading:
    """One reading of a YAML text."""

    def __init__(self, source: SourceText, faults: Faults) -> None:
        self._source, self._faults = source, faults
        self.places = KeyPlaces(source)

    def mapping(self) -> dict[str, Any]:
        """The document as a dict; empty if it is not one."""
        import yaml

        loader: Any = None
        try:
            if self._refused(yaml):
                return {}
            loader = yaml.SafeLoader(self._source.text)
            node = loader.get_single_node()
            if isinstance(node, yaml.MappingNode):
                return dict(self._pairs(node, (), loader, yaml))
            found = "nothing" if node is None else f"a {node.id}"
            self._faults.error(self._source.place(0), "yaml-type", "the file is not a mapping", expected="lines of the form key: value", found=found)
        except yaml.MarkedYAMLError as error:
            self._syntax_fault(error.problem_mark or error.context_mark, error.problem or "not YAML")
        except yaml.YAMLError as error:  # ReaderError: a character that YAML forbids
            position = min(getattr(error, "position", 0) or 0, len(self._source.text))
            self._fault(position, "a character that YAML does not allow", found=repr(self._source.text[position : position + 1]))
        finally:
            if loader is not None:
                loader.dispose()
        return {}

    def _refused(self, yaml: Any) -> bool:
        """Aliases and deep nesting are refused before anything is built from them."""
        depth = 0
        for event in yaml.parse(self._source.text, Loader=yaml.SafeLoader):
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if isinstance(event, yaml.AliasEvent):
                self._fault(event.start_mark.index, "aliases are refused", found=f"*{event.anchor}", mend="write the value out")
                return True
            if depth > MAX_DEPTH:
                self._fault(event.start_mark.index, "this is nested too deeply", found="more", expected=f"at most {MAX_DEPTH} levels")
                return True
        return False

    def _converted(self, node: Any, path: KeyPath, loader: Any, yaml: Any) -> Any:
        if isinstance(node, yaml.MappingNode):
            return dict(self._pairs(node, path, loader, yaml))
        if isinstance(node, yaml.SequenceNode):
            values = []
            for i, item in enumerate(node.value):
                self.places.note((*path, str(i)), item.start_mark.index, item.start_mark.index)
                values.append(self._converted(item, (*path, str(i)), loader, yaml))
            return values
        try:
            return loader.construct_object(node)
        except (ValueError, OverflowError) as error:  # !!int of a word, a date that is none
            self._fault(node.start_mark.index, f"this value cannot be read: {error}", found=str(node.value))
            return None

    def _pairs(self, node: Any, path: KeyPath, loader: Any, yaml: Any) -> Iterator[tuple[str, Any]]:
        for key_node, value_node in node.value:
            at = key_node.start_mark.index
            if not isinstance(key_node, yaml.ScalarNode):
                self._fault(at, "a key must be a word", found=f"a {key_node.id}")
                continue
            below = (*path, key_node.value)
            if below in self.places:
                first = self.places(below)
                self._fault(at, f'key "{key_node.value}" stands twice', expected="each key once", found=f"the first is in line {first.line}")
                continue
            self.places.note(below, at, value_node.start_mark.index)
            yield key_node.value, self._converted(value_node, below, loader, yaml)

    def _syntax_fault(self, mark: Any, problem: str) -> None:
        at = len(self._source.text) if mark is None else min(mark.index, len(self._source.text))
        self._fault(at, f"the file is not YAML: {problem}", found=self._source.text[at : at + 40].split("\n")[0].strip() or "the end of the line")

    def _fault(self, at: int, message: str, *, expected: str = "", found: str = "", mend: str = "") -> None:
        self._faults.error(self._source.place(at), "yaml-syntax", message, expected=expected or "YAML: key: value", found=found, mend=mend)
