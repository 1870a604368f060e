"""``thermicon export --verify DIR``: whether the files of an export are as they were exported."""

from __future__ import annotations

import stat
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from thermicon.circuit.delivery.export_folder import before_of
from thermicon.icons.atomic import OutputError

from ..messages import BAD_INPUT, note
from ..report.tables import show, table

if TYPE_CHECKING:
    from thermicon.circuit.delivery.verify import Verification

LARGEST = 2**30
"""Bytes; a larger file is no drive of any format's device, and is not read."""


def verify_folder(folder: Path) -> None:
    """Check the files of an export folder and show which belong together; exit code 1 if some do not."""
    from thermicon.circuit.delivery.verify import verify

    files, others = _read(folder)
    found = verify(files)
    if found.claims:
        _show(found)
    for name, what in others:
        note(f"note: {_clean(name)} is a {what} and was not checked")
    for finding in found.findings:
        if finding.kind == "told":
            note(f"note: {_clean(str(finding))}")
    wrong = [finding for finding in found.findings if finding.kind == "wrong"]
    for finding in wrong:
        note(f"wrong: {_clean(str(finding))}", always=True)
    if wrong:
        note(f"{folder}: {len(wrong)} {'thing does' if len(wrong) == 1 else 'things do'} not belong together")
        raise typer.Exit(BAD_INPUT)
    drives = (
        "1 drive and its sidecar belong"
        if len(found.claims) == 1
        else f"{len(found.claims)} drives and their sidecars belong"
    )
    show(f"{folder}: {drives} together")


def _read(folder: Path) -> tuple[dict[str, bytes], list[tuple[str, str]]]:
    """Plain files of a folder by name, and what else is in it."""
    if not folder.is_dir():
        if folder.exists():
            raise OutputError(f"cannot verify {folder}: it is a file; give the folder of an export")
        left = before_of(folder)
        more = f"; an export was interrupted, and the folder as it was is {left}" if left.exists() else ""
        raise OutputError(f"cannot verify {folder}: there is no such folder{more}")
    files, others = {}, []
    for path in sorted(folder.iterdir()):
        state = path.lstat()
        if not stat.S_ISREG(state.st_mode):
            others.append((path.name, "link" if path.is_symlink() else "folder" if path.is_dir() else "device"))
        elif state.st_size > LARGEST:
            others.append((path.name, f"file of {state.st_size / 2**30:.1f} GiB"))
        else:
            files[path.name] = path.read_bytes()
    return files, others


def _show(found: Verification) -> None:
    rows = table("drive", "sidecar", "belongs", names=("drive", "sidecar"))
    for sidecar, claims in found.claims.items():
        rows.add_row(_clean(claims.drive), _clean(sidecar), "yes" if found.belongs(sidecar) else "NO")
    show(rows)


def _clean(text: str) -> str:
    """Text of files without what could move a terminal's cursor."""
    return "".join(each if each.isprintable() else "?" for each in text)
