"""A line at the prompt is short: drawing a long one again at each key would hold up everybody who is served by the same process."""

from __future__ import annotations

from collections.abc import Callable

from prompt_toolkit.buffer import Buffer
from prompt_toolkit.document import Document
from prompt_toolkit.key_binding import KeyBindings, KeyPressEvent
from prompt_toolkit.keys import Keys

LONGEST = 1000


def keep_short(buffer: Buffer, bindings: KeyBindings, complain: Callable[[str], None]) -> None:
    """Leave out what goes beyond `LONGEST` characters, typed or pasted; it is told once a line."""
    told = [False]

    def look(changed: Buffer) -> None:
        if len(changed.text) > LONGEST:
            changed.document = Document(changed.text[:LONGEST], min(changed.cursor_position, LONGEST))
            if not told[0]:
                complain(f"a line has at most {LONGEST} characters; the rest is left out")
            told[0] = True
        elif len(changed.text) < LONGEST:
            told[0] = False

    @bindings.add(Keys.BracketedPaste)
    def paste(event: KeyPressEvent) -> None:
        event.current_buffer.insert_text(event.data[: LONGEST + 1].replace("\r\n", "\n").replace("\r", "\n"))

    buffer.on_text_insert += look
