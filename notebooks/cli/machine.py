"""Checks of what the machine gives: shipped files, cache folder, ngspice, and the Python that runs notebooks."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

from .packages import Finding, pip

KERNEL = "python3"
"""The kernel that the shipped notebooks name."""


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


def check_cache() -> Iterator[Finding]:
    """Look whether compiled code can be kept, and how much is kept."""
    from thermicon.icons.userfolder import NotPrivate, cache_folder, compiled_folder, private_folder

    cache = cache_folder()
    try:
        private_folder(compiled_folder(version("numba"), version("llvmlite")))
    except NotPrivate as problem:
        text = f"nothing can be kept, so that every run compiles its code again, about half a minute ({problem})"
        yield Finding("cache", "note", text, "set THERMICON_CACHE to a folder that only you can write to")
        return
    total = sum(path.lstat().st_size for path in cache.rglob("*") if path.is_file()) / 1e6
    yield Finding("cache", "ok", f"{cache}, writable, {total:.0f} MB; nothing but time is lost where it is deleted")


def check_ngspice() -> Iterator[Finding]:
    """Look for the one outside program that a user may want."""
    path = shutil.which("ngspice")
    if path is None:
        cure = "install ngspice from your system's packages or ngspice.sourceforge.io, or open netlists in LTspice"
        yield Finding("ngspice", "note", "not installed; only needed for running a netlist", cure)
    else:
        yield Finding("ngspice", "ok", f"{path}, for running a netlist")


def check_kernel() -> Iterator[Finding]:
    """Look which Python runs the notebooks: it has to be the one that thermicon is installed in."""
    from jupyter_client.kernelspec import KernelSpecManager

    kernel = KernelSpecManager().get_kernel_spec(KERNEL)
    python = str(kernel.argv[0]) if kernel.argv else ""
    cure = f"{sys.executable} -m ipykernel install --sys-prefix"
    if Path(python).name == python and python.startswith("python"):
        yield Finding("kernel", "ok", f"{KERNEL} runs the Python of the notebook server")  # by jupyter_client
    elif (path := shutil.which(python)) is None:
        yield Finding("kernel", "fault", f"{KERNEL} names {python}, which is not there ({kernel.resource_dir})", cure)
    elif environment(path) != environment(sys.executable):
        text = f"{KERNEL} runs {python} and not {sys.executable} ({kernel.resource_dir})"
        yield Finding("kernel", "fault", f"notebooks do not find thermicon: {text}", cure)
    else:
        yield Finding("kernel", "ok", f"{KERNEL} runs {python}")


def environment(python: str) -> Path:
    """Return the folder of an interpreter; links to another environment's interpreter are not followed."""
    path = Path(os.path.abspath(python))  # noqa: PTH100 - resolve() would leave the environment
    return path.parent.resolve()
