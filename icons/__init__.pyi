# The names of this package in the order of the flow; each is imported when it is first asked for.
from .language.parse import parse as parse
from .files.shipped import read_cue as read_cue, load_library as load_library, library as library
from .model.icon import Icon as Icon
from .model.iconset import IconSet as IconSet
from .model.family import Family as Family
from .model.spatial import SpatialIcon as SpatialIcon
from .model.errors import CueErrors as CueErrors
from .language.format_text import format_text as format_text
from .files.exchange import to_json as to_json
from .recordings.recorded import from_csv as from_csv, from_samples as from_samples
from .model.builders import cool as cool, warm as warm, ramp as ramp, current as current
from .model.builders import hold as hold, rest as rest, back as back
from .model.builders import step as step, pulse as pulse, wave as wave
from .model.builders import repeat as repeat, play as play, total as total
