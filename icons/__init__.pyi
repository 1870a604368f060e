# The names of this package in the order of the flow; each is imported when it is first asked for.
from .language.parse import parse as parse
from .files.shipped import read_cue as read_cue, library_names as library_names, load_library as load_library
from .pictures.gallery import library as library
from .language.layout import format_text as format_text
from .files.exchange import to_json as to_json
from .recordings.recorded import from_csv as from_csv
from .files.methods import methods as methods
from .files.bibtex import bibtex as bibtex
from .model.errors import CueErrors as CueErrors
from .model.iconset import IconSet as IconSet
from .model.icon import Icon as Icon
from .model.family import Family as Family
from .model.context import Context as Context, Metadata as Metadata
from .model.builders import (
    cool as cool,
    warm as warm,
    ramp as ramp,
    current as current,
    hold as hold,
    rest as rest,
    back as back,
)
from .model.wave_builders import (
    step as step,
    pulse as pulse,
    sine as sine,
    square as square,
    triangle as triangle,
    sawtooth as sawtooth,
)
from .model.builders import repeat as repeat, play as play, total as total
