"""thermicon.circuit: corner points and a rig → drive current → a trace of temperatures and heat flow."""

from thermicon.circuit.door import InputError
from thermicon.circuit.records import Record, RecordError, Table, load_records
from thermicon.circuit.module import Peltier
from thermicon.circuit.datasheet import Datasheet, Extraction
from thermicon.circuit.modules import load_module, module_names
from thermicon.circuit.receptors import ReceptorDepths
from thermicon.circuit.skin import Layer, Skin
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
from thermicon.circuit.limits import SafetyVerdict, judge_safety
from thermicon.circuit.summary import Summary, summarise
from thermicon.circuit.netlist import netlist

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
    "SafetyVerdict",
    "judge_safety",
    "Summary",
    "summarise",
    "netlist",
]
