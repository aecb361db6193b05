"""The values of options, read from what was typed; each that does not fit is a fault at its option."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from pluto_bt.commands.extras import need
from pluto_bt.source import Faults, InputError, Place
from pluto_bt.source.faults import fail

if TYPE_CHECKING:
    from pluto_bt.gateway.access import Access
    from pluto_bt.gateway.listen import Address
    from pluto_bt.gateway.ssh_link import SshRequest

Pose = tuple[float, float, float]
MAX_METRES = 1e6  # as in world files
MAX_SEED = 2**63 - 1
MAX_SECONDS = 1e9


def read_start(text: str | None, faults: Faults) -> Pose | None:
    """`--start X,Y,DEG` as x m, y m, theta rad; None if it is not given or no pose."""
    if text is None:
        return None
    words = text.split(",")
    numbers = [number for word in words if (number := _number(word)) is not None and abs(number) <= MAX_METRES]
    if len(words) != 3 or len(numbers) != 3:
        expected = f"X,Y,DEG, for example 0.5,12,90; none beyond {MAX_METRES:g}"
        faults.error(Place(f"--start {text}"), "bad-value", "a start pose is three numbers", expected=expected, found=text or "nothing")
        return None
    return (numbers[0], numbers[1], math.remainder(math.radians(numbers[2]), math.tau))


def read_seed(text: str | None, faults: Faults) -> int | None:
    """`--seed N`."""
    if text is None:
        return None
    if text.isascii() and text.isdigit() and len(text) <= 20 and int(text) <= MAX_SEED:
        return int(text)
    faults.error(Place(f"--seed {text}"), "bad-value", "a seed is a whole number", expected="0 to 2^63 - 1", found=text or "nothing")
    return None


def read_positive(text: str | None, option: str, faults: Faults) -> float | None:
    """A number above 0, for `--max-time` and `--speed`."""
    if text is None:
        return None
    number = _number(text)
    if number is not None and 0.0 < number <= MAX_SECONDS:
        return number
    what = f"{option} takes a number above 0"
    faults.error(Place(f"{option} {text}"), "bad-value", what, expected=f"a number above 0, at most {MAX_SECONDS:g}", found=text or "nothing")
    return None


def read_ports(settings: Sequence[str], faults: Faults) -> dict[str, str]:
    """`--port NAME=VALUE` settings as a table."""
    ports: dict[str, str] = {}
    for setting in settings:
        name, equals, value = setting.partition("=")
        place = Place(f"--port {setting}")
        if not equals or not name:
            faults.error(place, "bad-port", "an input has the form NAME=VALUE", expected="NAME=VALUE", found=setting or "nothing")
        elif name in ports:
            faults.error(place, "bad-port", f'input "{name}" is given twice', expected="each input once", found=setting)
        else:
            ports[name] = value
    return ports


def check_gateway(address: str | None, access: Access, faults: Faults) -> None:
    """An asked address that does not exist, is in use or not the loopback is refused before anything is loaded."""
    if address is None:
        return
    from pluto_bt.gateway.listen import open_listener, parse_address

    try:
        open_listener(parse_address(address), access).close()
    except InputError as error:
        faults.extend(error.faults)


def web_address(text: str) -> Address:
    """`--web HOST:PORT`. Raises: InputError."""
    from pluto_bt.gateway.listen import WEB_PORT, parse_address

    return parse_address(text, "--web", WEB_PORT)


def check_web(text: str | None, faults: Faults, access: Access | None = None) -> None:
    """The address of the web console, whether it can be had, and whether its library is there."""
    if text is None:
        return
    need("web", "--web", faults)
    from pluto_bt.gateway.listen import open_listener

    try:
        open_listener(web_address(text), access, "--web").close()
    except InputError as error:
        faults.extend(error.faults)


def groot_address(text: str) -> Address:
    """`--groot [HOST:]PORT`, on the loopback: 127.0.0.1 without a host, 1667 without a port. Raises: InputError."""
    from pluto_bt.gateway.listen import Address, parse_address

    place = Place("--groot")
    text = text if ":" in text or text.isdigit() else f"{text}:1667"
    try:
        address = parse_address(text)
    except InputError:
        fail(place, "bad-address", f'bad address "{text}"', expected="[HOST:]PORT with a port of 0 to 65534", found=text)
    if address.host not in ("127.0.0.1", "localhost"):
        mend = f"listen on 127.0.0.1:{address.port} and reach it through ssh: ssh -L {address.port}:127.0.0.1:{address.port} ROBOT"
        fail(place, "not-loopback", f"the monitor does not listen on {address.host}", expected="127.0.0.1 or localhost", found=text, mend=mend)
    if address.port == 65535:
        fail(place, "bad-address", "the monitor needs the port after this one too", expected="a port of 0 to 65534", found=text)
    return Address("127.0.0.1", address.port)


def check_groot(text: str | None, faults: Faults) -> None:
    """The address of the monitor, and whether its library is there."""
    if text is None:
        return
    need("groot", "--groot", faults)
    try:
        groot_address(text)
    except InputError as error:
        faults.extend(error.faults)


def read_ssh(text: str | None, keys: str | None, faults: Faults) -> SshRequest | None:
    """`--ssh HOST:PORT` with `--ssh-keys FILE`: the address, the library and the keys."""
    if text is None:
        if keys is not None:
            faults.error(Place("--ssh-keys"), "bad-usage", "--ssh-keys is for --ssh", mend="add --ssh HOST:PORT")
        return None
    from pluto_bt.gateway.listen import parse_address
    from pluto_bt.gateway.ssh_link import DEFAULT_PORT, SshRequest, open_ssh_listener

    if not need("shell", "--ssh", faults):
        return None
    from pluto_bt.gateway.ssh_keys import check_keys, default_keys

    path = default_keys() if keys is None else Path(keys).expanduser()
    check_keys(path, faults)
    try:
        address = parse_address(text if ":" in text or text.isdigit() else f"{text}:{DEFAULT_PORT}")
        open_ssh_listener(address).close()
    except InputError as error:
        faults.extend(replace(fault, file="--ssh") for fault in error.faults)
        return None
    return SshRequest(address, path.absolute())


def _number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None
