"""Checks of what the notebooks and the workbench need of Jupyter: widgets in the page, and the right Python."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from .finding import Finding
from .packages import installed_version, pip

WIDGETS = {"@jupyter-widgets/jupyterlab-manager": "jupyterlab_widgets", "anywidget": "anywidget"}
"""Extensions of JupyterLab that show widgets, and the distributions that bring them."""

KERNEL = "python3"
"""The kernel that the shipped notebooks name."""


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
