"""Icons prepared for export."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from thermicon.base.checks.arguments import Changes, advised
from thermicon.base.words.number_text import signed
from thermicon.icons import Icon

from ..rig.rig import Rig
from ..safety.checks import cures_of, hard_of
from ..safety.gate import Gate
from ..safety.repeated import check_pause
from ..safety.words import more_and_cure
from ..solver.trace import Outcome
from .delivered_drive import DeliveredDrive, DeliveryDeviation, ModuleDrive, loss_limit
from .device import Device
from .formats import Format
from .setpoints import Setpoints
from .ways import deliver, worst_cases
from .worstcase import OpenLoopSpread, open_loop_spread

Judge = Callable[[Sequence[DeliveredDrive], float | None], Sequence[Gate]]
"""A function that judges delivered cues, as `worst_cases` does."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """One cue that is ready to be written, or to be refused: what the device delivers, and whether that is safe.

    `deviation` is how far it is from the design, `spread` how far an open loop varies with the uncertainty of the rig.
    """

    delivery: DeliveredDrive
    verdict: Gate
    deviation: DeliveryDeviation
    refusals: tuple[Refusal, ...]
    spread: OpenLoopSpread | None = None

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the delivery, then amber findings; without the reasons of a refusal."""
        told = {text for refusal in self.refusals for text in refusal.tells}
        return (*(text for text in self.delivery.warnings if text not in told), *self.verdict.cautions)


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
    """Deliver cues by a device, and judge their safety, their targets and their losses."""
    check_pause(pause_s)
    form.check(device)
    deliveries = []
    for done, icon in enumerate(icons, 1):
        deliveries.append(deliver(icon, rig, device, tail_s=tail_s))
        form.write(deliveries[-1])  # a drive that the format cannot hold is refused before the gate, which takes longer
        if step is not None:
            step(done, len(icons))
    return judged_set(deliveries, judge(deliveries, pause_s) if deliveries else ())


def judged_set(deliveries: Sequence[DeliveredDrive], verdicts: Sequence[Gate]) -> tuple[Prepared, ...]:
    """Deliveries with their verdicts, and what refuses them."""
    return tuple(
        Prepared(one, verdict, one.deviation, refusals_of(one, verdict, one.deviation), open_loop_spread(one))
        for one, verdict in zip(deliveries, verdicts, strict=True)
    )


_HEADS = {"unsafe": "NOT SAFE", "unreachable": "NOT reached", "lossy": "loses too much"}


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why a cue is not exported: the `cause` in a sentence, which `tells` what warnings say too, and what to change."""

    kind: Literal["unsafe", "unreachable", "lossy"]
    cause: str
    tells: tuple[str, ...] = ()
    changes: Changes = field(default_factory=lambda: MappingProxyType({}))

    @property
    def forcible(self) -> bool:
        """Whether the export may be forced."""
        return self.kind != "unsafe"

    @property
    def text(self) -> str:
        """Kind and cause, without the changes."""
        return f"{_HEADS[self.kind]}: {self.cause}"

    def __str__(self) -> str:
        return advised(self.text, self.changes)


def refusals_of(delivery: DeliveredDrive, verdict: Gate, deviation: DeliveryDeviation) -> tuple[Refusal, ...]:
    """Return the causes against exporting a cue, those that cannot be forced first.

    A consequence is not listed besides its cause: what a device with too small a range misses or loses is reported with
    the range, and losses are not reported where the drive is unsafe.
    """
    refusals, narrowed = [], delivery.narrowed if isinstance(delivery, ModuleDrive) else None
    tells = (narrowed.text,) if narrowed else ()
    if verdict.colour == "red":
        cause, longer = verdict.reason or "the gate says red", verdict.mended_by_pause
        changes = {"pause_s": verdict.repeated.shortest_pause_s} if longer else {}
        more = more_and_cure(hard_of(verdict.findings), cures_of(verdict.findings))
        refusals.append(Refusal("unsafe", cause if longer else cause + more, (), changes))
    lost = lost_text(deviation)
    if delivery.outcome is not None and not delivery.outcome.reached:
        text = _out_of_reach(delivery, delivery.outcome, verdict.colour != "red")
        refusals.append(Refusal("unreachable", text, tells))
        lost = "" if narrowed else lost
    elif narrowed and narrowed.outcome is not None and not narrowed.outcome.reached:
        refusals.append(Refusal("unreachable", f"{narrowed.text}. With that it {narrowed.outcome.reason}", tells))
        lost = ""
    if lost and verdict.colour != "red":
        text = f"{narrowed.text}. With that {lost}" if narrowed else ""
        refusals.append(Refusal("lossy", text, tells) if narrowed else _lossy(delivery, lost))
    return tuple(refusals)


def lost_text(deviation: DeliveryDeviation) -> str:
    """Losses of both receptors beyond the stated limit, the worse first, in words; empty where there are none."""
    limit = loss_limit("receptor difference")
    if not deviation.lost:
        return ""
    first, *others = sorted(deviation.lost, key=lambda place: -place.rms_K)
    also = "".join(f" (the {place.place} by {place.rms_K:.3f} K)" for place in others)
    return f"the {first.place} differs by {first.rms_K:.3f} K (rms) from the design{also}, over the stated {limit:g} K"


def _out_of_reach(delivery: DeliveredDrive, outcome: Outcome, safe: bool) -> str:
    """The rig's own shortfall and its cure; a cue that is unsafe should not get more current."""
    text = outcome.reason or "the target is missed"
    if not isinstance(delivery, ModuleDrive):  # a thermode, which has neither driver nor module
        return f"{text}; use a slower or smaller change, or use a thermode that can"
    rig, driver = delivery.rig, delivery.rig.driver
    limits_met = [name for name, _ in outcome.limits]
    if not limits_met or rig.controller is not None or not safe:
        return f"{text}; use a slower or smaller change"
    if limits_met == ["compliance voltage"]:
        return f"{text}; raise driver.voltage_limit_V ({driver.voltage_limit_V:g} V), or use a slower change"
    narrow = ""
    if delivery.narrowed:
        narrow = f" and {delivery.device.name} plays at most {delivery.narrowed.most_A:g} A"
    return (
        f"{text}; driver.current_limit_A is {driver.current_max_A:g} A{narrow}: use a slower or smaller change, or "
        f"raise the limit if driver and module can"
    )


def _lossy(delivery: DeliveredDrive, lost: str) -> Refusal:
    """The refusal of a lossy delivery: the loss, its reason, and what would lose less."""
    device, played = delivery.device, delivery.played
    if isinstance(played, Setpoints):
        why = f"{device.name}: its set-points have steps of {played.step_K:g} K"
    elif delivery.device_warnings:
        why = "; ".join(delivery.device_warnings)
    elif device.driven_by == "temperatures" and delivery.rate_Hz >= 0.9 * delivery.requested_Hz:
        return Refusal("lossy", f"{lost}; its loop follows no better; use a slower change, or a quicker [controller]")
    elif delivery.rate_Hz < 0.9 * delivery.requested_Hz:
        why = f"{device.name}: it plays {delivery.rate_Hz:.3g} of the {delivery.requested_Hz:g} updates a second"
    else:
        unit = " of full duty" if device.kind.switches else f" {device.unit}"
        why = f"{device.name}: its steps are {signed(played.scale.step, '.3g')}{unit}"
    text = f"{lost}; {why}; use a device that is finer or faster there"
    return Refusal("lossy", text, () if isinstance(played, Setpoints) else delivery.device_warnings)
