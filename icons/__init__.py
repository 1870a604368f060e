"""Cue text to icons to corner points: the language of thermal icons.

The names below stand in the order of the flow; nothing heavier than the standard library is imported before it is used.
"""

from thermicon.icons.check import ASSUMED_BASELINE_C
from thermicon.icons.corners import Corners
from thermicon.icons.draw import plot_icon
from thermicon.icons.errors import CueError, CueErrors
from thermicon.icons.frame import Frame, Metadata
from thermicon.icons.parameter import Parameter
from thermicon.icons.icon import Icon
from thermicon.icons.family import Family, Slot
from thermicon.icons.iconset import IconSet, Members
from thermicon.icons.shipped import library_names, load_library, read_cue
from thermicon.icons.parse import parse
from thermicon.icons.statements import Change, Drive, Hold, Play, Repeat, Rest, Return, Statement, Total
from thermicon.icons.shapes import Pulse, Step, Wave

# In the order of the flow, not of the alphabet.
__all__ = [
    "parse",
    "read_cue",
    "library_names",
    "load_library",
    "CueError",
    "CueErrors",
    "IconSet",
    "Members",
    "Icon",
    "Family",
    "Parameter",
    "Slot",
    "Frame",
    "Metadata",
    "Statement",
    "Change",
    "Drive",
    "Hold",
    "Rest",
    "Return",
    "Step",
    "Pulse",
    "Wave",
    "Repeat",
    "Play",
    "Total",
    "ASSUMED_BASELINE_C",
    "Corners",
    "plot_icon",
]
