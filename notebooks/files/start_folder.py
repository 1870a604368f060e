"""Where a page may write: below the folder that it was started with, whatever a person (or a page) types."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TypeVar

from .outputs import OutputError

VARIABLE = "THERMICON_PAGE_FOLDER"
"""Set for the kernels of ``thermicon lab --page``; a notebook's own kernel, in which anything can be run, has none."""


FILE, RIG = "THERMICON_PAGE_FILE", "THERMICON_PAGE_RIG"
"""Set for the kernels of ``thermicon lab --page FILE --rig RIG``: what a workbench shows that is asked for nothing."""

Source = TypeVar("Source")
OwnRig = TypeVar("OwnRig")


def started_with(source: Source | None, rig: OwnRig | None) -> tuple[Source | str | None, OwnRig | str]:
    """Return what a workbench shows, and on which rig: as given, else as the page was started, else the usual.

    >>> started_with("alerts.cue", None)
    ('alerts.cue', 'thenar')
    """
    shown = os.environ.get(FILE) if source is None else source
    return shown, (os.environ.get(RIG) or "thenar") if rig is None else rig


def below_start(folder: Path) -> Path:
    """Return a folder to write into, with links followed; OutputError where it is not below that of the page.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as start:
    ...     os.environ[VARIABLE] = start
    ...     try:
    ...         below_start(Path(start) / ".." / "elsewhere")
    ...     except OutputError as refused:
    ...         str(refused).partition(";")[0].endswith("is outside the folder of this page")
    ...     finally:
    ...         del os.environ[VARIABLE]
    True
    """
    start = os.environ.get(VARIABLE)
    if start is None:
        return folder
    try:
        root = Path(start).resolve(strict=True)
        goal = (root / folder).resolve()
    except (OSError, RuntimeError, ValueError):
        raise OutputError(f"{folder} is not a usable folder; give the name of one below {start}") from None
    if not goal.is_relative_to(root):
        raise OutputError(
            f"{folder} is outside the folder of this page; it writes only below {root}, into a folder such as drives"
        )
    return goal
