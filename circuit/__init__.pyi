# The names of this package in the order of the flow; each is imported when it is first asked for.
from .inputs import InputError as InputError
from .rig.rigfile import RigError as RigError
from .rig.rig import Rig as Rig, rig_names as rig_names
from .rig.datasheet import Datasheet as Datasheet
from .rig.rules import Limits as Limits
from .solver.drive import Drive as Drive, DriveError as DriveError, read_drive as read_drive
from .solver.steady import steady_state as steady_state
from .solver.inverse import design as design
from .solver.static import check_static as check_static
from .solver.trace import Trace as Trace, Outcome as Outcome, write_trace as write_trace
from .solver.simulate import (
    duration_s as duration_s,
    simulate as simulate,
    simulate_all as simulate_all,
    simulate_current as simulate_current,
)
from .solver.batch import simulate_many as simulate_many, simulate_stream as simulate_stream
from .safety.limits import judge_safety as judge_safety
from .safety.gate import gate as gate, Gate as Gate
from .safety.repeated import PauseError as PauseError
from .safety.sessionplan import SessionPlan as SessionPlan, SessionError as SessionError
from .safety.session import Session as Session
from .safety.sessionplay import play_session as play_session
from .safety.summary import summarise as summarise
from .safety.exposure import cem43_min as cem43_min, henriques as henriques
from .delivery.device import Device as Device, device_names as device_names
from .delivery.devicefile import DeviceError as DeviceError
from .delivery.formats.form import FormatError as FormatError
from .delivery.delivered_drive import DeliveredDrive as DeliveredDrive
from .delivery.deliver import deliver as deliver
from .delivery.netlist import netlist as netlist
from .delivery.prepare import Prepared as Prepared, prepare as prepare
from .delivery.refusal import Refusal as Refusal
from .delivery.pack import pack as pack
from .delivery.export import export as export, Export as Export, ExportError as ExportError
from .fitting.fit import fit as fit
from .fitting.rig_fit import RigFit as RigFit
from .delivery.nearest import nearest_reachable as nearest_reachable
