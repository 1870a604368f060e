"""Checks of the names of output files before long work starts."""

import os
from collections.abc import Sequence
from pathlib import Path

from thermicon.base.files.atomic import OutputError, check_inside

STDOUT = Path("-")
TRACE_SUFFIXES = (".csv", ".parquet")
NETLIST_SUFFIXES = (".cir", ".net", ".sp")
FIGURE_SUFFIXES = (".png", ".pdf", ".svg")


def check_output(path: Path | None, suffixes: Sequence[str], what: str) -> None:
    """Fail now, with the reason, where writing ``path`` would fail later.

    ``suffixes`` are the file types on offer (empty: any), ``what`` names the thing written. ``-`` and None are fine.
    """
    if path is None or path == STDOUT:
        return
    if path.is_dir():
        raise OutputError(f"cannot write {path}: it is a folder; give the name of a file")
    if suffixes and path.suffix.lower() not in suffixes:
        offer = " or ".join(suffixes)
        found = f"not {path.suffix}" if path.suffix else "and this name has no ending"
        raise OutputError(f"cannot write {path}: {what} is written as {offer}, {found}")
    if path.suffix.lower() == ".parquet":
        from thermicon.base.files.inputs import require_pyarrow

        require_pyarrow(f"cannot write {path}", OutputError)
    check_inside(path, path.parent)
    if path.exists() and not os.access(path, os.W_OK):
        raise OutputError(f"cannot write {path}: the file exists and is read-only")


def check_separate(inputs: Sequence[str | Path], outputs: Sequence[Path | None]) -> None:
    """Fail where an output is a file that the command reads, or two outputs are the same file."""
    seen = {Path(name).resolve(): "is read by this command" for name in inputs if Path(name).is_file()}
    for path in outputs:
        if path is None or path == STDOUT:
            continue
        place = path.resolve()
        if place in seen:
            raise OutputError(f"cannot write {path}: the file {seen[place]}; give another name")
        seen[place] = "is another output of this command"
