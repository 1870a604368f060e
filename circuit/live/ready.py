"""Drives to be played that the gate has judged just now."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from thermicon.base.files.inputs import InputError
from thermicon.base.files.records import Record
from thermicon.icons import Icon, parse

from ..delivery.delivered_drive import ModuleDrive
from ..delivery.device import Device
from ..delivery.export import Export, export
from ..delivery.formats import load_format
from ..delivery.formats.form import Event, course_C, events_in
from ..delivery.pack import digest
from ..delivery.shaped import SENSOR_LAG_S
from ..delivery.verify import verify
from ..play.script import COURSE_EVERY_S
from ..rig.rig import Rig, rig_of
from ..safety.demands import Demands
from ..solver.trace import Trace

CONTROLLER = "closed-loop-controller"
"""The device whose steps and rate set-points have, where nobody names another."""
SENSORS = ("loop", "second")
"""Names of the probes of a device: its loop's sensor, and that of the cut-off."""


@dataclass(frozen=True, slots=True, eq=False)
class ReadyDrive:
    """A drive as it is played: set-points (time s, °C) with the end as last row, predicted course, events, trace."""

    name: str
    sha256: str
    rows: tuple[tuple[float, float], ...]
    course_C: tuple[tuple[float, float], ...]
    events: tuple[Event, ...]
    trace: Trace
    designed: Trace

    @property
    def peak_A(self) -> float:
        """The largest predicted current."""
        return float(abs(self.trace.current_A).max())


@dataclass(frozen=True, slots=True, eq=False)
class ReadySet:
    """Drives that one device plays in any order, by name, their rig with the device's sensors as probes, demands."""

    rig: Rig
    drives: dict[str, ReadyDrive]
    demands: Demands
    amber: tuple[str, ...]

    @staticmethod
    def of(made: Export) -> ReadySet:
        """The drives of an export that was not refused."""
        drives = {}
        for each in made.prepared:
            delivery, form = each.delivery, made.form
            assert isinstance(delivery, ModuleDrive)
            played, name = delivery.played, delivery.icon.name
            drives[name] = ReadyDrive(
                name,
                digest(form.write(delivery)),
                tuple(zip(played.time_s.tolist(), played.command.tolist(), strict=True)),
                tuple((k * COURSE_EVERY_S, at_C) for k, at_C in enumerate(course_C(delivery, COURSE_EVERY_S).tolist())),
                events_in(delivery),
                delivery.trace,
                delivery.designed_trace,
            )
        amber = [f"{each.delivery.icon.name}: {text}" for each in made.prepared for text in each.verdict.cautions]
        is_amber = any(each.verdict.colour == "amber" for each in made.prepared)
        demands = Demands.strictest([each.verdict.demands for each in made.prepared])
        return ReadySet(made.rig, drives, demands, tuple(amber) if is_amber else ())


def with_sensors(rig: Rig, lag_s: float) -> Rig:
    """The rig with a device's sensors as probes of its display, in place of those of the same names."""
    document: dict[str, Any] = json.loads(rig.document)
    others = [probe for probe in document.get("probe", []) if probe["name"] not in SENSORS]
    document["probe"] = [*others, *({"name": name, "place": "display", "lag_s": lag_s} for name in SENSORS)]
    return rig_of(document, f"rig {rig.name}")


def judged(
    icons: Sequence[Icon], rig: Rig, device: Device, pause_s: float | None, step: Callable[[int, int], None] | None
) -> Export:
    """Export icons as set-points, and judge them; InputError where no controller plays them on this rig."""
    if rig.thermode is not None:
        raise InputError(f"rig {rig.name} is a thermode, which plays by itself: export in the format tcs2-serial")
    if device.driven_by != "temperatures":
        raise InputError(f"{device.name} takes no set-points; live play needs a temperature controller")
    lag_s = SENSOR_LAG_S if rig.controller is None else rig.controller.lag_s
    return export(icons, with_sensors(rig, lag_s), device, "setpoint-csv", pause_s=pause_s, step=step)


def exported_before(
    folder: Path, rig: Rig | None, pause_s: float | None, step: Callable[[int, int], None] | None
) -> Export:
    """Verify an exported folder and judge it again; InputError where it is not what would be exported now."""
    files = {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}
    found = verify(files)
    wrong = [str(each) for each in found.findings if each.kind == "wrong"]
    if wrong:
        raise InputError(f"{folder}: {wrong[0]}" + (f" (and {len(wrong) - 1} more)" if len(wrong) > 1 else ""))
    abouts = {name: json.loads(files[name]) for name in found.claims}
    first = next(iter(abouts.values()))
    if any(each[key] != first[key] for each in abouts.values() for key in ("rig_sha256", "device_sha256")):
        raise InputError(f"{folder}: its drives are for several rigs or devices; export them again, as one set")
    own = rig_of(first["rig"]["document"], f"the rig of {folder}")
    if rig is not None and rig != own:
        raise InputError(f"{folder} was exported for another rig {own.name} than {rig.name}: give that rig, or none")
    about = first["device"]
    device = Device(**{**about, "records": tuple(Record(**record) for record in about["records"])})
    icons = [parse(each["icon"]["text"])[each["icon"]["name"]] for each in abouts.values()]
    made = judged(icons, own, device, pause_s, step)
    csv = load_format(first["format"]["name"])
    for one, (name, each) in zip(made.prepared, abouts.items(), strict=True):
        if each["forced"] or digest(csv.write(one.delivery)) != each["drive_sha256"]:
            raise InputError(f"{folder}: {name} is not what this thermicon exports of its icon: export again")
    return made
