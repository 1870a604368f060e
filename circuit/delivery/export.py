"""Export: a cue realised, judged in the worst case, and packed into files; nothing here touches the disk."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

from thermicon.circuit.delivery.device import Device
from thermicon.circuit.delivery.formats import Format, FormatError
from thermicon.circuit.delivery.formats.form import Played
from thermicon.circuit.delivery.prevent import must_prevent
from thermicon.circuit.delivery.realise import realise
from thermicon.circuit.delivery.realised import Realised
from thermicon.circuit.delivery.sidecar import sidecar, sidecar_text
from thermicon.circuit.delivery.spread import OpenLoopSpread, open_loop_spread
from thermicon.circuit.delivery.worstcase import worst_case
from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.solver.difference import Difference
from thermicon.icons import Icon


class Verdict(Protocol):
    """What a gate of safety says of one realised cue."""

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


Gate = Callable[[Realised], Verdict]

_SAID = {"unsafe": "NOT SAFE", "unreachable": "NOT reached", "lossy": "loses too much"}


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why a cue is not exported. What is unsafe cannot be forced."""

    kind: Literal["unsafe", "unreachable", "lossy"]
    text: str

    @property
    def forcible(self) -> bool:
        """Whether a person may insist."""
        return self.kind != "unsafe"

    def __str__(self) -> str:
        return f"{_SAID[self.kind]}: {self.text}"


@dataclass(frozen=True, slots=True)
class Prepared:
    """One cue that is ready to be written, or to be refused."""

    realised: Realised
    verdict: Verdict
    apart: Difference
    refusals: tuple[Refusal, ...]
    spread: OpenLoopSpread | None = None


def prepare(
    icon: Icon, rig: Rig, device: Device, form: Format, *, gate: Gate = worst_case, tail_s: float = 0.0
) -> Prepared:
    """Return a cue as the device delivers it, judged by the gate, by its target and by what is lost.

    The gate is that of the worst case, unless another is given.

    Raises FormatError where the format is not for this device, DeviceError where the device cannot play the cue, and
    RigError where the baseline cannot be held.

    >>> from thermicon.circuit.delivery.formats import load_format
    >>> from thermicon.icons import load_library
    >>> icon, rig = load_library("six-icons")["warming-step"], Rig.load("thenar")
    >>> ready = prepare(icon, rig, Device.load("dac-16"), load_format("csv"))
    >>> ready.verdict.colour, ready.refusals
    ('green', ())
    """
    form.check(device)
    realised = realise(icon, rig, device, tail_s=tail_s)
    verdict = gate(realised)
    apart = realised.apart
    against = []
    if verdict.colour == "red":
        against.append(Refusal("unsafe", verdict.reason or "the gate says red"))
    if realised.outcome is not None and not realised.outcome.reached:
        against.append(Refusal("unreachable", realised.outcome.reason or "the target is missed"))
    against += [Refusal("lossy", text) for text in apart.losses()]
    return Prepared(realised, verdict, apart, tuple(against), open_loop_spread(realised))


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
    check_names([one.realised.icon.name for one in ready], form)
    files: dict[str, bytes] = {}
    named = []
    for one in ready:
        name = one.realised.icon.name
        if unsafe := [str(refusal) for refusal in one.refusals if not refusal.forcible]:
            raise FormatError(f"{name}: {unsafe[0]}")
        drive = form.file_name(one.realised)
        beside = f"{form.stem(name)}.json"
        if drive.casefold() in form.set_files:
            raise FormatError(
                f"{name}: its drive {drive} would be taken for the set's own {drive.casefold()}; rename it"
            )
        over = [str(refusal) for refusal in one.refusals]
        over += [str(Refusal("lossy", text)) for text in (losses or {}).get(name, ())]
        content = sidecar(
            one.realised, form, one.apart, one.verdict.to_dict(), (felt or {}).get(name), over, one.spread
        )
        files[beside] = sidecar_text(content)  # first, so that no drive is ever without its sidecar
        try:
            files[drive] = form.write(one.realised)
        except FormatError as problem:
            raise FormatError(f"{name}: {problem}") from None
        named.append(Played(one.realised, drive, beside))
    if form.player is not None and named:
        files.update(form.player(named, must_prevent([one.verdict.to_dict() for one in ready])))
    return files
