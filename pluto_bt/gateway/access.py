"""Who may come in from elsewhere, and what he may do: the file of people, the certificate of the gateway."""

from __future__ import annotations

import hashlib
import hmac
import ssl
import stat
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import msgspec
from msgspec import Meta

from pluto_bt.gateway import requests
from pluto_bt.gateway.requests import AnyRequest
from pluto_bt.runtime.parameters import build
from pluto_bt.source import Faults, Place
from pluto_bt.source.toml_reader import read_toml

Scope = Literal["watch", "drive", "tune", "admin"]
SCOPES: tuple[Scope, ...] = get_args(Scope)
LEAST_TOKEN = 16


class Person(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One table of the file of people: how he is known, and what he may do. `admin` may do everything."""

    token: Annotated[str, Meta(description="a secret of at least 16 characters, for <hello token=…>")] = ""
    certificate: Annotated[str, Meta(description="common name of his client certificate")] = ""
    scopes: Annotated[tuple[Scope, ...], Meta(min_length=1, description="watch, drive, tune, admin")]


class Key(msgspec.Struct, frozen=True):
    """A person as the gateway process knows him: the token only as its SHA-256."""

    name: str
    token_sha256: str
    certificate: str
    scopes: tuple[str, ...]


class Access(msgspec.Struct, frozen=True):
    """How clients are let in. Without keys everybody may do everything (on the loopback); without `certificate` the stream is not encrypted."""

    keys: tuple[Key, ...] = ()
    certificate: str = ""
    private_key: str = ""
    client_authority: str = ""

    def with_token(self, name: str, token: str) -> Access:
        """The same, with one more who may do everything: a door of ours that looks after its own people; with the name "" it says who comes."""
        key = Key(name, hashlib.sha256(token.encode()).hexdigest(), "", SCOPES)
        return msgspec.structs.replace(self, keys=(*self.keys, key))

    def by_token(self, token: str) -> Key | None:
        """Whose token this is."""
        digest = hashlib.sha256(token.encode()).hexdigest()
        fitting = [key for key in self.keys if hmac.compare_digest(key.token_sha256, digest)]
        return fitting[0] if fitting else None

    def by_certificate(self, common_name: str) -> Key | None:
        """Whose client certificate this is; the TLS library has verified it."""
        return next((key for key in self.keys if common_name and key.certificate == common_name), None)

    def context(self) -> ssl.SSLContext | None:
        """The TLS side of the listening socket; None without a certificate. Raises: OSError (SSLError)."""
        if not self.certificate:
            return None
        context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
        context.minimum_version = ssl.TLSVersion.TLSv1_2
        context.load_cert_chain(self.certificate, self.private_key)
        if self.client_authority:
            context.load_verify_locations(self.client_authority)
            context.verify_mode = ssl.CERT_OPTIONAL
        return context


def scope_of(request: AnyRequest) -> str:
    """What a client must be allowed to do for this request."""
    if request.only_looks:
        return "watch"
    match request:
        case requests.Params():
            return "tune"
        case requests.ModuleOp():
            return "admin"
        case (
            requests.Lease() | requests.MissionOp() | requests.Command() | requests.Run() | requests.Cancel() | requests.Release()
            | requests.SetTopic()
        ):  # fmt: skip
            return "drive"
    return "watch"


def read_access(tls: str | None, tokens: str | None, faults: Faults) -> Access:
    """The access that the options `--gateway-tls CERT,KEY[,AUTHORITY]` and `--gateway-tokens FILE` ask for."""
    keys = _keys(tokens, faults) if tokens is not None else ()
    if tls is None:
        return Access(keys)
    place = Place(f"--gateway-tls {tls}")
    files = [Path(word) for word in tls.split(",")]
    if len(files) not in (2, 3):
        mend = "openssl req -x509 -newkey rsa:2048 -nodes -keyout key.pem -out cert.pem -days 365 -subj /CN=ROBOT makes a pair"
        expected = "CERT.pem,KEY.pem[,CLIENT-AUTHORITY.pem]"
        faults.error(place, "bad-option", "a TLS identity is two or three files", expected=expected, found=tls, mend=mend)
        return Access(keys)
    access = Access(keys, *map(str, files))
    is_readable = [_is_readable(file, place, faults) for file in files]
    if not all(is_readable):
        return access
    try:
        access.context()
    except OSError as error:
        faults.error(place, "bad-certificate", "the TLS identity cannot be read", expected="PEM files that belong together", found=str(error))
    return access


def _is_readable(file: Path, place: Place, faults: Faults) -> bool:
    try:
        file.open("rb").close()
    except OSError as error:
        faults.error(place, "bad-certificate", f'the file "{file}" cannot be read', expected="a PEM file", found=error.strerror or str(error))
        return False
    return True


def _keys(file: str, faults: Faults) -> tuple[Key, ...]:
    """The people of a file, one TOML table each."""
    found: list[Key] = []
    path = Path(file)
    if path.is_file() and path.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO):
        expected, mend = "a file of its owner alone", f"chmod 600 {file}"
        faults.error(Place(file), "open-secret", "others may read this file of tokens", expected=expected, mend=mend)
    table, locate = read_toml(path, file, faults)
    for name, value in table.items():
        place = locate((name,))
        if not isinstance(value, dict):
            expected = "tables: [NAME] with token or certificate, and scopes"
            faults.error(place, "bad-value", f'"{name}" is no person', expected=expected, found=str(value))
            continue
        person = build(Person, value, locate, faults, (name,))
        if person is not None:
            _check(person, name, place, faults)
            digest = hashlib.sha256(person.token.encode()).hexdigest() if person.token else ""
            found.append(Key(name, digest, person.certificate, person.scopes))
    if not found and not faults.has_errors:
        faults.error(Place(file), "no-person", "nobody is in this file", expected='[anna], then token = "…" and scopes = ["watch", "drive"]')
    return tuple(found)


def _check(person: Person, name: str, place: Place, faults: Faults) -> None:
    if not person.token and not person.certificate:
        faults.error(place, "missing-parameter", f'"{name}" cannot show who he is', expected="token or certificate")
    elif person.token and len(person.token) < LEAST_TOKEN:
        faults.error(place, "bad-value", f'the token of "{name}" is too short', expected=f"at least {LEAST_TOKEN} characters",
                     found=str(len(person.token)), mend="openssl rand -hex 16 makes one")  # fmt: skip


def may(scopes: Sequence[str], request: AnyRequest) -> bool:
    """True if somebody with these scopes may ask this."""
    return "admin" in scopes or scope_of(request) in scopes


def shown_scopes(scopes: Sequence[Any]) -> str:
    """For messages."""
    return ", ".join(scopes) or "none"
