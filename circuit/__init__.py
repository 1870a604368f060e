"""thermicon.circuit: corner points and a rig → drive current → a trace of temperatures and heat flow → exported drives.

This is the front door, in the order of the flow; everything else is reached through its room, such as
`thermicon.circuit.rig` or `thermicon.circuit.safety`.
"""

from lazy_loader import attach_stub

from thermicon.base.checks.arguments import register

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)

register(
    "thermicon.icons",
    "thermicon.circuit",
    Rig='Rig.load("thenar")',
    Trace="simulate(icon)",
    Drive="Drive([0, 1], [0, 0.5])",
)
