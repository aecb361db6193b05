"""The blackboard of a mission: one scope for each SubTree instance, with links to its parent's.

A key is looked up in its own scope, then where the SubTree tag maps it, then (with `_autoremap`) under the same name in the parent;
`@key` always means the root scope. An entry takes its kind from the first typed port or the first typed write and keeps it.
Every assignment counts as a write, even of an equal value: `seq` counts them.
"""

from __future__ import annotations

from typing import Any, Final, Protocol

from pluto_bt.trees.values import STRING, Kind, PortProblem, kind_of_value


class Topics(Protocol):
    """The robot's topics, as read-only global entries: `@Localization/Pose`, and per number `@Localization_Pose_x`."""

    def get(self, name: str) -> Any:
        """The newest value; KeyError if nothing has been written."""

    def names(self) -> Any:
        """All names that can be read."""


class _Empty:
    """The value of an entry that exists (a port named it) but was never written."""

    def __repr__(self) -> str:
        return "<empty>"


EMPTY: Final = _Empty()


class Entry:
    """One value with its kind (None: open) and the count of its writes; `board` counts those of all entries."""

    __slots__ = ("board", "kind", "seq", "value")

    def __init__(self, board: Board, kind: Kind | None = None) -> None:
        self.board = board
        self.kind = kind
        self.value: Any = EMPTY
        self.seq = 0

    def put(self, value: Any) -> None:
        """Store without looking at kinds; counts as a write."""
        self.value = value
        self.seq += 1
        self.board.writes += 1


class TopicEntry(Entry):
    """A topic seen as an entry: read-only, always the newest value of the tick's snapshot."""

    __slots__ = ("_name", "_topics")

    def __init__(self, topics: Topics, name: str) -> None:
        self._topics, self._name = topics, name
        self.kind = None

    @property
    def value(self) -> Any:
        """The newest value, or EMPTY."""
        try:
            return self._topics.get(self._name)
        except KeyError:
            return EMPTY

    @property
    def seq(self) -> int:  # type: ignore[override]  # an entry of ours counts its writes, a topic is counted elsewhere
        """The topic's sequence number where it is known."""
        count = getattr(self._topics, "seq", None)
        return int(count(self._name)) if count is not None else id(self.value)

    def put(self, value: Any) -> None:
        """Refused: topics are written by their modules alone."""
        raise PortProblem(f"topic {self._name!r} is read-only")


class Board:
    """All scopes of one mission."""

    def __init__(self, topics: Topics | None = None) -> None:
        self.topics = topics
        self.robot: Any = None
        self.topic_names = frozenset(topics.names()) if topics is not None else frozenset()
        self.changes = 0  # counts entries made and removed, so that readers know when to look again
        self.writes = 0  # counts all writes, and entries made and removed
        self.root = Scope(self, None, "")


class Scope:
    """The entries of one tree instance."""

    __slots__ = ("autoremap", "board", "entries", "name", "parent", "remap")

    def __init__(self, board: Board, parent: Scope | None, name: str) -> None:
        self.board, self.parent, self.name = board, parent, name
        self.entries: dict[str, Entry] = {}
        self.remap: dict[str, str] = {}
        self.autoremap = False

    def find(self, key: str) -> Entry | None:
        """The entry that `key` means here, or None."""
        if key.startswith("@"):
            return self.board.root.find(key[1:])
        entry = self.entries.get(key)
        if entry is not None:
            return entry
        if self.parent is None:
            return self._topic(key)
        if key in self.remap:
            return self.parent.find(self.remap[key])
        return self.parent.find(key) if self._falls_through(key) else None

    def declare(self, key: str, kind: Kind | None) -> Entry:
        """The entry for `key`, made where the mapping says if there is none. Raises PortProblem for a key with two `@`."""
        if key.startswith("@"):
            if "@" in key[1:]:
                raise PortProblem(f"key {key!r} has more than one '@'")
            return self.board.root.declare(key[1:], kind)
        entry = self.entries.get(key)
        if entry is None and self.parent is not None and (key in self.remap or self._falls_through(key)):
            return self.parent.declare(self.remap.get(key, key), kind)
        if entry is None:
            entry = self._topic(key) if self.parent is None else None
        if entry is None:
            entry = self.entries[key] = Entry(self.board, kind)
            self.board.changes += 1
            self.board.writes += 1
        return entry

    def write(self, key: str, value: Any, kind: Kind | None = None) -> None:
        """Write by the rules of kinds (`Blackboard::set`); `kind` is that of the writing port, if it has one."""
        kind = kind if kind is not None and kind.typed else kind_of_value(value)
        entry = self.entries.get(key) or self.find(key)
        if entry is None:
            self.declare(key, kind if kind is not STRING else None).put(value)  # a first text leaves the entry open
        elif entry.kind is kind and kind is not None:
            entry.put(value)
        elif entry.kind is None or not entry.kind.typed:
            entry.put(value)
            if kind is not None or isinstance(value, str):
                entry.kind = kind or STRING
        else:
            entry.put(_fitted(key, entry.kind, kind, value))

    def copy(self, key: str, value: Any, kind: Kind | None) -> None:
        """Write as SetBlackboard does: a new entry takes the kind of the value, an open one stays open, a typed one must match."""
        entry = self.find(key)
        if entry is None:
            self.declare(key, kind).put(value)
        elif entry.kind is None or not entry.kind.typed or entry.kind is kind:
            entry.put(value)
        elif isinstance(value, str):
            entry.put(entry.kind.convert(value))
        else:
            entry.put(_fitted(key, entry.kind, kind, value))

    def unset(self, key: str) -> None:
        """Remove the local entry, if there is one."""
        if key.startswith("@"):
            self.board.root.unset(key[1:])
        elif self.entries.pop(key, None) is not None:
            self.board.changes += 1
            self.board.writes += 1

    def _falls_through(self, key: str) -> bool:
        return self.autoremap and not key.startswith("_")

    def _topic(self, key: str) -> Entry | None:
        board = self.board
        if key in board.topic_names and board.topics is not None:
            return TopicEntry(board.topics, key)
        return None


def _fitted(key: str, wanted: Kind, kind: Kind | None, value: Any) -> Any:
    """`value` as the kind the entry has: equal kinds, numbers that fit exactly, texts that can be parsed."""
    if kind is wanted:
        return value
    if isinstance(value, str) or (isinstance(value, (int, float)) and wanted.name not in ("string", "NodeStatus")):
        return wanted.convert(value)
    if kind is None and wanted is not STRING:
        return wanted.convert(value)
    found = kind.name if kind is not None else type(value).__name__
    raise PortProblem(f"entry {key!r} holds {wanted.name} and cannot take {found}")


class EntryReader:
    """Reads the entry `key` of a scope as a kind. It looks the entry up again only after entries were made or removed.

    The fields are open to `get_input` of leaves, which spares itself the call as long as nothing has to be looked up or converted.
    """

    __slots__ = ("board", "convert", "entry", "key", "scope", "seen", "wanted")

    def __init__(self, scope: Scope, key: str, kind: Kind) -> None:
        self.scope, self.key, self.board = scope, key, scope.board
        self.wanted, self.convert = kind.python, kind.convert
        self.entry, self.seen = MISSING, -1

    def read(self) -> Any:
        """The value. Raises MissingValue, or PortProblem if it does not fit."""
        if self.seen != self.board.changes:
            self.entry, self.seen = self.scope.find(self.key) or MISSING, self.board.changes
        value = self.entry.value
        if type(value) is self.wanted:
            return value
        if value is EMPTY:
            raise MissingValue(f"entry {self.key!r} has no value")
        return self.convert(value)


class MissingValue(PortProblem):
    """An entry that nobody has written."""


NO_BOARD: Final = Board()
MISSING: Final = Entry(NO_BOARD)  # stands for an entry that does not exist
