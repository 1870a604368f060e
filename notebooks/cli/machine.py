"""Checks of what the machine gives: the cache folder, cores and threads, the fonts of figures."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from importlib.metadata import version
from pathlib import Path

from .finding import Finding
from .packages import pip

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Variables that limit what numerical libraries use."""

LARGE_MB = 1000.0
"""A cache above this size is worth a line; the code of one version takes about 60 MB."""

WRITTEN = "ABC abc 0123 °μΔψ′²⁻–−×…"
"""Characters that figures are written with."""


def check_cache() -> Iterator[Finding]:
    """Look whether compiled code can be kept, how much is kept, and whether some of it is of other versions."""
    from thermicon.icons.userfolder import NotPrivate, cache_folder, compiled_folder, private_folder

    cache = cache_folder()
    current = compiled_folder(version("numba"), version("llvmlite"))
    try:
        private_folder(current)
    except NotPrivate as problem:
        text = f"nothing can be kept, so that every run compiles its code again, about half a minute ({problem})"
        yield Finding("cache", "note", text, "set THERMICON_CACHE to a folder that only you can write to")
        return
    total = sum(sizes(cache.rglob("*"))) / 1e6
    text = f"{cache}, writable, {total:.0f} MB"
    others = sorted(folder for folder in current.parent.iterdir() if folder.is_dir() and folder != current)
    stale = sum(size for folder in others for size in sizes(folder.rglob("*"))) / 1e6
    if total > LARGE_MB:
        yield Finding("cache", "note", text, f"delete {cache}, from which nothing is lost but time")
    elif others:
        text += f", {stale:.0f} MB of it compiled by other versions"
        yield Finding("cache", "note", text, f"delete {', '.join(map(str, others))}, or leave it: unused code goes")
    else:
        yield Finding("cache", "ok", text)


def check_threads() -> Iterator[Finding]:
    """Compare the cores of the machine with those that this process may use."""
    from thermicon.circuit.cores import available

    cores = os.cpu_count() or 1
    text = f"{available()} of {cores} cores may be used"
    limits = {name: os.environ[name] for name in THREADS if name in os.environ}
    odd = [name for name, value in limits.items() if not value.isdecimal() or int(value) < 1]
    if odd:
        name = odd[0]
        yield Finding("threads", "fault", f"{name}={limits[name]} is not a number of threads", f"unset {name}")
        return
    few = [f"{name}={value}" for name, value in limits.items() if int(value) < available()]
    if few:
        names = " ".join(each.partition("=")[0] for each in few)
        cure = f"unset {names}, unless the machine is shared"
        yield Finding("threads", "note", f"{text}, but {' and '.join(few)} allows fewer threads", cure)
    else:
        yield Finding("threads", "ok", text)


def check_fonts() -> Iterator[Finding]:
    """Look for the font of figures, for signs that it lacks, and for the folder of matplotlib's list of fonts."""
    import matplotlib
    from matplotlib.font_manager import FontProperties, findfont, get_font

    path = findfont(FontProperties())
    font = get_font(path)
    lacking = [sign for sign in WRITTEN if sign != " " and not font.get_char_index(ord(sign))]
    kept = Path(matplotlib.get_cachedir())
    if lacking:
        text = f"{font.family_name} ({path}), the font of figures, lacks {' '.join(lacking)}"
        cure = f"set font.family to DejaVu Sans in {matplotlib.matplotlib_fname()}"
        yield Finding("fonts", "note", text, cure)
    elif not os.access(kept, os.W_OK):
        text = f"matplotlib cannot write to {kept}, so that every figure looks for fonts first"
        yield Finding("fonts", "note", text, "set MPLCONFIGDIR to a folder that you can write to")
    else:
        yield Finding("fonts", "ok", f"figures use {font.family_name} ({path})")


def check_data() -> Iterator[Finding]:
    """Look whether every file that thermicon is shipped with is there, by its own record of what was installed."""
    from importlib.metadata import distribution

    files = distribution("thermicon").files or []
    shipped = [each for each in files if each.parts and each.parts[0] == "thermicon" and each.suffix != ".pyc"]
    missing = [str(each) for each in shipped if not Path(str(each.locate())).is_file()]
    if missing:
        text = f"{len(missing)} of {len(shipped)} shipped files are missing, such as {missing[0]}"
        yield Finding("files", "fault", text, f"{pip()} install --force-reinstall --no-deps thermicon")
    elif shipped:
        yield Finding("files", "ok", f"all {len(shipped)} shipped files are there")


def sizes(files: Iterable[Path]) -> Iterator[int]:
    """Yield the sizes of files in bytes, without those that another process removes meanwhile."""
    for path in files:
        try:
            status = path.lstat()
        except OSError:
            continue
        yield 0 if path.is_dir() else status.st_size
