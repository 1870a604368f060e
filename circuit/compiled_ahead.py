"""Machine code that a wheel brings along, so that an installation from it compiles nothing on its first run.

It was compiled for what x86 processors have had for ten years, not for the one it runs on. Where there is none for
this processor, Python and numba, as in a checkout, code is compiled when it is first needed.
"""

# mypy: disable-error-code="no-untyped-call,import-untyped"
# llvmlite's functions have no types.
from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import llvmlite.binding
import numba

from thermicon.icons.userfolder import compiled_folder, opened

LEVEL = "x86-64-v3"
"""The processor that code is compiled for; code for one processor alone is not measurably faster (docs, speed)."""
NEEDS = ("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")
"""What that level has beyond its forerunner, in LLVM's words."""


@cache
def brought() -> Path | None:
    """The folder of the code that came with the package; None where none came that can run here."""
    folder = Path(__file__).parent / "ahead" / compiled_folder(numba.__version__, llvmlite.__version__).name
    if not folder.is_dir():
        return None
    can = llvmlite.binding.get_host_cpu_features()
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
