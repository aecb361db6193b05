"""The keys of the ssh door: whose keys open it, and the key by which it is known."""

from __future__ import annotations

import os
from pathlib import Path

from pluto_bt.runtime.state_folder import state_folder
from pluto_bt.source import Faults, Place
from pluto_bt.source.faults import fail

OPTION = "--ssh-keys"
HOST_KEY = "ssh_host_ed25519_key"
MEND = "make one with `ssh-keygen -t ed25519`, and write the .pub file's line into it, one a line"


def default_keys() -> Path:
    """Who may log in to this account may also command its robot."""
    return Path("~/.ssh/authorized_keys").expanduser()


def check_keys(path: Path, faults: Faults) -> None:
    """The file of authorised keys, read as OpenSSH reads it; every line that is none is a fault, and so is a file without a key."""
    import asyncssh

    place = Place(str(path))
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        others_write = path.stat().st_mode & 0o022
    except (OSError, UnicodeDecodeError) as error:
        found = getattr(error, "strerror", None) or str(error)
        mend = f"{OPTION} FILE names another file; {MEND}"
        faults.error(place, "no-keys", "nobody could log in by ssh", expected="a file of public keys", found=found, mend=mend)
        return
    if others_write:
        what, mend = "others may write this file, and so let themselves in", f"chmod 600 {path}"
        faults.error(place, "unsafe-keys", what, expected="mode 600 or 644", found=f"{path.stat().st_mode & 0o777:o}", mend=mend)
    is_empty = True
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        is_empty = False
        try:
            asyncssh.import_authorized_keys(line)
        except (ValueError, asyncssh.KeyImportError) as error:
            here = Place(str(path), number, 1, line)
            faults.error(here, "bad-key", "not a public key", expected="ssh-ed25519 AAAA… comment", found=str(error).lower(), mend=MEND)
    if is_empty:
        faults.error(place, "no-keys", "nobody could log in by ssh: the file holds no key", expected="a public key a line", mend=MEND)


def host_key() -> Path:
    """The host key's file, made at the first call, readable for its owner alone. Raises: InputError."""
    import asyncssh

    place = Place("--ssh")
    try:
        path = state_folder() / HOST_KEY
        if not path.exists():
            key = asyncssh.generate_private_key("ssh-ed25519", "pluto")
            written = path.with_name(f"{HOST_KEY}.{os.getpid()}")
            with os.fdopen(os.open(written, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as out:
                out.write(key.export_private_key())
            os.replace(written, path)
        if path.stat().st_mode & 0o077:
            mend = f"chmod 600 {path}, or remove it: a new one is made"
            fail(place, "unsafe-host-key", f"others may read the host key {path}", expected="mode 600", mend=mend)
        asyncssh.read_private_key(path)
    except (OSError, RuntimeError) as error:
        fail(place, "no-host-key", "the host key cannot be kept", found=str(error), mend="XDG_STATE_HOME names a folder that can be written")
    except (ValueError, asyncssh.KeyImportError) as error:
        fail(place, "no-host-key", f"{path} is no host key", found=str(error), mend=f"remove {path}: a new one is made")
    return path
