# The names of this package in the order of the flow; each is imported when it is first asked for.
from . import icons as icons, circuit as circuit, perception as perception, notebooks as notebooks
from .icons import parse as parse, read_cue as read_cue, load_library as load_library, Icon as Icon
from .circuit import Rig as Rig, simulate as simulate, Device as Device, export as export, InputError as InputError
from .perception import perceive as perceive, rank as rank
from .notebooks import overview as overview, Workbench as Workbench
