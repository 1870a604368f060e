"""Set-points to be played that the gate has judged just now."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from thermicon.base.files.inputs import InputError
from thermicon.base.files.records import Record
from thermicon.icons import Icon, parse

from ..delivery.device import Device
from ..delivery.export import Export, export
from ..delivery.export_folder import claims_of
from ..delivery.formats import load_format
from ..delivery.pack import digest
from ..delivery.shaped import SENSOR_LAG_S
from ..rig.rig import Rig, rig_of

CONTROLLER = "closed-loop-controller"
"""The device whose steps and rate set-points have, where nobody names another."""
SENSORS = ("loop", "second")
"""Probes of a device: the sensor of its loop, and that of its cut-off."""
Progress = Callable[[int, int], None] | None


def judged(icons: Sequence[Icon], rig: Rig, device: Device, pause_s: float | None, step: Progress = None) -> Export:
    """Judge icons as set-points on a rig with the device's sensors; InputError where no controller plays them."""
    if rig.thermode is not None:
        raise InputError(f"rig {rig.name} is a thermode, which plays by itself: export in the format tcs2-serial")
    if device.driven_by != "temperatures":
        raise InputError(f"{device.name} takes no set-points; live play needs a temperature controller")
    return export(icons, with_sensors(rig), device, "setpoint-csv", pause_s=pause_s, step=step)


def with_sensors(rig: Rig) -> Rig:
    """The rig with the sensors of a device as probes, by which a log names them."""
    document: dict[str, Any] = json.loads(rig.document)
    lag_s = SENSOR_LAG_S if rig.controller is None else rig.controller.lag_s
    probes = [probe for probe in document.get("probe", []) if probe["name"] not in SENSORS]
    probes += [{"name": name, "place": "display", "lag_s": lag_s} for name in SENSORS]
    return rig_of({**document, "probe": probes}, f"rig {rig.name}")


def exported_before(folder: Path, rig: Rig | None, pause_s: float | None, step: Progress = None) -> Export:
    """Judge a folder again that was verified; InputError where it is not what would be exported now."""
    contents = [path.read_bytes() for path in sorted(folder.glob("*.json"))]
    abouts = [json.loads(content) for content in contents if claims_of(content)]
    first = abouts[0]
    own = rig_of(first["rig"]["document"], f"the rig of {folder}")
    if rig is not None and rig != own:
        raise InputError(f"{folder} was exported for another rig {own.name} than {rig.name}: give that rig, or none")
    records = tuple(Record(**record) for record in first["device"]["records"])
    device = Device(**{**first["device"], "records": records})
    icons = [parse(about["icon"]["text"])[about["icon"]["name"]] for about in abouts]
    made, form = judged(icons, own, device, pause_s, step), load_format(first["format"]["name"])
    for one, about in zip(made.prepared, abouts, strict=True):
        if about["forced"] or digest(form.write(one.delivery)) != about["drive_sha256"]:
            name = about["file"]
            raise InputError(f"{folder}: {name} is not what this thermicon exports of its icon: export again")
    return made
