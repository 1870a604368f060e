"""thermicon.circuit: corner points and a rig → drive current → a trace of temperatures and heat flow → exported drives.

This is the front door, in the order of the flow; everything else is reached through its room, such as
`thermicon.circuit.rig` or `thermicon.circuit.safety`.
"""

from typing import TYPE_CHECKING

from thermicon.icons.front_door import door

if TYPE_CHECKING:
    from .inputs import InputError
    from .rig.rigfile import RigError
    from .rig.rig import Rig, rig_names
    from .rig.datasheet import Datasheet
    from .rig.rules import Limits
    from .solver.drive import Drive, DriveError, read_drive
    from .solver.steady import steady_state
    from .solver.inverse import design
    from .solver.static import check_static
    from .solver.trace import Outcome, Trace, write_trace
    from .solver.simulate import duration_s, simulate, simulate_all, simulate_current
    from .solver.batch import simulate_many, simulate_stream
    from .safety.limits import judge_safety
    from .safety.gate import Gate, gate
    from .safety.repeated import PauseError
    from .safety.sessionplan import SessionError, SessionPlan
    from .safety.session import Session
    from .safety.sessionplay import play_session
    from .safety.summary import summarise
    from .safety.exposure import cem43_min, henriques
    from .delivery.device import Device, device_names
    from .delivery.devicefile import DeviceError
    from .delivery.formats.form import FormatError
    from .delivery.delivered_drive import DeliveredDrive
    from .delivery.deliver import deliver
    from .delivery.netlist import netlist
    from .delivery.prepare import Prepared, prepare
    from .delivery.refusal import Refusal
    from .delivery.pack import pack
    from .delivery.export import Export, ExportError, export
    from .fitting.fit import fit
    from .fitting.rig_fit import RigFit
    from .delivery.nearest import nearest_reachable

__all__ = [
    "InputError",
    "RigError",
    "Rig",
    "rig_names",
    "Datasheet",
    "Limits",
    "Drive",
    "DriveError",
    "read_drive",
    "steady_state",
    "design",
    "check_static",
    "Trace",
    "Outcome",
    "write_trace",
    "duration_s",
    "simulate",
    "simulate_all",
    "simulate_current",
    "simulate_many",
    "simulate_stream",
    "judge_safety",
    "gate",
    "Gate",
    "PauseError",
    "SessionPlan",
    "SessionError",
    "Session",
    "play_session",
    "summarise",
    "cem43_min",
    "henriques",
    "Device",
    "device_names",
    "DeviceError",
    "FormatError",
    "DeliveredDrive",
    "deliver",
    "netlist",
    "Prepared",
    "prepare",
    "Refusal",
    "pack",
    "export",
    "Export",
    "ExportError",
    "fit",
    "RigFit",
    "nearest_reachable",
]

if not TYPE_CHECKING:
    __getattr__ = door(
        __name__,
        {
            "inputs": "InputError",
            "rig.rigfile": "RigError",
            "rig.rig": "Rig rig_names",
            "rig.datasheet": "Datasheet",
            "rig.rules": "Limits",
            "solver.drive": "Drive DriveError read_drive",
            "solver.steady": "steady_state",
            "solver.inverse": "design",
            "solver.static": "check_static",
            "solver.trace": "Outcome Trace write_trace",
            "solver.simulate": "duration_s simulate simulate_all simulate_current",
            "solver.batch": "simulate_many simulate_stream",
            "safety.limits": "judge_safety",
            "safety.gate": "Gate gate",
            "safety.repeated": "PauseError",
            "safety.sessionplan": "SessionError SessionPlan",
            "safety.session": "Session",
            "safety.sessionplay": "play_session",
            "safety.summary": "summarise",
            "safety.exposure": "cem43_min henriques",
            "delivery.device": "Device device_names",
            "delivery.devicefile": "DeviceError",
            "delivery.formats.form": "FormatError",
            "delivery.delivered_drive": "DeliveredDrive",
            "delivery.deliver": "deliver",
            "delivery.netlist": "netlist",
            "delivery.prepare": "Prepared prepare",
            "delivery.refusal": "Refusal",
            "delivery.pack": "pack",
            "delivery.export": "Export ExportError export",
            "fitting.fit": "fit",
            "fitting.rig_fit": "RigFit",
            "delivery.nearest": "nearest_reachable",
        },
    )


def __dir__() -> list[str]:
    """Return the names of the front door, whether loaded yet or not."""
    return sorted({*globals(), *__all__})
