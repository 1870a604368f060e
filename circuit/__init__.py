"""thermicon.circuit: corner points and a rig → drive current → a trace of temperatures and heat flow."""

from thermicon.circuit.inputs import InputError
from thermicon.circuit.records import Record, RecordError, Table, load_records
from thermicon.circuit.rig.module import Peltier
from thermicon.circuit.rig.datasheet import Datasheet, Extraction
from thermicon.circuit.rig.modules import load_module, module_names
from thermicon.circuit.rig.receptors import ReceptorDepths
from thermicon.circuit.rig.skin import Layer, Skin
from thermicon.circuit.rig.rules import Limits, Rule
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.rig.rig import Rig, rig_names
from thermicon.circuit.solver.drive import Drive, DriveError, read_drive
from thermicon.circuit.solver.steady import hold, steady_state
from thermicon.circuit.solver.inverse import Design, design, design_many
from thermicon.circuit.solver.static import check_static
from thermicon.circuit.solver.trace import Outcome, Trace, write_trace
from thermicon.circuit.solver.simulate import duration_s, simulate, simulate_all, simulate_current
from thermicon.circuit.solver.depths import Depths, Likeness, probe_depths, resembles
from thermicon.circuit.studies.meshstudy import Mesh, MeshStudy, mesh_study
from thermicon.circuit.solver.nearest import Nearest, nearest_reachable
from thermicon.circuit.solver.batch import TRACKINGS, Batch, simulate_many, simulate_stream, usual_tracking
from thermicon.circuit.safety.exposure import cem43_min, henriques
from thermicon.circuit.safety.checks import Check
from thermicon.circuit.safety.limits import SafetyVerdict, judge_safety
from thermicon.circuit.safety.corners import Corner, corners_of
from thermicon.circuit.safety.scenarios import Futures, play_out
from thermicon.circuit.safety.demands import CutOff, Demands, PolarityCheck, SingleFault
from thermicon.circuit.safety.repeated import PauseError, Repeated
from thermicon.circuit.safety.gate import Gate, gate, gate_set
from thermicon.circuit.safety.sessionplan import SessionError, SessionPlan
from thermicon.circuit.safety.session import Play, Session
from thermicon.circuit.safety.sessionplay import play_session
from thermicon.circuit.safety.summary import Summary, summarise
from thermicon.circuit.delivery.netlist import netlist
from thermicon.circuit.delivery.devicefile import DeviceError
from thermicon.circuit.delivery.device import Device, device_names
from thermicon.circuit.delivery.samples import Samples
from thermicon.circuit.delivery.setpoints import Setpoints
from thermicon.circuit.delivery.realise import Realised, realise
from thermicon.circuit.solver.difference import Difference, difference
from thermicon.circuit.delivery.events import Event, events_of
from thermicon.circuit.delivery.worstcase import worst_case, worst_cases
from thermicon.circuit.delivery.export import Prepared, Verdict, pack, prepare, prepare_set
from thermicon.circuit.delivery.refusal import Refusal

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
    "CutOff",
    "Demands",
    "PolarityCheck",
    "SingleFault",
    "PauseError",
    "Repeated",
    "Gate",
    "gate",
    "gate_set",
    "SessionError",
    "SessionPlan",
    "Play",
    "Session",
    "play_session",
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
    "worst_cases",
    "Prepared",
    "Refusal",
    "Verdict",
    "pack",
    "prepare",
    "prepare_set",
]
