"""Machine code that a wheel brings along, so that an installation from it compiles nothing on its first run.

It was compiled for what x86 processors have had for ten years, not for the one it runs on. Where there is none for
this processor, Python and numba, as in a checkout, code is compiled when it is first needed. It is part of the package
and trusted as its sources are; `.ci/wheel` makes it.
"""

# mypy: disable-error-code="no-untyped-call,import-untyped,attr-defined"
# llvmlite's functions have no types, and numba names its settings only when it is imported.
from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import llvmlite.binding
import numba

from thermicon.icons.userfolder import compiled_folder, opened

LEVEL = "x86-64-v3"
"""The processor that code is compiled for; a ranking takes 2 % longer than with code for the very processor."""
NEEDS = ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "popcnt", "sse4.2", "xsave")
"""What a processor of that level can do, in LLVM's words; what these need themselves is left out."""


@cache
def brought() -> Path | None:
    """The folder of the code that came with the package; None where none came that can run here.

    None too where numba was told to compile for another processor (NUMBA_CPU_NAME, NUMBA_CPU_FEATURES).
    """
    folder = Path(__file__).parent / "ahead" / compiled_folder(numba.__version__, llvmlite.__version__).name
    if not folder.is_dir() or (numba.config.CPU_NAME or LEVEL) != LEVEL or numba.config.CPU_FEATURES:
        return None
    try:
        can = llvmlite.binding.get_host_cpu_features()
    except RuntimeError:  # LLVM does not know this processor
        return None
    return folder if all(can.get(need) for need in NEEDS) else None


def as_brought(key: Any) -> Any:
    """The key under which numba, told to compile for LEVEL, keeps what it keeps for this processor under `key`."""
    signature, (system, _, _), code = key
    return signature, (system, LEVEL, ""), code


def read_brought(path: Path) -> bytes | None:
    """Content of a file that came with the package; None where there is none, or it is damaged."""
    try:
        return opened(path.read_bytes())
    except OSError:
        return None
