"""thermicon.circuit: corner points and a rig → drive current → a trace of temperatures and heat flow."""

from .inputs import InputError
from .records import Record, RecordError, Table, load_records
from .rig.module import Peltier
from .rig.datasheet import Datasheet, Extraction
from .rig.modules import load_module, module_names
from .rig.receptors import ReceptorDepths
from .rig.skin import Layer, Skin
from .rig.rules import Limits, Rule
from .rig.rigfile import RigError
from .rig.rig import Rig, rig_names
from .solver.drive import Drive, DriveError, read_drive
from .solver.steady import steady_state, state_under_current
from .solver.inverse import Design, design, design_many
from .solver.static import check_static
from .solver.trace import Outcome, Trace, write_trace
from .solver.simulate import duration_s, simulate, simulate_all, simulate_current
from .studies.depths import Depths, Likeness, probe_depths, resembles
from .studies.meshstudy import Mesh, MeshStudy, mesh_study
from .studies.nearest import Nearest, nearest_reachable
from .solver.batch import TRACKINGS, Batch, simulate_many, simulate_stream, usual_tracking
from .safety.exposure import cem43_min, henriques
from .safety.checks import Check
from .safety.limits import SafetyVerdict, judge_safety
from .safety.corners import Corner, corners_of
from .safety.scenarios import Futures, play_out
from .safety.demands import CutOff, Demands, PolarityCheck, SingleFault
from .safety.repeated import PauseError, Repeated
from .safety.gate import Gate, gate, gate_set
from .safety.sessionplan import SessionError, SessionPlan
from .safety.session import Play, Session
from .safety.sessionplay import play_session
from .safety.summary import Summary, summarise
from .delivery.netlist import netlist
from .delivery.devicefile import DeviceError
from .delivery.device import Device, device_names
from .delivery.samples import Samples
from .delivery.setpoints import Setpoints
from .delivery.deliver import DeliveredDrive, deliver
from .solver.delivery_deviation import DeliveryDeviation, delivery_deviation
from .delivery.events import Event, events_of
from .packing.worstcase import worst_case, worst_cases
from .packing.export import Prepared, Verdict, pack, prepare, prepare_set
from .packing.refusal import Refusal

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
    "steady_state",
    "state_under_current",
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
    "DeliveredDrive",
    "deliver",
    "DeliveryDeviation",
    "delivery_deviation",
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
