"""The keys that open the ssh door, and whose they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import asyncssh

NAME_CHARACTERS = 64


class KeyRing(asyncssh.SSHAuthorizedKeys):
    """A file like OpenSSH's `authorized_keys`, as asyncssh asks it.

    Attributes:
        owner: the comment of the key that was shown last, "" if it has none, or a certificate was shown. The last one shown is the one that opens.
    """

    def __init__(self, path: Path) -> None:
        """Raises: OSError, ValueError if it cannot be read, or holds no key."""
        self._text = path.read_text(encoding="utf-8")
        self.owner = ""
        super().__init__(self._text)

    def validate(
        self, key: asyncssh.SSHKey, client_host: str, client_addr: str, cert_principals: Sequence[str] | None = None, ca: bool = False
    ) -> Mapping[str, object] | None:
        """The options of this key; None if it opens nothing."""
        self.owner = "" if ca else self._comment(key)
        return super().validate(key, client_host, client_addr, cert_principals, ca)

    def _comment(self, key: asyncssh.SSHKey) -> str:
        """What stands behind the key in its line."""
        written = key.export_public_key("openssh").decode().split()[1]
        behind = (line.rpartition(written)[2] for line in self._text.splitlines() if not line.lstrip().startswith("#") and written in line.split())
        return shown_name(next(behind, ""))


def shown_name(text: str) -> str:
    """A name that fits into a line: printable, its words one space apart, not endless."""
    return " ".join("".join(letter if letter.isprintable() else " " for letter in text).split())[:NAME_CHARACTERS]
