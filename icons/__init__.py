"""Cue text to icons to corner points: the language of thermal icons.

The names below stand in the order of the flow; nothing heavier than the standard library is imported before it is used.
"""

from typing import TYPE_CHECKING

from .front_door import door

if TYPE_CHECKING:
    from .model.errors import CueErrors
    from .model.context import Context, Metadata
    from .model.icon import Icon
    from .model.family import Family
    from .model.iconset import IconSet
    from .files.shipped import library_names, load_library, read_cue
    from .pictures.gallery import library
    from .language.parse import parse
    from .language.layout import format_text
    from .files.exchange import to_json
    from .recordings.recorded import from_csv
    from .files.bibtex import bibtex
    from .files.methods import methods
    from .model.builders import back, cool, current, hold, play, ramp, repeat, rest, total, warm
    from .model.wave_builders import pulse, sawtooth, sine, square, step, triangle

# In the order of the flow, not of the alphabet.
__all__ = [
    "parse",
    "read_cue",
    "library_names",
    "load_library",
    "library",
    "format_text",
    "to_json",
    "from_csv",
    "methods",
    "bibtex",
    "CueErrors",
    "IconSet",
    "Icon",
    "Family",
    "Context",
    "Metadata",
    "cool",
    "warm",
    "ramp",
    "current",
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
]

if not TYPE_CHECKING:
    __getattr__ = door(
        __name__,
        {
            "model.errors": "CueErrors",
            "model.context": "Context Metadata",
            "model.icon": "Icon",
            "model.family": "Family",
            "model.iconset": "IconSet",
            "files.shipped": "library_names load_library read_cue",
            "pictures.gallery": "library",
            "language.parse": "parse",
            "language.layout": "format_text",
            "files.exchange": "to_json",
            "recordings.recorded": "from_csv",
            "files.bibtex": "bibtex",
            "files.methods": "methods",
            "model.builders": "back cool current hold play ramp repeat rest total warm",
            "model.wave_builders": "pulse sawtooth sine square step triangle",
        },
    )


def __dir__() -> list[str]:
    """Return the names of the front door, whether loaded yet or not."""
    return sorted({*globals(), *__all__})
