"""What the Tab key offers: commands, then the words that fit each argument."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from prompt_toolkit.completion import CompleteEvent, Completer, Completion
from prompt_toolkit.document import Document

from pluto_bt.gateway.shell.arguments import Argument
from pluto_bt.gateway.shell.table import SUBSHELLS, rows_in


class TableCompleter(Completer):
    """Completes from the table, and from what the robot knows: by kind (topic, module, …) the names with their meanings."""

    def __init__(self, names: Callable[[], Mapping[str, Mapping[str, str]]]) -> None:
        self.shell = ""
        self._names = names

    def get_completions(self, document: Document, complete_event: CompleteEvent) -> Iterable[Completion]:
        """Every word that goes on with what was typed."""
        *before, typed = document.text_before_cursor.lstrip().split(" ")
        for offered, meaning in self._offered([word for word in before if word]):
            if offered.startswith(typed):
                yield Completion(offered, -len(typed), display_meta=meaning)

    def _offered(self, before: list[str]) -> Iterator[tuple[str, str]]:
        shell = self.shell
        if before and before[0] in SUBSHELLS and (before[0] not in rows_in(shell) or len(before) > 1):
            shell, *before = before
        rows = rows_in(shell)
        if not before:
            yield from ((row.name, row.doc) for row in rows.values())
            yield from ((f"{name}>" if name in rows else name, "a module's own commands") for name in SUBSHELLS if shell == self.shell)
            yield from (("help", "this list, or one command of it"), ("quit", "leave"))
        elif before[0] == "help" and len(before) == 1:
            yield from ((name, "") for name in (*rows, *SUBSHELLS))
        elif before[0] in rows:
            yield from self._words(rows[before[0]].arguments, before[1:])

    def _words(self, arguments: tuple[Argument, ...], given: list[str]) -> Iterator[tuple[str, str]]:
        at = min(len(given), len(arguments) - 1) if arguments and arguments[-1].is_rest else len(given)
        if at < len(arguments):
            words = arguments[at].words
            kind = f"port {given[0]}" if words == "port" else words
            known = self._names().get(kind, {}) if isinstance(kind, str) else dict.fromkeys(kind, arguments[at].expected)
            yield from known.items()
