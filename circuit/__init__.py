"""thermicon.circuit: corner points and a rig → drive current → a trace of temperatures and heat flow."""

from thermicon.circuit.door import InputError
from thermicon.circuit.records import Record, RecordError, Table, load_records
from thermicon.circuit.module import Peltier
from thermicon.circuit.datasheet import Datasheet, Extraction
from thermicon.circuit.modules import load_module, module_names
from thermicon.circuit.receptors import ReceptorDepths
from thermicon.circuit.skin import Layer, Skin
from thermicon.circuit.rules import Limits, Rule
from thermicon.circuit.rigfile import RigError
from thermicon.circuit.rig import Rig, rig_names
from thermicon.circuit.drive import Drive, DriveError, read_drive
from thermicon.circuit.steady import hold, steady_state
from thermicon.circuit.inverse import Design, design, design_many
from thermicon.circuit.static import check_static
from thermicon.circuit.trace import Outcome, Trace, write_trace
from thermicon.circuit.simulate import duration_s, simulate, simulate_all, simulate_current
from thermicon.circuit.depths import Depths, Likeness, probe_depths, resembles
from thermicon.circuit.meshstudy import Mesh, MeshStudy, mesh_study
from thermicon.circuit.nearest import Nearest, nearest_reachable
from thermicon.circuit.many import TRACKINGS, Batch, simulate_many, simulate_stream, usual_tracking
from thermicon.circuit.exposure import cem43_min, henriques
from thermicon.circuit.limits import Check, SafetyVerdict, judge_safety
from thermicon.circuit.scenarios import Corner, Futures, corners_of, play_out
from thermicon.circuit.gate import Gate, gate
from thermicon.circuit.summary import Summary, summarise
from thermicon.circuit.netlist import netlist
from thermicon.circuit.devicefile import DeviceError
from thermicon.circuit.device import Device, device_names
from thermicon.circuit.samples import Samples
from thermicon.circuit.setpoints import Setpoints
from thermicon.circuit.realise import Realised, realise
from thermicon.circuit.difference import Difference, difference
from thermicon.circuit.events import Event, events_of
from thermicon.circuit.worstcase import worst_case
from thermicon.circuit.export import Prepared, Refusal, Verdict, pack, prepare

__all__ = [
    "InputError",
    "Record",
    "RecordError",
    "Table",
    "load_records",
    "Peltier",
    "Datasheet",
    "Extraction",
    "load_module",
    "module_names",
    "ReceptorDepths",
    "Layer",
    "Skin",
    "Limits",
    "Rule",
    "RigError",
    "Rig",
    "rig_names",
    "Drive",
    "DriveError",
    "read_drive",
    "hold",
    "steady_state",
    "Design",
    "design",
    "design_many",
    "check_static",
    "Outcome",
    "Trace",
    "write_trace",
    "duration_s",
    "simulate",
    "simulate_all",
    "simulate_current",
    "Depths",
    "Likeness",
    "probe_depths",
    "resembles",
    "Mesh",
    "MeshStudy",
    "mesh_study",
    "Nearest",
    "nearest_reachable",
    "TRACKINGS",
    "Batch",
    "simulate_many",
    "simulate_stream",
    "usual_tracking",
    "cem43_min",
    "henriques",
    "Check",
    "SafetyVerdict",
    "judge_safety",
    "Corner",
    "Futures",
    "corners_of",
    "play_out",
    "Gate",
    "gate",
    "Summary",
    "summarise",
    "netlist",
    "DeviceError",
    "Device",
    "device_names",
    "Samples",
    "Setpoints",
    "Realised",
    "realise",
    "Difference",
    "difference",
    "Event",
    "events_of",
    "worst_case",
    "Prepared",
    "Refusal",
    "Verdict",
    "pack",
    "prepare",
]
