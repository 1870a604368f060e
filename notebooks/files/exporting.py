"""The export of icons to files, for command line and workbench: simulated, judged, compared, packed and written."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from .export_folder import HOW, publish
from .outputs import OutputError

if TYPE_CHECKING:
    from thermicon.circuit import Device, Rig
    from thermicon.circuit.delivery.formats import Format
    from thermicon.circuit.delivery.prepare import Prepared
    from thermicon.circuit.delivery.refusal import Refusal
    from thermicon.icons import Icon
    from thermicon.perception.identification.delivered import DeliveredChange, PerceivedChange

FORMAT = "csv"

MOST_COMPARED = 60
"""In a larger set, d′ is computed only among the exported icons; beyond this number, not at all."""


@dataclass(frozen=True, slots=True)
class PreparedExport:
    """Icons ready to be written or refused: what the device delivers, and how that changes perception."""

    form: Format
    device: Device
    prepared: tuple[Prepared, ...]
    felt: tuple[PerceivedChange, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def losses(self) -> dict[str, tuple[str, ...]]:
        """Perceptual losses by icon name."""
        return {change.icon: change.losses() for change in self.felt}

    @property
    def against(self) -> list[tuple[str, Refusal]]:
        """Every reason against writing, with its icon.

        Perceptual losses are listed only without other reasons, from which they would follow.
        """
        from thermicon.circuit.delivery.refusal import Refusal

        found = []
        for one in self.prepared:
            name, causes = one.delivery.icon.name, one.refusals
            felt = self.losses.get(name, ())
            if felt and not causes:
                more = f" (and {len(felt) - 1} more such)" if len(felt) > 1 else ""
                causes = (Refusal("lossy", f"{felt[0]}{more}; use a device with a finer resolution or a higher rate"),)
            found += [(name, refusal) for refusal in causes]
        return found


@dataclass(frozen=True, slots=True)
class Written:
    """Files written by an export, and where the folder stands that they replace; None where it was missing or empty."""

    folder: Path
    names: tuple[str, ...]
    before: Path | None = None

    @property
    def paths(self) -> tuple[Path, ...]:
        """Where the files are."""
        return tuple(self.folder / name for name in self.names)


def formats_for(device: Device) -> tuple[str, ...]:
    """Names of the formats that a device takes.

    >>> from thermicon.circuit import Device
    >>> formats_for(Device.load("qst-tcs2"))
    ('tcs2-serial', 'tcs2-protocol-ini', 'psychopy')
    """
    from thermicon.circuit.delivery.formats import format_names, load_format

    return tuple(name for name in format_names() if device.driven_by in load_format(name).takes)


def prepare_icon(icon: Icon, rig: Rig, device: str | None = None, form: str = FORMAT) -> PreparedExport:
    """Deliver and judge one icon; raises InputError where the device cannot play it."""
    return prepare_icons([icon], [], rig, device, form)


def prepare_icons(
    icons: Sequence[Icon],
    rest: Sequence[Icon],
    rig: Rig,
    device: Device | str | None = None,
    form: str = FORMAT,
    step: Callable[[int, int], None] | None = None,
    tail_s: float = 0.0,
    pause_s: float | None = None,
) -> PreparedExport:
    """Simulate and judge icons, and compare them with each other and the ``rest`` of their set.

    ``step`` is called after each icon. ``tail_s`` is simulated after the last corner, ``pause_s`` is the time between
    plays (None: the recovery time). Raises InputError if the device cannot play an icon, or not in this format.
    """
    from thermicon.circuit import Device
    from thermicon.circuit.delivery.formats import load_format
    from thermicon.circuit.delivery.prepare import prepare_set

    made = load_format(form)
    played = device if isinstance(device, Device) else Device.load(device or made.device)
    prepared = prepare_set(icons, rig, played, made, tail_s=tail_s, pause_s=pause_s, step=step)
    warned: list[str] = []
    felt = compare_felt(prepared, rest, rig, played, tail_s, warned.append)
    return PreparedExport(made, played, prepared, felt, tuple(warned))


def others(whole: Iterable[Icon], chosen: Sequence[Icon]) -> list[Icon]:
    """The other icons of the set, which are only compared with; none in a large set."""
    names = {icon.name for icon in chosen}
    left = [icon for icon, _ in zip(whole, range(MOST_COMPARED + 1), strict=False) if icon.name not in names]
    return left if len(left) + len(chosen) <= MOST_COMPARED else []


def compare_felt(
    ready: Sequence[Prepared],
    rest: Sequence[Icon],
    rig: Rig,
    device: Device,
    tail_s: float,
    warn: Callable[[str], None],
) -> tuple[PerceivedChange, ...]:
    """How the device changes detection of the exported icons by people, and d′ of a nominal person within the set."""
    from thermicon.circuit.delivery.deliver import deliver, traces_until
    from thermicon.circuit.inputs import InputError
    from thermicon.circuit.solver.simulate import duration_s
    from thermicon.perception.identification.delivered import PEOPLE, detected_as_delivered, judge_delivered
    from thermicon.perception.identification.run_end import TAIL_S, run_end_s

    everyone = [one.delivery for one in ready]
    for icon in rest:
        try:
            everyone.append(deliver(icon, rig, device, tail_s=tail_s))
        except InputError as problem:
            warn(f"warning: {icon.name} cannot be played, so nothing is compared with it: {problem}")
    end = max(delivery.end_s for delivery in everyone) + TAIL_S
    run_end = run_end_s(duration_s(delivery.icon, rig) for delivery in everyone)
    groups = [everyone] if len(everyone) <= MOST_COMPARED else [[delivery] for delivery in everyone]
    if len(groups) > 1:
        warn(f"warning: {len(everyone)} icons are too many to compare with each other; d′ is left out")
    felt: list[PerceivedChange] = []
    by_people: list[DeliveredChange | None] = []
    for group in groups:
        traces = [traces_until(delivery, end) for delivery in group]
        names = [delivery.icon.name for delivery in group]
        felt += judge_delivered(names, [each for each, _ in traces], [each for _, each in traces])
        for place, delivery in enumerate(group):
            if len(by_people) == len(ready):
                break
            try:
                by_people.append(detected_as_delivered(delivery, *traces[place], end_s=run_end))
            except InputError as problem:
                warn(f"warning: {delivery.icon.name}: detection is that of the nominal person alone: {problem}")
                by_people.append(None)
    return tuple(
        change if detection is None else replace(change, detection=detection, people=PEOPLE)
        for change, detection in zip(felt, by_people, strict=False)
    )


def write(
    ready: PreparedExport, folder: Path, overwrite: bool = False, insist: bool = False, how: str = HOW
) -> Written:
    """Write drives and sidecars, all or none, and say which.

    Raises OutputError where that is refused: what is unsafe always, what is lossy or not reached unless ``insist``,
    a folder with files unless ``overwrite``, which ``how`` tells a person how to ask for.
    """
    from thermicon.circuit.delivery.pack import pack

    stops = [f"{name}: {refusal}" for name, refusal in ready.against if not (insist and refusal.forcible)]
    if stops:
        raise OutputError("; ".join(stops))
    files = pack(
        ready.prepared,
        ready.form,
        felt={change.icon: change.to_dict() for change in ready.felt},
        losses=ready.losses,
    )
    return Written(folder, tuple(files), publish(files, folder, overwrite, how))
