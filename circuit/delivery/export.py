"""Export in one call: icons, a rig, a device and a format give the bytes of files, or the reasons against it."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from thermicon.icons import Icon
from thermicon.icons.number_text import count_of

from ..inputs import InputError
from ..rig.rig import Rig
from .device import Device
from .formats import Format, load_format
from .pack import pack
from .prepare import Prepared, prepare_set
from .refusal import Refusal


class ExportError(InputError):
    """An export that was refused, or a folder that cannot take one; the text says why and what to change.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "notes.txt").write_text("mine")
    ...     try:
    ...         export(load_library("six-icons")["warming-step"], "tcs2", format="tcs2-protocol-ini", folder=folder)
    ...     except ExportError as problem:
    ...         print("refused:", problem)
    refused: ... is not an empty folder; ...
    """


@dataclass(frozen=True, slots=True)
class Export:
    """The result of `export`.

    Attributes
    ----------
    rig_name, device_name, format_name
        Names of the rig, the device and the file format.
    prepared
        What the device delivers of each icon, with its verdict.
    refused
        Every reason against writing, with the name of its icon; a forced export has reasons and files.
    files
        Bytes by file name; empty where an icon was refused.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> result = export(load_library("six-icons")["warming-step"], "tcs2", format="tcs2-protocol-ini")
    >>> result.refused, sorted(result.files)
    ((), ['warming-step.json', 'warming-step.protocol.ini'])
    """

    rig_name: str
    device_name: str
    format_name: str
    prepared: tuple[Prepared, ...]
    refused: tuple[tuple[str, Refusal], ...]
    files: Mapping[str, bytes] = field(default_factory=dict)

    def __repr__(self) -> str:
        count = count_of(len(self.prepared), "icon")
        size = sum(len(content) for content in self.files.values())
        summary = f"REFUSED: {count_of(len(self.refused), 'cause')}"
        if self.files:
            summary = f"{count_of(len(self.files), 'file')}, {size / 1e3:.1f} kB"
        return f"Export({count} on {self.rig_name} for {self.device_name} as {self.format_name}: {summary})"

    @property
    def warnings(self) -> tuple[str, ...]:
        """What to know of the drives before they are played, each with the name of its icon."""
        return tuple(
            f"{prepared.delivery.icon.name}: {text}" for prepared in self.prepared for text in prepared.warnings
        )


def export(
    icons: Icon | Iterable[Icon],
    rig: Rig | str,
    device: Device | str | None = None,
    format: Format | str = "csv",
    *,
    tail_s: float = 0.0,
    pause_s: float | None = None,
    force: bool = False,
    folder: str | Path | None = None,
) -> Export:
    """Prepare icons for a device, judge them for safety in the worst case, and return the files that play them.

    Nothing is written unless `folder` is given, and nothing unsafe is ever packed or written.

    Parameters
    ----------
    icons
        One icon, or those of a set, which may later be played in any order.
    rig
        The rig, or the name or file of one.
    device
        The device that plays the drives, or the name or file of one; None: the usual device of the format.
    format
        The file format or its name, see `thermicon.circuit.delivery.formats`.
    tail_s
        Time in s that is played after the last corner of each icon.
    pause_s
        Pause in s between plays that the verdict assumes; None: the time that the rig needs to recover.
    force
        Whether to pack icons that miss their target or lose too much; their sidecars say so. Unsafe icons stay refused.
    folder
        A folder to write the files into; it must not exist or be empty, and gets all files or none.

    Returns
    -------
    Export
        The files as bytes by name. Without files where an icon was refused: then `refused` says why.

    Raises
    ------
    ExportError
        Where a folder is given and an icon is refused, or the folder is not empty or cannot be written.
    InputError
        Where the device or format cannot play an icon at all, or the rig cannot hold its baseline.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> export(load_library("six-icons")["warming-step"], "thenar", "dac-16")
    Export(1 icon on thenar for dac-16 as csv: 2 files, ... kB)

    """
    form = load_format(format) if isinstance(format, str) else format
    played = device if isinstance(device, Device) else Device.load(device or form.device)
    on = rig if isinstance(rig, Rig) else Rig.load(rig)
    chosen = [icons] if isinstance(icons, Icon) else list(icons)
    if not chosen:
        raise ExportError("there is no icon to export; give at least one")
    goal = None if folder is None else _free(Path(folder))
    ready = prepare_set(chosen, on, played, form, tail_s=tail_s, pause_s=pause_s)
    refused = tuple((cue.delivery.icon.name, refusal) for cue in ready for refusal in cue.refusals)
    barred = [(name, refusal) for name, refusal in refused if not (force and refusal.forcible)]
    files = {} if barred else pack(ready, form)
    if goal is not None:
        if barred:
            raise ExportError("\n".join(f"{name}: {refusal}" for name, refusal in barred))
        _write(files, goal)
    return Export(on.name, played.name, form.name, ready, refused, files)


def _free(folder: Path) -> Path:
    """The folder, if it is missing or empty; ExportError otherwise."""
    try:
        taken = folder.exists() and (not folder.is_dir() or any(folder.iterdir()))
    except OSError as problem:
        raise ExportError(f"{folder}: cannot be read ({problem.strerror or problem}); choose another folder") from None
    if taken:
        raise ExportError(
            f"{folder}: is not an empty folder; give one that is new or empty, or use the command thermicon export, "
            f"which replaces an earlier export"
        )
    return folder.absolute()


def _write(files: Mapping[str, bytes], goal: Path) -> None:
    """Write into a new folder beside the goal and rename it, so that the goal has all files or none."""
    try:
        goal.parent.mkdir(parents=True, exist_ok=True)
        draft = Path(tempfile.mkdtemp(prefix=f".{goal.name}.", dir=goal.parent))
        try:
            for name, content in files.items():
                (draft / name).write_bytes(content)
            draft.chmod(0o755)
            if goal.exists():
                goal.rmdir()  # raises where another program has put something into it meanwhile
            draft.rename(goal)
        finally:
            shutil.rmtree(draft, ignore_errors=True)
    except OSError as problem:
        raise ExportError(f"{goal}: cannot be written ({problem.strerror or problem}); nothing was exported") from None
