"""An export folder in which all files appear at once.

An export owns its folder NAME. The next one is built as `.NAME.thermicon-part` beside it; when it is complete, NAME is
renamed to NAME.before and the new folder to NAME.
"""

import contextlib
import json
import os
import shutil
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from thermicon.base.files.atomic import MARK, OutputError, check_folder, kept_text, stopped_cleanly

CURE = "give a folder of its own"
HOW = "replace=True replaces the folder"


def check_export_folder(folder: Path, replace: bool = False, how: str = HOW) -> Path:
    """Return the folder's true path; OutputError where an export could not have it for its own.

    It may be missing or empty, and with ``replace`` hold what an export wrote and nothing else; ``how`` tells a person
    how to ask for that. The folder beside which it stands must be writable.
    """
    goal = _resolved(folder)
    check_folder(folder)
    if goal.parent == goal or os.path.ismount(goal):
        raise OutputError(f"cannot export into {folder}: it is the root of a disk; {CURE}")
    if goal == _resolved(Path.cwd()):
        raise OutputError(f"cannot export into {folder}: it is the folder you are in; {CURE}")
    with contextlib.suppress(RuntimeError):
        if goal == _resolved(Path.home()):
            raise OutputError(f"cannot export into {folder}: it is your home folder; {CURE}")
    if not os.access(goal.parent, os.W_OK | os.X_OK):
        raise OutputError(
            f"cannot export into {folder}: its files are prepared beside it, and {goal.parent} is not writable for "
            f"you; give a folder inside one that is"
        )
    there = _listed(goal)
    if there:
        _check_owned(goal)
        _check_owned(before_of(goal))
        if not replace:
            raise OutputError(f"{kept_text(folder, there)}; {how}")
    return goal


def before_of(folder: Path) -> Path:
    """The path of the state of a folder that an export has replaced."""
    return folder.with_name(f"{folder.name}.before")


def publish(files: Mapping[str, bytes], folder: Path, replace: bool = False, how: str = HOW) -> Path | None:
    """Make the files of an export the content of its folder, all or none; return where its state before stands now.

    A folder that is not empty is replaced only with ``replace``; ``how`` tells a person how to ask for that. None where
    there was nothing before. Raises OutputError, with the folder as it was, where this cannot be.
    """
    try:
        goal = check_export_folder(folder, replace, how)
        with stopped_cleanly(), _beside(goal, folder) as new:
            check_export_folder(folder, replace, how)  # another export may have been quicker
            for name, content in files.items():
                with (new / name).open("xb") as file:
                    file.write(content)
                    file.flush()
                    os.fsync(file.fileno())
            return _put(new, goal)
    except OSError as error:
        raise OutputError(f"cannot write into {folder}: {error.strerror or error}") from error


def _resolved(folder: Path) -> Path:
    try:
        return folder.resolve()
    except (OSError, RuntimeError) as error:
        raise OutputError(f"cannot write {folder}: {getattr(error, 'strerror', None) or 'a loop of links'}") from None


def _listed(folder: Path) -> list[str]:
    """Names in a folder of plain files, none where it is missing; OutputError where anything else is in it."""
    if not folder.exists():
        return []
    for path in folder.iterdir():
        if not stat.S_ISREG(path.lstat().st_mode):
            kind = "link" if path.is_symlink() else "folder" if path.is_dir() else "device or pipe"
            raise OutputError(
                f"cannot export into {folder}: it contains a {kind}, {path.name}, and exports replace their folder as "
                f"a whole; {CURE}"
            )
    return sorted(path.name for path in folder.iterdir())


def _check_owned(folder: Path) -> None:
    """Raise OutputError where a folder that goes holds a file that no export wrote."""
    known: set[str] = set()
    for path in folder.glob("*.json"):
        claims = claims_of(path.read_bytes()) if path.stat().st_size <= LONGEST else None
        known |= {path.name, *claims.digests} if claims is not None else set()
    for name in _listed(folder):
        if name not in known:
            raise OutputError(
                f"{folder / name} was not written by thermicon, since no sidecar lists it, and is kept; move it away, "
                f"or {CURE}"
            )


@contextmanager
def _beside(goal: Path, folder: Path) -> Iterator[Path]:
    """An empty folder beside an export folder that only one export has, gone when the block fails."""
    new = goal.with_name(f".{goal.name}.{MARK}")
    try:
        new.mkdir()
    except FileExistsError:
        raise OutputError(
            f"another export is writing into {folder}, or was killed there; wait for its end, or delete {new}"
        ) from None
    try:
        if goal.exists():
            new.chmod(stat.S_IMODE(goal.stat().st_mode))
        yield new
    except BaseException:
        shutil.rmtree(new, ignore_errors=True)
        raise


def _put(new: Path, goal: Path) -> Path | None:
    """Put a complete folder into the place of another one, which stays beside it unless it is empty."""
    _flush(new)
    before = before_of(goal) if _listed(goal) else None
    if before is None:
        if os.name == "nt" and goal.exists():
            goal.rmdir()  # elsewhere a folder may be renamed to the name of an empty one
        new.rename(goal)
    else:
        if before.exists():
            # Sidecars last: what is left of a removal that is ended still counts as an export's.
            for path in sorted(before.iterdir(), key=lambda each: each.suffix == ".json"):
                path.unlink()
            before.rmdir()
        try:
            goal.rename(before)
            new.rename(goal)
        except BaseException:
            if not goal.exists():
                before.rename(goal)
            raise
    _flush(goal.parent)
    return before


def _flush(folder: Path) -> None:
    """Have a folder's names on the disk; some systems cannot, and need not."""
    with contextlib.suppress(OSError):
        place = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(place)
        finally:
            os.close(place)


LONGEST = 64 * 2**20
"""Bytes; nothing longer is taken for a sidecar."""


@dataclass(frozen=True, slots=True)
class Claims:
    """The drive that a sidecar describes, and the digests (SHA-256) of it and of the files of its set, by name.

    A digest is empty where the sidecar holds none.
    """

    drive: str
    digests: Mapping[str, str]


def claims_of(content: bytes) -> Claims | None:
    """Return what a file claims as a sidecar; None where it is not a sidecar."""
    document = table_of(content)
    if document is None or not isinstance(document.get("file"), str) or "thermicon" not in document:
        return None
    shared = document.get("set_files")
    named = {str(name): str(digest) for name, digest in shared.items()} if isinstance(shared, dict) else {}
    return Claims(document["file"], {document["file"]: str(document.get("drive_sha256") or ""), **named})


def table_of(content: bytes) -> dict[str, Any] | None:
    """Return the JSON object that a file holds, None where it holds none."""
    if len(content) > LONGEST:
        return None
    try:
        document = json.loads(content)
        json.dumps(document, ensure_ascii=False).encode("utf-8")  # half characters and endless nesting are no text
    except (ValueError, RecursionError):
        return None
    return document if isinstance(document, dict) else None
