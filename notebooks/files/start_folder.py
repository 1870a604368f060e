"""Where a page may write: below the folder that it was started with, whatever a person (or a page) types."""

from __future__ import annotations

import os
from pathlib import Path

from thermicon.icons.atomic import OutputError

VARIABLE = "THERMICON_PAGE_FOLDER"
"""Set for the kernels of ``thermicon lab --page``; a notebook's own kernel, in which anything can be run, has none."""


FILE, RIG, OBSERVER = "THERMICON_PAGE_FILE", "THERMICON_PAGE_RIG", "THERMICON_PAGE_OBSERVER"
"""Set for the kernels of ``thermicon lab --page FILE --rig RIG --observer FILE``: what a workbench of no arguments is
made with."""


def started_with() -> str | None:
    """Return the cue file that the page was started with; None for none."""
    return os.environ.get(FILE) or None


def started_rig() -> str:
    """Return the rig that the page was started with, or the usual one.

    >>> started_rig()
    'thenar'
    """
    return os.environ.get(RIG) or "thenar"


def started_observer() -> str | None:
    """Return the observer file that the page was started with; None: the shipped observer."""
    return os.environ.get(OBSERVER) or None


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
