"""An export folder: every file of an export appears in it at once, or none does, whenever the program is ended.

Beside the folder NAME stands `.NAME.thermicon-part` while an export writes there: the new state of the whole folder is
built in it and then put in the place of the old one by one rename or exchange.
"""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import stat
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

from .belonging import claims_in, not_ours, replaced_with
from .locking import lock
from .outputs import OutputError, check_folder, interrupts_wait, kept_text
from .swapping import exchange

CURE = "give a folder of its own, such as -o drives"
STAGE, OWNER, NEW, OLD = ".{}.thermicon-part", "owner", "new", "old"
HOW = "--force replaces it"
MOST_TRIES = 100
"""How often a stage that others remove at the same time is made again."""


def check_export_folder(folder: Path) -> Path:
    """Return the folder's true path; OutputError where an export could not have it for its own.

    It may be missing, empty, or hold plain files. The folder beside which it stands must be writable.
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
    if goal.exists():
        _listed(goal, folder)
    return goal


def check_names_free(names: Collection[str], folder: Path, replace: bool = False, how: str = HOW) -> None:
    """Raise OutputError where files of these names, which an export will write, are in its folder and have to stay.

    What a file holds is not known yet: of what may be replaced, only sidecars that are none are refused here, and
    `publish` checks everything.
    """
    goal = check_export_folder(folder)
    there = _listed(goal, folder) if goal.exists() else {}
    _keep(names, there, folder, replace, how)
    sidecars = {name: goal / name for name in names if name in there and name.endswith(".json")}
    for name in sorted(set(sidecars) - set(claims_in(sidecars))):
        raise OutputError(not_ours(folder / name))


def publish(files: Mapping[str, bytes], folder: Path, replace: bool = False, how: str = HOW) -> tuple[str, ...]:
    """Put the files of an export into its folder, all or none, and return the names of older ones that had to go.

    Other files of the folder stay. What is there is replaced only with ``replace``, and only what an export wrote;
    ``how`` tells a person how to ask for that. An older drive goes when its sidecar is replaced by that of another.
    Raises OutputError, with the folder as it was, where this cannot be.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as made:
    ...     _ = publish({"a.json": b"{}", "a.csv": b"1"}, Path(made) / "drives")
    ...     sorted(path.name for path in (Path(made) / "drives").iterdir())
    ['a.csv', 'a.json']
    """
    try:
        goal = check_export_folder(folder)
        with interrupts_wait() as stop, _stage(goal, folder) as stage:
            there = _listed(goal, folder) if goal.exists() else {}
            _keep(files, there, folder, replace, how)
            gone = replaced_with(files, {name: goal / name for name in there}, folder)
            staying = [name for name in there if name not in files and name not in gone]
            _build(stage / NEW, files, goal, staying, stop)
            if there:
                exchange(stage / NEW, goal, stage / OLD)
                _adopt(stage, goal, there, files)
            else:
                _place(stage / NEW, goal)
            _flush(goal.parent)
    except OSError as error:
        raise OutputError(f"cannot write into {folder}: {error.strerror or error}") from error
    return gone


def _resolved(folder: Path) -> Path:
    try:
        return folder.resolve()
    except (OSError, RuntimeError) as error:
        raise OutputError(f"cannot write {folder}: {getattr(error, 'strerror', None) or 'a loop of links'}") from None


def _listed(goal: Path, folder: Path) -> dict[str, tuple[int, int]]:
    """Names in a folder of plain files, each with device and inode; OutputError where anything else is in it."""
    found = {}
    with os.scandir(goal) as entries:
        for entry in entries:
            held = entry.stat(follow_symlinks=False)
            if not stat.S_ISREG(held.st_mode):
                kind = "link" if entry.is_symlink() else "folder" if entry.is_dir() else "device or pipe"
                raise OutputError(
                    f"cannot export into {folder}: it contains a {kind}, {entry.name}, and exports replace their "
                    f"folder as a whole; {CURE}"
                )
            found[entry.name] = (held.st_dev, held.st_ino)
    return found


def _keep(files: Collection[str], there: Collection[str], folder: Path, replace: bool, how: str) -> None:
    """Raise OutputError where a file of the export is there already, unless it may be replaced."""
    taken = [name for name in files if name in there]
    if taken and not replace:
        raise OutputError(f"{kept_text(folder, taken)}; {how}")


@contextmanager
def _stage(goal: Path, folder: Path) -> Iterator[Path]:
    """The folder beside an export folder in which its next state is built, held by this process alone.

    What an export that was ended has left is put right first. When the block ends, nothing of it is left.
    """
    stage = goal.with_name(STAGE.format(goal.name))
    for _ in range(MOST_TRIES):
        with contextlib.suppress(FileExistsError):
            stage.mkdir()
        _check_stage(stage, folder)
        with ExitStack() as held:
            try:
                owner = held.enter_context(lock(stage / OWNER))
            except FileNotFoundError:
                continue  # whoever had it has just removed it
            if not owner.mine:
                raise OutputError(
                    f"another export is writing into {folder}{owner.words}; wait for its end, or give another folder"
                )
            _recover(stage, goal)
            try:
                yield stage
            finally:
                with contextlib.suppress(OSError):
                    _recover(stage, goal)  # what cannot be tidied up now is by the next export
                owner.remove()
                with contextlib.suppress(OSError):
                    stage.rmdir()  # not empty: the next export has taken it over
            return
    raise OutputError(f"cannot write into {folder}: another process keeps replacing {stage.name}; try again")


def _check_stage(stage: Path, folder: Path) -> None:
    """Raise OutputError where what stands under the stage's name is nothing that an export of this person made."""
    try:
        held = stage.lstat()
    except FileNotFoundError:
        return
    if not stat.S_ISDIR(held.st_mode) or (os.name == "posix" and held.st_uid != os.geteuid()):
        raise OutputError(
            f"cannot write into {folder}: {stage} is in the way and not yours; have it removed, or give another folder"
        )


def _recover(stage: Path, goal: Path) -> None:
    """Finish or undo what was begun: the old state goes back where no new one has taken its place."""
    if (stage / OLD).exists() and not goal.exists():
        (stage / OLD).rename(goal)
    for left in (stage / NEW, stage / OLD):
        if left.exists():
            shutil.rmtree(left)


def _build(
    new: Path, files: Mapping[str, bytes], goal: Path, staying: Collection[str], stop: Callable[[], None]
) -> None:
    """Make the next state of a folder: what stays as links to the same files, what is new flushed to the disk.

    ``stop`` is called after every file, and may end it.
    """
    new.mkdir()
    for name in staying:
        _link(goal / name, new / name)
        stop()
    for name, content in files.items():
        with (new / name).open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        stop()
    if goal.exists():
        new.chmod(stat.S_IMODE(goal.stat().st_mode))
    _flush(new)


def _link(source: Path, target: Path) -> None:
    try:
        os.link(source, target, follow_symlinks=False)
    except OSError as error:
        if error.errno not in (errno.EPERM, errno.EMLINK, errno.ENOTSUP, errno.ENOSYS, errno.EACCES):
            raise
        shutil.copy2(source, target, follow_symlinks=False)  # a disk without hard links
        with target.open("rb+") as file:
            os.fsync(file.fileno())


def _place(new: Path, goal: Path) -> None:
    """Rename a folder to a name that is free or that of an empty folder; in one step, except on Windows."""
    if os.name == "nt" and goal.exists():
        goal.rmdir()
    new.rename(goal)


def _adopt(stage: Path, goal: Path, there: Mapping[str, tuple[int, int]], files: Collection[str]) -> None:
    """Take what somebody put into the old folder while its next state was built into the new one."""
    old = next(place for place in (stage / OLD, stage / NEW) if place.exists())
    with os.scandir(old) as entries:
        held = {entry.name: entry.stat(follow_symlinks=False) for entry in entries}
    for name, state in held.items():
        if there.get(name) != (state.st_dev, state.st_ino) and name not in files:
            (old / name).replace(goal / name)


def _flush(folder: Path) -> None:
    """Have a folder's names on the disk; some systems cannot, and need not."""
    with contextlib.suppress(OSError):
        place = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(place)
        finally:
            os.close(place)
