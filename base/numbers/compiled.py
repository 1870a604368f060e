"""Compiled functions with a private cache of machine code.

numba's cache does not notice a change in another file than a function's own, and holds pickles: whoever can write it
can run code as the user who reads it.
"""

# mypy: disable-error-code="attr-defined,import-untyped"
# numba names its settings only when it is imported, and llvmlite has no types.
import hashlib
import logging
import multiprocessing
import os
import sys
import threading
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy as np
import scipy

from ..files.cache_folder import NotPrivate, compiled_folder, private_folder, remove_unused

STALE_S = 90 * 24 * 3600.0
"""Machine code that was not used for this long is removed."""
SOURCES = (
    *("base/numbers/compiled.py", "base/numbers/vector_math.py", "circuit/rig/module.py", "circuit/safety/*_kernel.py"),
    *("circuit/safety/quantities.py", "circuit/solver/modes.py", "circuit/solver/kernel*.py"),
    *("circuit/solver/network.py", "circuit/solver/plates.py"),
    *("perception/kernels/*.py", "perception/selection/subset_identification.py"),
)
"""All files that hold compiled functions, or constants that these use."""

Kernel = Callable[..., Any]
_DECORATING = threading.Lock()


def kernel(**options: Any) -> Callable[[Kernel], Any]:
    """Return a decorator that compiles a function with options of `numba.njit`, and keeps its machine code safely."""

    def decorate(function: Kernel) -> Any:
        if (folder := kept_in()) is None:
            return numba.njit(**options)(function)
        # numba reads the setting as it decorates: other users of numba in this process keep theirs.
        with _DECORATING:
            theirs, numba.config.CACHE_DIR = numba.config.CACHE_DIR, str(folder)
            try:
                return numba.njit(cache=True, **options)(function)
            finally:
                numba.config.CACHE_DIR = theirs

    return decorate


@cache
def kept_in() -> Path | None:
    """The folder of machine code; None, with one line on stderr, where no folder is safe to read from."""
    root = Path(__file__).parents[2]
    try:
        if not str(root).isprintable():  # numba hashes the paths of sources
            raise NotPrivate(f"{str(root)!a} has letters that this locale cannot read; set PYTHONUTF8=1")
        versions = compiled_folder(numba.__version__, llvmlite.__version__)
        folder = private_folder(versions / digest_of(path for one in SOURCES for path in root.glob(one)))
        # Others may not even enter: the modes of numba's own files depend on the umask.
        if sys.platform != "win32" and (
            folder.stat().st_mode & 0o077 or any(path.lstat().st_uid != os.geteuid() for path in folder.iterdir())
        ):
            raise NotPrivate(f"{folder} is open to others, or holds what others wrote; delete it")
    except NotPrivate as problem:
        if multiprocessing.parent_process() is None:
            logging.getLogger("thermicon").warning(
                "compiled code cannot be stored, so that every run compiles it again: %s", problem
            )
        return None
    if not any(folder.iterdir()):  # only a new version looks for stale ones, which takes a second where there are many
        remove_unused((path for path in versions.parent.glob("*/*/*/*") if path.is_file()), STALE_S)
    return folder


def digest_of(sources: Iterable[Path]) -> str:
    """Hash of source files, and of the versions of what constants are computed with."""
    digest = hashlib.sha256(f"{np.__version__} {scipy.__version__}".encode())
    for path in sorted(sources):
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:40]
