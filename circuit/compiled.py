"""Compiled functions, and the cache of their machine code: in a private folder, keyed by everything it was made from.

numba's own cache lies beside the sources, does not notice a change in another file, and is a pickle: whoever can write
it can run code as the user who reads it, and a damaged file ends every run. Here the name of a file is a hash of
everything it was made from, the file begins with a hash of its content, and it is read only from a private folder, or
from the package itself (`compiled_ahead`). What cannot be read is compiled again.
"""

# mypy: disable-error-code="no-untyped-call,misc,assignment,import-untyped"
# numba's classes have no types.
from __future__ import annotations

import hashlib
import logging
import multiprocessing
import pickle
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import llvmlite
import numba
import numpy as np
from numba.core.caching import FunctionCache
from numba.core.dispatcher import Dispatcher
from numba.core.runtime.nrt import rtsys
from numba.core.serialize import dumps

from thermicon.icons.userfolder import (
    NotPrivate,
    compiled_folder,
    opened,
    private_folder,
    read_private,
    remove_unused,
    sealed,
    write_private,
)

from .compiled_ahead import as_brought, brought, read_brought

STALE_S = 90 * 24 * 3600.0
"""Machine code that was not used for this long is removed."""

Kernel = Callable[..., Any]


def kernel(**options: Any) -> Callable[[Kernel], Any]:
    """Return a decorator that compiles a function with options of `numba.njit`, and keeps its machine code safely.

    >>> @kernel(nogil=True)
    ... def twice(x):
    ...     return 2 * x
    >>> twice(21)
    42
    """

    def decorate(function: Kernel) -> Any:
        dispatcher = numba.njit(**options)(function)
        dispatcher._cache = _KernelCache(function, _in_order(options))
        return dispatcher

    return decorate


def _in_order(options: dict[str, Any]) -> str:
    """Options as text that is the same in every process: the order of a set of words is not."""
    return repr([(name, sorted(held) if isinstance(held, set) else held) for name, held in sorted(options.items())])


class _KernelCache(FunctionCache):
    """numba's cache of one function, with the store of this module in place of numba's own."""

    def __init__(self, function: Kernel, options: str) -> None:
        self._name, self._py_func, self._options = repr(function), function, options
        self._impl = _Reduced()
        self._cache_file: Any = _Store(function, options)
        self._cache_path = ""
        self.enable()

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the compiled function for a signature; None for any fault, since compiling again is the cure."""
        overload = None
        with suppress(Exception):
            rtsys.initialize(target_context)
            overload = self._load_overload(sig, target_context)
        if overload is None:
            _no_search_for_blas()
        return overload

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a compiled function; where that fails, later runs compile it again."""
        with suppress(Exception):
            super().save_overload(sig, data)


@cache
def _no_search_for_blas() -> None:
    """Spare numba the import of scipy.linalg, by which it learns that BLAS is there: it is, as scipy is required."""
    from numba.np import linalg

    search = linalg.ensure_blas
    linalg.ensure_blas = lambda: None
    try:
        arraymath: Any = import_module("numba.np.arraymath")
    finally:
        linalg.ensure_blas = search
    arraymath.ensure_blas = search


class _Reduced:
    """What `FunctionCache` needs: how a compiled function becomes plain data and is rebuilt from it."""

    class _Nowhere:
        def ensure_cache_path(self) -> None:
            """Nothing to do: the store creates its folder itself."""

    locator = _Nowhere()

    def reduce(self, compiled: Any) -> Any:
        # The only text is a listing of the source with its paths, a third of the file, which nothing reads.
        return tuple("" if isinstance(part, str) else part for part in compiled._reduce())

    def rebuild(self, target_context: Any, payload: Any) -> Any:
        from numba.core.compiler import CompileResult

        return CompileResult._rebuild(target_context, *payload)

    def check_cachable(self, compiled: Any) -> bool:
        return not compiled.library.has_dynamic_globals and all(part.can_cache for part in compiled.lifted)


class _Store:
    """Files of one function, one for each signature and processor."""

    def __init__(self, function: Kernel, options: str) -> None:
        self.function, self.options = function, options

    def load(self, key: Any) -> Any:
        """Return what was saved under a key, or else what came with the package; None where there is nothing sound."""
        content = None
        if (folder := kept_in()) is not None:
            content = opened(read_private(self._path(folder, key)))
        if content is None and (folder := brought()) is not None:
            content = read_brought(self._path(folder, as_brought(key)))
        return None if content is None else pickle.loads(content)

    def save(self, key: Any, data: Any) -> None:
        """Write plain data under a key."""
        if (folder := kept_in()) is None:
            return
        write_private(self._path(folder, key), sealed(dumps(data)))

    def flush(self) -> None:
        """Nothing to do: nothing is buffered."""

    def _path(self, folder: Path, key: Any) -> Path:
        made_of = (source_digest(self.function), self.function.__module__, self.options, repr(key))
        name = hashlib.sha256("\n".join(made_of).encode("utf-8")).hexdigest()
        return folder / f"{self.function.__name__}-{name[:40]}"


@cache
def kept_in() -> Path | None:
    """The folder of compiled code; None, with one line on stderr, where no folder is safe to read from."""
    place = compiled_folder(numba.__version__, llvmlite.__version__)
    try:
        folder = private_folder(place)
    except NotPrivate as problem:
        with suppress(NotPrivate):
            if any(private_folder(place, writable=False).iterdir()):
                return place  # one that an administrator filled, or a read-only home: what is there is used
        if multiprocessing.parent_process() is None and brought() is None:
            logging.getLogger("thermicon").warning(
                "compiled code cannot be stored, so that every run compiles it again: %s", problem
            )
        return None
    remove_unused(folder.parent.glob("*/*"), STALE_S)
    return folder


def source_digest(function: Kernel) -> str:
    """Hash of everything a function is compiled from: its file, those of what it calls, and the constants used."""
    files: dict[str, bytes] = {}
    constants: list[str] = []
    open_, visited = [function], {function}
    while open_:
        current = open_.pop()
        path = current.__code__.co_filename
        if path not in files:
            files[path] = _file_digest(path) or current.__code__.co_code
        for name, value in _used(current):
            called = value.py_func if isinstance(value, Dispatcher) else value
            if isinstance(called, FunctionType):
                if called not in visited:
                    visited.add(called)
                    open_.append(called)
            elif isinstance(value, np.ndarray):
                constants.append(f"{name}={value.dtype}{value.shape}{value.tobytes()!r}")
            elif not isinstance(value, ModuleType):
                constants.append(f"{name}={value!r}")
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(files[path])
    digest.update("\n".join(sorted(constants)).encode("utf-8"))
    return digest.hexdigest()


@cache
def _file_digest(path: str) -> bytes | None:
    try:
        return hashlib.sha256(Path(path).read_bytes()).digest()
    except OSError:
        return None  # typed at a prompt


def _used(function: Any) -> Iterator[tuple[str, Any]]:
    """Names that a function takes from its module or its closure, with their values."""
    for cell_name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        yield cell_name, cell.cell_contents
    for name in sorted(_names(function.__code__)):
        if name in function.__globals__:
            yield name, function.__globals__[name]


def _names(code: CodeType) -> set[str]:
    inner = [_names(constant) for constant in code.co_consts if isinstance(constant, CodeType)]
    return {*code.co_names, *(name for names in inner for name in names)}
