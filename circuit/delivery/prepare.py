"""Icons prepared for export: delivered by a device, judged in the worst case, and accepted or refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from thermicon.icons import Icon

from ..rig.rig import Rig
from ..safety.checks import Check
from ..safety.repeated import check_pause
from .deliver import deliver
from .delivered_drive import DeliveredDrive
from .delivery_deviation import DeliveryDeviation
from .device import Device
from .formats import Format
from .refusal import Refusal, refusals_of
from .spread import OpenLoopSpread, open_loop_spread
from .worstcase import worst_cases


class Verdict(Protocol):
    """The verdict of a safety gate on one delivered cue."""

    @property
    def colour(self) -> str:
        """Green, amber or red; red is never written."""

    @property
    def reason(self) -> str | None:
        """Why it is red, in one sentence."""

    @property
    def mended_by_pause(self) -> bool:
        """Whether a longer pause is all that is missing."""

    @property
    def findings(self) -> Sequence[Check]:
        """The limits that are exceeded, the hard ones first."""

    @property
    def cautions(self) -> tuple[str, ...]:
        """One sentence for each soft limit exceeded."""

    @property
    def scenarios(self) -> int:
        """Number of corners and endings in which the cue was judged."""

    def to_dict(self) -> dict[str, object]:
        """The content for the sidecar."""

    @property
    def demanded(self) -> dict[str, object]:
        """What the hardware must prevent, as the sidecar and the players hold it."""


Judge = Callable[[Sequence[DeliveredDrive], float | None], Sequence[Verdict]]
"""A function that judges delivered cues, as `worst_cases` does."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """One cue that is ready to be written, or to be refused.

    Attributes
    ----------
    delivery
        What the device delivers.
    verdict
        Whether that is safe.
    deviation
        How far it deviates from the design.
    refusals
        Why it is not written; empty where it is.
    spread
        How far an open-loop delivery varies with the uncertainty of the rig; None where it was not calculated.

    Examples
    --------
    >>> from thermicon.circuit.delivery.formats import load_format
    >>> from thermicon.icons import load_library
    >>> icon, form = load_library("six-icons")["warming-step"], load_format("tcs2-protocol-ini")
    >>> prepare_set([icon], Rig.load("tcs2"), Device.load("qst-tcs2"), form)
    (Prepared('warming-step' for qst-tcs2, 8 s, safety green),)
    """

    delivery: DeliveredDrive
    verdict: Verdict
    deviation: DeliveryDeviation
    refusals: tuple[Refusal, ...]
    spread: OpenLoopSpread | None = None

    def __repr__(self) -> str:
        refused = ", ".join(refusal.kind for refusal in self.refusals)
        return (
            f"Prepared({self.delivery.icon.name!r} for {self.delivery.device.name}, {self.delivery.file_s:g} s, safety "
            f"{self.verdict.colour}{f', REFUSED: {refused}' if refused else ''})"
        )

    @property
    def warnings(self) -> tuple[str, ...]:
        """What to know about the delivery, then what is amber; without what it is refused for."""
        narrowed = self.delivery.narrowed
        notes = self.delivery.warnings
        if narrowed and any(refusal.kind != "unsafe" for refusal in self.refusals):
            notes = tuple(text for text in notes if text != narrowed.text)
        refused = [refusal.text for refusal in self.refusals]
        return (*(text for text in notes if not any(_bare(text) in why for why in refused)), *self.verdict.cautions)


def prepare_set(
    icons: Sequence[Icon],
    rig: Rig,
    device: Device,
    form: Format,
    *,
    judge: Judge = worst_cases,
    tail_s: float = 0.0,
    pause_s: float | None = None,
    step: Callable[[int, int], None] | None = None,
) -> tuple[Prepared, ...]:
    """Deliver cues by a device, and judge their safety, their targets and their losses.

    Parameters
    ----------
    icons, rig, device
        The cues, which may be played repeatedly in any order, the rig that they are designed for, and the device.
    form
        The file format, which must suit the device.
    judge
        Judges each delivery within the worst sequence of all of them.
    tail_s
        Time in s that is played after the last corner.
    pause_s
        Pause in s between plays; None: the recovery time.
    step
        Is called after each cue with how many are done, of how many.

    Returns
    -------
    tuple of Prepared
        Each delivery with its verdict, and the reasons against writing it.

    Raises
    ------
    PauseError, FormatError, DeviceError, RigError
        For an impossible pause, a format that does not suit the device, a cue that the device cannot play, and a
        baseline that cannot be held.

    Examples
    --------
    >>> from thermicon.circuit.delivery.formats import load_format
    >>> from thermicon.icons import load_library
    >>> icons, rig = list(load_library("six-icons"))[:2], Rig.load("thenar")
    >>> ready = prepare_set(icons, rig, Device.load("dac-16"), load_format("csv"), pause_s=60.0)
    >>> [(one.verdict.colour, one.refusals) for one in ready]
    [('green', ()), ('green', ())]
    """
    check_pause(pause_s)
    form.check(device)
    deliveries = []
    for done, icon in enumerate(icons, 1):
        deliveries.append(deliver(icon, rig, device, tail_s=tail_s))
        if step is not None:
            step(done, len(icons))
    verdicts = judge(deliveries, pause_s) if deliveries else ()
    return tuple(_judged(delivery, verdict) for delivery, verdict in zip(deliveries, verdicts, strict=True))


def _judged(delivery: DeliveredDrive, verdict: Verdict) -> Prepared:
    deviation = delivery.deviation
    refusals = refusals_of(delivery, verdict, deviation)
    return Prepared(delivery, verdict, deviation, refusals, open_loop_spread(delivery))


def _bare(warning: str) -> str:
    """A warning without the name of the device before it."""
    return warning.partition(": ")[2] or warning
