"""What the script of a study needs to know of a device that plays by itself."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

from thermicon.circuit import Export
from thermicon.circuit.delivery.delivered_drive import ModuleDrive
from thermicon.circuit.delivery.formats import FormatError
from thermicon.circuit.delivery.formats.c_array import identifier
from thermicon.circuit.delivery.formats.tables import has_voltage
from thermicon.circuit.live.controller import TURN_S, settings_of
from thermicon.circuit.live.demanded import met_demands
from thermicon.circuit.live.own_board import digest_of
from thermicon.circuit.safety.demands import Demands

READ_BACK = ("watchdog_s", "held_cut_off_display_C", "current_limit_A")
"""Demands that a board holds as they are; it acts on its cut-off within a turn."""


def live_facts(ready: Export) -> dict[str, Any] | None:
    """Digest and drives of the board that is compiled from an export, and what a simulated controller is set to.

    `stated` has the demands that a person must state of a board. None where the drives are no set-points.
    """
    drives = [each.delivery for each in ready.prepared if isinstance(each.delivery, ModuleDrive)]
    if ready.device.driven_by != "temperatures" or has_voltage(ready.device) or ready.rig.thermode is not None:
        return None
    demands = Demands.strictest([each.verdict.demands for each in ready.prepared])
    try:
        digest = digest_of(ready)
    except FormatError:  # as the export for a board will say, with the cure
        digest = ""
    held = {name: getattr(demands, name) for name in READ_BACK}
    held["cut_off_display_C"] = replace(demands.cut_off_display_C, react_within_s=TURN_S)
    met = met_demands(demands, held, {})
    peak_A = max(float(abs(drive.trace.current_A).max()) for drive in drives)
    return {
        "digest": digest,
        "drives": [ready.form.file_name(drive) for drive in sorted(drives, key=lambda one: identifier(one.icon.name))],
        "stated": {row.label: row.demand for row in met if row.how == "missing"},
        "controller": asdict(settings_of(demands, peak_A)),
    }
