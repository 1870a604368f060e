# The names of this package in the order of the flow; each is imported when it is first asked for.
from .rig.rigfile import InputError as InputError
from .rig.rig import Rig as Rig
from .rig.layout import Layout as Layout, Element as Element
from .rig.rules import Limits as Limits
from .solver.drive import Drive as Drive, read_drive as read_drive
from .solver.trace import Trace as Trace, Outcome as Outcome
from .solver.played import LayoutTrace as LayoutTrace
from .solver.simulate import simulate as simulate, simulate_current as simulate_current
from .solver.batch import simulate_many as simulate_many
from .solver.inverse import design as design
from .delivery.nearest import nearest_reachable as nearest_reachable
from .safety.gate import gate as gate, Gate as Gate
from .safety.session_plan import SessionPlan as SessionPlan
from .safety.session import Session as Session
from .safety.sessionplay import play_session as play_session
from .delivery.device import Device as Device
from .delivery.export import export as export, Export as Export
from .delivery.netlist import netlist as netlist
from .fitting.fit import fit as fit
from .live.play_live import play_live as play_live
