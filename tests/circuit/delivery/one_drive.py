"""One icon, prepared or judged alone by the gate or a substitute, on changed devices."""

from collections.abc import Callable
from dataclasses import replace

from thermicon.base.files.records import Record
from thermicon.circuit import Device, Gate, Rig
from thermicon.circuit.delivery.delivered_drive import DeliveredDrive
from thermicon.circuit.delivery.formats import Format
from thermicon.circuit.delivery.prepare import Prepared, prepare_set
from thermicon.circuit.delivery.ways import worst_cases
from thermicon.icons import Icon, parse

Judge = Callable[[DeliveredDrive], Gate]


def icon_of(shape: str, control: str = "display", baseline: str | float = 32, name: str = "a") -> Icon:
    """An icon of this shape, in words of a cue file."""
    rest = "" if control == "current" else f"\n baseline {baseline} °C"
    return parse(f"cue 1\nset s {{ control {control}{rest} }}\nicon {name} {{ {shape} }}\n")[name]


def changed(device: Device, quantity: str, unit: str, **numbers: float) -> Device:
    """The device with one record changed, or added."""
    kept = tuple(record for record in device.records if record.quantity != quantity)
    return replace(device, records=(*kept, Record(quantity, unit, "test", **numbers)))


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


def worst_case(delivery: DeliveredDrive, pause_s: float | None = None) -> Gate:
    return worst_cases([delivery], pause_s)[0]
