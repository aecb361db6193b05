"""The one wrapper around numba: `@kernel` compiles a hot function and caches the machine code where it can be written.

numba raises at import when its cache folder is read-only, so three places are tried: beside the source, the user's cache, none.
No `fastmath` and no `parallel`: the same inputs must give the same bits.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])


def _cache_is_possible() -> bool:
    """True once numba has a folder to write to: its default one, or the user's cache set here."""
    here = Path(__file__).resolve().parent
    if os.environ.get("NUMBA_CACHE_DIR") or os.access(here, os.W_OK):
        return True
    user = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "pluto_bt" / "numba"
    try:
        user.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    os.environ["NUMBA_CACHE_DIR"] = str(user)
    return True


def kernel(function: F) -> F:
    """Compile `function` with numba on its first call (never at import), cached between runs where possible."""
    caching = _cache_is_possible()
    import numba

    try:
        return cast(F, numba.njit(cache=caching, nogil=True)(function))
    except RuntimeError:  # "cannot cache function: no locator available"
        return cast(F, numba.njit(nogil=True)(function))
