"""One line of the shell: found in the table, read, done; every failure is a sentence and an exit code."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from pluto_bt.gateway.client import GatewayError
from pluto_bt.gateway.shell.arguments import read_all
from pluto_bt.gateway.shell.codes import DONE, FAILED, USAGE, FailedError, UsageError
from pluto_bt.gateway.shell.face import Face
from pluto_bt.gateway.shell.robot import Robot
from pluto_bt.gateway.shell.row import Row
from pluto_bt.gateway.shell.table import SUBSHELLS, help_text, rows_in
from pluto_bt.source import did_you_mean

IN_WORDS = {
    '<mission op="pause"/>': "pause", '<mission op="abort"/>': "abort", '<release what="estop"/>': "release", "<describe/>": "topics",
    "<params/>": "params", "<why/>": "why",
}  # fmt: skip


def split(line: str) -> list[str]:
    """The words of a line; `#` begins a comment. Raises: UsageError for an open quote."""
    try:
        return shlex.split(line, comments=True)
    except ValueError as error:
        raise UsageError(f"expected closed quotes, found {line.strip()}: {str(error).lower()}") from None


def subshell(words: Sequence[str]) -> str:
    """The sub-shell that a line opens: `wrist`, or `drive>` where a command has the same name; "" if it opens none."""
    name = words[0].removesuffix(">") if len(words) == 1 else ""
    return name if name in SUBSHELLS and (words[0] != name or name not in rows_in("")) else ""


def find(words: Sequence[str], shell: str = "") -> tuple[Row, list[str]]:
    """The row that the words mean, and its arguments. Raises: UsageError."""
    opened = words[0].removesuffix(">")
    if opened in SUBSHELLS and len(words) > 1 and (opened not in rows_in(shell) or words[1] in rows_in(opened)):
        shell, words = opened, words[1:]
    known = rows_in(shell)
    if words[0] not in known:
        others = list(dict.fromkeys((*known, *SUBSHELLS, "help", "quit")))
        raise UsageError(f'unknown command "{words[0]}"; {did_you_mean(words[0], others) or "expected one of: " + ", ".join(others)}')
    return known[words[0]], list(words[1:])


async def obey(robot: Robot, face: Face, words: Sequence[str], shell: str = "") -> int:
    """Do one command; its exit code."""
    try:
        if words[0] == "help":
            return _help(face, words[1:], shell)
        row, given = find(words, shell)
        try:
            values = read_all(row.arguments, given)
            return await row.act(robot, face, *values)
        except UsageError as error:
            raise UsageError(f"{row.name}: {error}; usage: {row.usage}") from None
    except UsageError as error:
        face.complain(str(error))
        return USAGE
    except FailedError as error:
        face.complain(str(error))
    except GatewayError as error:
        face.complain(f"{error.code}: {_in_words(error.text)}{robot.advice(error)}")
    return FAILED


def _in_words(text: str) -> str:
    """The gateway tells programs what to send; here a person reads it."""
    for element, word in IN_WORDS.items():
        text = text.replace(element, f"`{word}`")
    return text


def _help(face: Face, words: Sequence[str], shell: str) -> int:
    if not words:
        face.say(help_text(shell))
    elif words[0] in SUBSHELLS and words[0] not in rows_in(shell):
        face.say(help_text(words[0]))
    else:
        row, _ = find(words, shell)
        face.say(f"{row.usage}\n  {row.doc}{'; needs the lease, and a mission that is paused or over' if row.drives else ''}")
        face.say("\n".join(f"  {argument.name}: {argument.expected}" for argument in row.arguments)) if row.arguments else None
    return DONE
