"""Export: a cue is delivered, judged in the worst case and packed into files; nothing here touches the disk."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from thermicon.icons import Icon

from ..delivery.deliver import deliver
from ..delivery.delivered_drive import DeliveredDrive
from ..delivery.device import Device
from ..delivery.formats import Format, FormatError
from ..delivery.formats.form import Played
from ..delivery.prevent import must_prevent
from ..delivery.spread import OpenLoopSpread, open_loop_spread
from ..rig.rig import Rig
from ..safety.repeated import check_pause
from ..solver.delivery_deviation import DeliveryDeviation
from .refusal import Refusal, refusals_of
from .sidecar import sealed, sidecar, sidecar_text
from .worstcase import worst_case, worst_cases


class Verdict(Protocol):
    """The verdict of a safety gate on one delivered cue."""

    @property
    def colour(self) -> str:
        """Green, amber or red; red is never written."""

    @property
    def reason(self) -> str | None:
        """Why it is red, in one sentence."""

    @property
    def cautions(self) -> tuple[str, ...]:
        """What is amber, a sentence each."""

    @property
    def scenarios(self) -> int:
        """In how many worlds and endings the cue was judged."""

    def to_dict(self) -> dict[str, object]:
        """What the sidecar holds."""

    @property
    def demanded(self) -> dict[str, object]:
        """What the hardware must prevent, as the sidecar and the players hold it."""


Gate = Callable[[DeliveredDrive], Verdict]
"""A function that judges one delivered cue."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """One cue that is ready to be written, or to be refused."""

    delivery: DeliveredDrive
    verdict: Verdict
    deviation: DeliveryDeviation
    refusals: tuple[Refusal, ...]
    spread: OpenLoopSpread | None = None

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is to be known of the delivery, then what is amber; not again what it is refused for."""
        narrowed = self.delivery.narrowed
        told = self.delivery.warnings
        if narrowed and any(refusal.kind != "unsafe" for refusal in self.refusals):
            told = tuple(text for text in told if text != narrowed.text)
        refused = [refusal.text for refusal in self.refusals]
        return (*(text for text in told if not any(_bare(text) in why for why in refused)), *self.verdict.cautions)


def prepare(
    icon: Icon,
    rig: Rig,
    device: Device,
    form: Format,
    *,
    gate: Gate | None = None,
    tail_s: float = 0.0,
    pause_s: float | None = None,
) -> Prepared:
    """Return a cue as the device delivers it, judged by the gate, by its target and by what is lost.

    The gate is that of the worst case, with `pause_s` between plays (None: the recovery time), unless another is given.

    Raises PauseError for a pause that cannot be, FormatError where the format is not for this device, DeviceError
    where the device cannot play the cue, and RigError where the baseline cannot be held.

    >>> from thermicon.circuit.delivery.formats import load_format
    >>> from thermicon.icons import load_library
    >>> icon, rig = load_library("six-icons")["warming-step"], Rig.load("thenar")
    >>> ready = prepare(icon, rig, Device.load("dac-16"), load_format("csv"))
    >>> ready.verdict.colour, ready.refusals
    ('green', ())
    """
    form.check(device)
    delivery = deliver(icon, rig, device, tail_s=tail_s)
    return _judged(delivery, worst_case(delivery, pause_s) if gate is None else gate(delivery))


def prepare_set(
    icons: Sequence[Icon],
    rig: Rig,
    device: Device,
    form: Format,
    *,
    tail_s: float = 0.0,
    pause_s: float | None = None,
    step: Callable[[int, int], None] | None = None,
) -> tuple[Prepared, ...]:
    """Return cues that may be played again and again in any order, as the device delivers them; as `prepare` does.

    Each counts in the worst sequence of all of them. `step` is called after each with how many are done.

    >>> from thermicon.circuit.delivery.formats import load_format
    >>> from thermicon.icons import load_library
    >>> icons, rig = list(load_library("six-icons"))[:2], Rig.load("thenar")
    >>> ready = prepare_set(icons, rig, Device.load("dac-16"), load_format("csv"), pause_s=60.0)
    >>> [one.verdict.safe for one in ready]
    [True, True]
    """
    check_pause(pause_s)
    form.check(device)
    delivery = []
    for done, icon in enumerate(icons, 1):
        delivery.append(deliver(icon, rig, device, tail_s=tail_s))
        if step is not None:
            step(done, len(icons))
    verdicts = worst_cases(delivery, pause_s) if delivery else ()
    return tuple(_judged(one, verdict) for one, verdict in zip(delivery, verdicts, strict=True))


def _judged(delivery: DeliveredDrive, verdict: Verdict) -> Prepared:
    deviation = delivery.deviation
    refusals = refusals_of(delivery, verdict, deviation)
    return Prepared(delivery, verdict, deviation, refusals, open_loop_spread(delivery))


def _bare(warning: str) -> str:
    """A warning without the name of the device before it."""
    return warning.partition(": ")[2] or warning


def check_names(names: Sequence[str], form: Format) -> None:
    """Raise FormatError that names both where two icons would get files of one name.

    Names that differ only in capitals count as one, since some disks make no difference.

    >>> from thermicon.circuit.delivery.formats import load_format
    >>> check_names(["dip", "double-dip"], load_format("csv"))
    """
    taken: dict[str, str] = {}
    for name in names:
        stem = form.stem(name)
        other = taken.setdefault(stem.casefold(), name)
        if other is name:
            continue
        if form.stem(other) == stem:
            raise FormatError(
                f"{other} and {name}: the files of both would be called {stem} in the format {form.name}; rename one, "
                f"or export them into two folders, one by one with --icon"
            )
        raise FormatError(
            f"{other} and {name}: differ only in capitals, so that one's files would overwrite the other's on disks "
            f"that make no difference; rename one, or export them into two folders, one by one with --icon"
        )


def pack(
    ready: Sequence[Prepared],
    form: Format,
    *,
    felt: Mapping[str, Mapping[str, object]] | None = None,
    losses: Mapping[str, Sequence[str]] | None = None,
) -> dict[str, bytes]:
    """Return file names and their bytes: a sidecar and a drive for each cue, then what belongs to the set.

    `felt` and `losses` are what perception says, by the names of cues; a cue with refusals is written as forced.
    Raises FormatError where two cues would get the same name, or one is unsafe.
    """
    check_names([one.delivery.icon.name for one in ready], form)
    drives = {}
    for one in ready:
        name = one.delivery.icon.name
        if unsafe := [str(refusal) for refusal in one.refusals if not refusal.forcible]:
            raise FormatError(f"{name}: {unsafe[0]}")
        drive = form.file_name(one.delivery)
        if drive.casefold() in form.set_files:
            raise FormatError(
                f"{name}: its drive {drive} would be taken for the set's own {drive.casefold()}; rename it"
            )
        try:
            drives[name] = drive, form.write(one.delivery)
        except FormatError as problem:
            raise FormatError(f"{name}: {problem}") from None
    shared: dict[str, bytes] = {}
    if form.player is not None and ready:
        names = [one.delivery.icon.name for one in ready]
        played = [_played(one, drives[name][0], form) for one, name in zip(ready, names, strict=True)]
        shared = form.player(played, must_prevent([{"hardware_must_prevent": one.verdict.demanded} for one in ready]))
    files: dict[str, bytes] = {}
    for one in ready:
        name = one.delivery.icon.name
        drive, content = drives[name]
        over = [str(refusal) for refusal in one.refusals]
        over += [str(Refusal("lossy", text)) for text in (losses or {}).get(name, ())]
        about = sidecar(
            one.delivery, form, one.deviation, one.verdict.to_dict(), (felt or {}).get(name), over,
            demanded=one.verdict.demanded, drive=content, set_files=shared, spread=one.spread,
        )  # fmt: skip
        files[beside(name, form)] = sidecar_text(sealed(about))
        files[drive] = content
    return {**files, **shared}


def _played(one: Prepared, file: str, form: Format) -> Played:
    """A drive with what the gate says of it, for the player of a set."""
    known = one.verdict.to_dict()
    recovery, shortest = (
        float(value) if isinstance(value := known.get(key), (int, float)) else None
        for key in ("recovery_s", "shortest_pause_s")
    )
    return Played(one.delivery, file, beside(one.delivery.icon.name, form), one.verdict.colour, recovery, shortest)


def beside(name: str, form: Format) -> str:
    """Name of the sidecar of an icon.

    >>> from thermicon.circuit.delivery.formats import load_format
    >>> beside("double-dip", load_format("c-array"))
    'double_dip.json'
    """
    return f"{form.stem(name)}.json"
