"""Checks of what the machine gives: cache, threads, fonts, shipped files, and what notebooks need of Jupyter."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Iterable, Iterator, Sequence
from importlib.metadata import version
from pathlib import Path

from .finding import Finding
from .packages import installed_version, pip

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Variables that limit what numerical libraries use."""

LARGE_MB = 1000.0
"""A cache above this size is worth a line; the code of one version takes about 60 MB."""

WRITTEN = "ABC abc 0123 °μΔψ′²⁻–−×…"
"""Characters that figures are written with."""

WIDGETS = {"@jupyter-widgets/jupyterlab-manager": "jupyterlab_widgets", "anywidget": "anywidget"}
"""Extensions of JupyterLab that show widgets, and the distributions that bring them."""

KERNEL = "python3"
"""The kernel that the shipped notebooks name."""


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


def check_widgets() -> Iterator[Finding]:
    """Look whether JupyterLab finds the extensions that show widgets, in the versions that are installed."""
    from jupyter_core.paths import jupyter_path

    folders = [Path(each) for each in jupyter_path("labextensions")]
    faults = [fault for name, package in WIDGETS.items() if (fault := misfit(name, package, folders))]
    yield from faults
    if not faults:
        names = ("jupyterlab", "ipywidgets", "jupyterlab_widgets", "anywidget")
        yield Finding("widgets", "ok", ", ".join(f"{name} {installed_version(name)}" for name in names))


def misfit(name: str, package: str, folders: Sequence[Path]) -> Finding | None:
    """Return what is wrong with an extension of JupyterLab; None where it is the installed one and not turned off."""
    cure = f"{pip()} install --force-reinstall --no-deps {package}"
    file = next((path for folder in folders if (path := folder / name / "package.json").is_file()), None)
    if file is None:
        return Finding("widgets", "fault", f"JupyterLab does not find {name}, which shows the workbench", cure)
    there = str(json.loads(file.read_text("utf-8")).get("version"))
    if not same_release(there, own := installed_version(package)):
        text = f"JupyterLab finds {name} {there} in {file.parent}, but {package} {own} is installed"
        return Finding("widgets", "fault", text, f"delete {file.parent}, or {cure}")
    return None


def same_release(there: str, own: str | None) -> bool:
    """Whether an extension belongs to an installed package: the first number, and the second below 1.0, agree.

    The extension of ipywidgets counts differently: 5.x goes with jupyterlab_widgets 3.x.

    >>> same_release("0.9.18", "0.9.18"), same_release("0.8.0", "0.9.18"), same_release("5.0.15", "3.0.15")
    (True, False, True)
    """
    if own is None:
        return False
    pairs = {"5": "3"}
    major, minor = there.split(".")[:2]
    own_major, own_minor = own.split(".")[:2]
    if major == own_major:
        return major != "0" or minor == own_minor
    return pairs.get(major) == own_major


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
