"""What the export view computes: icons as a device delivers them, what speaks against it, and the files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.notebooks.outputs import OutputError, check_folder, write_together

if TYPE_CHECKING:
    from thermicon.circuit import Device, Prepared, Refusal, Rig
    from thermicon.circuit.delivery.formats import Format
    from thermicon.icons import Icon
    from thermicon.perception import FeltChange

FORMAT = "csv"


@dataclass(frozen=True, slots=True)
class Ready:
    """Icons ready to be written or refused: what the device makes of each, and what is felt of the change."""

    form: Format
    device: Device
    prepared: tuple[Prepared, ...]
    felt: tuple[FeltChange, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def losses(self) -> dict[str, tuple[str, ...]]:
        """What perception says is lost, by the names of icons."""
        return {change.icon: change.losses() for change in self.felt}

    @property
    def against(self) -> list[tuple[str, Refusal]]:
        """Every reason against writing, with the icon that it is about."""
        from thermicon.notebooks.export import refusals

        return refusals(self.prepared, self.losses)


def formats_for(device: Device) -> tuple[str, ...]:
    """Names of the formats that a device takes.

    >>> from thermicon.circuit import Device
    >>> formats_for(Device.load("qst-tcs2"))
    ('tcs2-serial', 'tcs2-protocol-ini', 'psychopy')
    """
    from thermicon.circuit.delivery.formats import format_names, load_format

    return tuple(name for name in format_names() if device.driven_by in load_format(name).takes)


def ready_of(icon: Icon | None, rig: Rig, device: str | None = None, form: str = FORMAT) -> Ready:
    """Realise and judge one icon; raises ValueError without one, InputError where the device cannot play it."""
    if icon is None:
        raise ValueError("there is no icon to export: the text has errors")
    return prepare_icons([icon], [], rig, device, form)


def prepare_icons(
    icons: Sequence[Icon],
    rest: Sequence[Icon],
    rig: Rig,
    device: str | None = None,
    form: str = FORMAT,
    step: Callable[[int, int], None] | None = None,
) -> Ready:
    """Realise and judge icons beside the ``rest`` of their set, as ``thermicon export`` does; ``step`` after each.

    Raises InputError where the device cannot play an icon, or not in this format.
    """
    from thermicon.circuit import Device, prepare
    from thermicon.circuit.delivery.formats import load_format
    from thermicon.notebooks.export import compare_felt

    made = load_format(form)
    played = Device.load(device or made.device)
    prepared = []
    for done, icon in enumerate(icons, 1):
        prepared.append(prepare(icon, rig, played, made))
        if step is not None:
            step(done, len(icons))
    warned: list[str] = []
    felt = compare_felt(prepared, rest, rig, played, 0.0, warned.append)
    return Ready(made, played, tuple(prepared), felt, tuple(warned))


def write(ready: Ready, folder: Path, overwrite: bool = False, insist: bool = False) -> tuple[Path, ...]:
    """Write drives and sidecars, all or none, and return their paths.

    Raises OutputError where that is refused: what is unsafe always, what is lossy or not reached unless ``insist``,
    files that are there unless ``overwrite``.
    """
    from thermicon.circuit import pack

    stops = [f"{name}: {refusal}" for name, refusal in ready.against if not (insist and refusal.forcible)]
    if stops:
        raise OutputError("; ".join(stops))
    check_folder(folder)
    files = pack(
        ready.prepared,
        ready.form,
        felt={change.icon: change.to_dict() for change in ready.felt},
        losses=ready.losses,
    )
    there = [name for name in files if (folder / name).exists()]
    if there and not overwrite:
        more = f" and {len(there) - 1} more" if len(there) > 1 else ""
        raise OutputError(f"{folder / there[0]}{more} exists already and is kept; tick overwrite to replace it")
    write_together(files, folder, replace=overwrite)
    return tuple(folder / name for name in files)
