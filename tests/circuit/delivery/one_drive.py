"""One icon prepared by itself, judged by the gate or by what a test puts in its place."""

from __future__ import annotations

from collections.abc import Callable

from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.delivered_drive import DeliveredDrive
from thermicon.circuit.delivery.formats import Format
from thermicon.circuit.delivery.prepare import Prepared, Verdict, prepare_set
from thermicon.circuit.delivery.worstcase import worst_cases
from thermicon.icons import Icon

Judge = Callable[[DeliveredDrive], Verdict]


def prepare(
    icon: Icon,
    rig: Rig,
    device: Device,
    form: Format,
    *,
    gate: Judge | None = None,
    tail_s: float = 0.0,
    pause_s: float | None = None,
) -> Prepared:
    judge = worst_cases if gate is None else lambda deliveries, pause_s: tuple(map(gate, deliveries))
    (ready,) = prepare_set([icon], rig, device, form, judge=judge, tail_s=tail_s, pause_s=pause_s)
    return ready
