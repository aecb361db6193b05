"""The one wrapper around numba: `@kernel` compiles a hot function on its first use and caches the machine code where it can be written.

numba costs 0.4 s to import, so it is imported when the first kernel is used, never when a module is read.
It raises when its cache folder is read-only, so three places are tried: beside the source, the user's cache, none.
No `fastmath` and no `parallel`: the same inputs must give the same bits. Division by zero gives inf or NaN, as in numpy.
In kernels write loops, not `a[:] = b` or `np.any(a)`: each of those adds a second or more to the first compilation.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FunctionType
from typing import Any, Generic, ParamSpec, TypeVar, cast

P = ParamSpec("P")
R = TypeVar("R")

_COMPILING = threading.RLock()  # numba's own lock does not cover our linking


class Kernel(Generic[P, R]):
    """A function that numba compiles when it is first called, or first called by a kernel that is being compiled.

    A call through this object costs a fraction of a microsecond more than the machine code; who calls often takes `compiled()` once.
    Kernels may call kernels of any module; they may not call themselves.
    """

    def __init__(self, function: Callable[P, R], *, inline: bool = False) -> None:
        self._function = cast(FunctionType, function)
        self._inline = inline
        self._compiled: Callable[P, R] | None = None
        self.__name__ = function.__name__
        self.__doc__ = function.__doc__
        self.__module__ = function.__module__

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        """Run the machine code."""
        return (self._compiled or self.compiled())(*args, **kwargs)

    def compiled(self) -> Callable[P, R]:
        """The function as numba's dispatcher, to be called without detour."""
        if self._compiled is None:
            with _COMPILING:
                if self._compiled is None:
                    self._compiled = self._compile()
        return self._compiled

    def _compile(self) -> Callable[P, R]:
        plain = self._function
        linked = FunctionType(plain.__code__, plain.__globals__ | self._called(), plain.__name__, plain.__defaults__, plain.__closure__)
        linked.__qualname__ = plain.__qualname__
        return cast(Callable[P, R], _dispatcher(linked, self._inline, self._stamps()))

    def _kernels(self) -> dict[str, Kernel[..., Any]]:
        """The kernels that this one calls, by the names it knows them by."""
        known = self._function.__globals__
        return {name: known[name] for name in self._function.__code__.co_names if isinstance(known.get(name), Kernel) and known[name] is not self}

    def _called(self) -> dict[str, Callable[..., Any]]:
        return {name: called.compiled() for name, called in self._kernels().items()}

    def _stamps(self) -> tuple[tuple[str, int, int], ...]:
        """Name, time and size of every source file that goes into the machine code, this kernel's own and its callees'."""
        files = (self._function.__code__.co_filename, __file__)
        stamps = {(Path(file).name, os.stat(file).st_mtime_ns, os.stat(file).st_size) for file in files}
        for called in self._kernels().values():
            stamps.update(called._stamps())
        return tuple(sorted(stamps))


def kernel(function: Callable[P, R]) -> Kernel[P, R]:
    """Make `function` a kernel: compiled with numba when first needed, cached between runs where possible."""
    return Kernel(function)


def inline_kernel(function: Callable[P, R]) -> Kernel[P, R]:
    """A kernel that is pasted into the kernels that call it: for the body of a hot loop, where a call with arrays costs 10 ns."""
    return Kernel(function, inline=True)


@contextmanager
def telling_of_compilation(tell: Callable[[], None]) -> Iterator[None]:
    """Call `tell` once, just before the first kernel is compiled in here; never if all of them lie in the cache."""
    from numba.core import event

    class FirstCompilation(event.Listener):
        is_told = False

        def on_start(self, _: object) -> None:
            if not self.is_told:
                self.is_told = True
                tell()

        def on_end(self, _: object) -> None:
            """Of no interest."""

    with event.install_listener("numba:compile", FirstCompilation()):
        yield


def _dispatcher(function: FunctionType, inline: bool, stamps: tuple[tuple[str, int, int], ...]) -> Any:
    caching = _cache_is_possible()
    import numba

    try:
        dispatcher = numba.njit(cache=caching, nogil=True, error_model="numpy", forceinline=inline)(function)
    except RuntimeError:  # "cannot cache function: no locator available"
        return numba.njit(nogil=True, error_model="numpy", forceinline=inline)(function)
    cache_file = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
    if cache_file is not None and hasattr(cache_file, "_source_stamp"):
        # numba looks at the kernel's own file alone and would run old machine code after a change in a kernel it calls
        cache_file._source_stamp = (cache_file._source_stamp, stamps)
    return dispatcher


def _cache_is_possible() -> bool:
    """True once numba has a folder to write to: its default one, or the user's cache set here."""
    here = Path(__file__).resolve().parent
    if os.environ.get("NUMBA_CACHE_DIR") or os.access(here, os.W_OK):
        return True
    try:
        user = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "pluto_bt" / "numba"
        user.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError):  # RuntimeError: the user has no home folder
        return False
    os.environ["NUMBA_CACHE_DIR"] = str(user)
    return True
