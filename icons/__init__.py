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
from thermicon.icons.family import Family
from thermicon.icons.slots import Slot
from thermicon.icons.iconset import IconSet, Members
from thermicon.icons.shipped import library_names, load_library, read_cue
from thermicon.icons.gallery import Library, library
from thermicon.icons.parse import parse
from thermicon.icons.layout import format_text
from thermicon.icons.statements import Change, Drive, Hold, Play, Repeat, Rest, Return, Statement, Total
from thermicon.icons.shapes import Pulse, Step, Wave
from thermicon.icons.write import back, cool, drive, hold, play, pulse, ramp, repeat, rest, sawtooth, sine, square, step
from thermicon.icons.write import total, triangle, warm

# In the order of the flow, not of the alphabet.
__all__ = [
    "parse",
    "read_cue",
    "library_names",
    "load_library",
    "library",
    "Library",
    "format_text",
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
    "cool",
    "warm",
    "ramp",
    "drive",
    "hold",
    "rest",
    "back",
    "step",
    "pulse",
    "sine",
    "square",
    "triangle",
    "sawtooth",
    "repeat",
    "play",
    "total",
    "ASSUMED_BASELINE_C",
    "Corners",
    "plot_icon",
]
