"""Context and metadata of icons; which names and texts are allowed; how untrusted text is made safe to print.

Control characters steer terminals (colours, window titles, a cursor that overwrites a verdict), and marks of writing
direction make a line read differently from what it is. Names and titles do not take them; messages show "�" instead.
"""

import re
import unicodedata
from dataclasses import dataclass
from typing import get_args

from .units import Control, fault

_WORD = r"[^\W\d_](?:[^\W_]|-)*"
# Members of a family are named after their values: ramp_amount=-6_rate=1.
_NAME = re.compile(rf"{_WORD}(?:_{_WORD}=-?[0-9]+(?:\.[0-9]+)?(?:e-?[0-9]+)?)*")

# Joiners and the soft hyphen are part of ordinary words in many scripts.
_HARMLESS = "\u00ad\u200c\u200d"
_PLAIN = re.compile(r"[ -~\n\t]*")


def acts(char: str) -> bool:
    """Tell whether a character is a control, a mark of writing direction, a line separator or half a character.

    >>> acts("\\x1b"), acts("\\u202e"), acts("\\u2028"), acts("é"), acts("°")
    (True, True, True, False, False)
    """
    return unicodedata.category(char) in ("Cc", "Cf", "Cs", "Zl", "Zp") and char not in _HARMLESS


def first_control(text: str, allowed: str = "") -> str | None:
    """Return the first character that acts, as in U+001B, or None; those in ``allowed`` may stand.

    >>> first_control("a\\x1b[2J"), first_control("two\\nlines", "\\n")
    ('U+001B', None)
    """
    if text.isprintable():  # said by the interpreter at once; a rig file has thousands of letters
        return None
    bad = next((char for char in text if not char.isprintable() and char not in allowed and acts(char)), None)
    return None if bad is None else f"U+{ord(bad):04X}"


def clean(text: str) -> str:
    """Return a text as it may be shown on a terminal: line ends and tabs stay, what else acts becomes "�".

    >>> clean("drive.csv\\x1b]0;mine\\x07: is\\nred")
    'drive.csv�]0;mine�: is\\nred'
    """
    if _PLAIN.fullmatch(text):
        return text
    return "".join(char if char in "\n\t" or not acts(char) else "�" for char in text)


def clean_line(text: str) -> str:
    """Return a text as one line that may be shown: line ends and tabs become "�" too.

    >>> clean_line("x\\ny")
    'x�y'
    """
    return clean(text).replace("\n", "�").replace("\t", "�")


def name_fault(name: str) -> str | None:
    """Return what keeps a text from being a name, or None.

    >>> name_fault("cooling-step"), name_fault("3rd")
    (None, "'3rd' is not a name: letters, digits and hyphens, beginning with a letter")
    """
    if _NAME.fullmatch(name):
        return None
    return f"{name!r} is not a name: letters, digits and hyphens, beginning with a letter"


def text_fault(text: str) -> str | None:
    """Return what keeps a text out of metadata, or None: it must show something and hold no control characters."""
    if not text.strip():
        return "the text is empty"
    bad = first_control(text, "\n\t")
    return f"the text holds the control character {bad}" if bad else None


@dataclass(frozen=True, slots=True)
class Context:
    """The controlled quantity (a temperature in °C, or under ``current`` a current in A), and the site on the body.

    ``baseline_C`` is the temperature from which icons start, −10 to 60 °C; None: that of the rig. ``site`` is a name,
    such as ``thenar``. Raises ValueError for anything else.
    """

    control: Control = "skin"
    baseline_C: float | None = None
    site: str | None = None

    def __post_init__(self) -> None:
        if self.control not in get_args(Control):
            raise ValueError(f"control must be one of {', '.join(get_args(Control))}, not {self.control!r}")
        if self.site is not None and (wrong := name_fault(self.site)):
            raise ValueError(f"site: {wrong}")
        if self.baseline_C is not None:
            baseline = float(self.baseline_C) + 0.0
            if found := fault(baseline, "absolute"):
                raise ValueError(f"baseline_C: {found[1]}")
            object.__setattr__(self, "baseline_C", baseline)


@dataclass(frozen=True, slots=True)
class Metadata:
    """Facts about an icon or a set: what it ``means``, author, DOI, licence, words for finding it.

    Raises ValueError for an empty text, control characters, and a tag with a comma.
    """

    means: str | None = None
    by: str | None = None
    doi: str | None = None
    licence: str | None = None
    tags: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if isinstance(self.tags, str):
            raise ValueError(f"tags must be a tuple of texts, not the text {self.tags!r}")
        object.__setattr__(self, "tags", tuple(dict.fromkeys(self.tags)))
        for key in ("means", "by", "doi", "licence"):
            value = getattr(self, key)
            if value is not None and (wrong := text_fault(value)):
                raise ValueError(f"{key}: {wrong}")
        for tag in self.tags:
            if (wrong := text_fault(tag)) or "," in tag or tag != tag.strip():
                raise ValueError(f"tags: {wrong or f'{tag!r} has a comma or spaces around it'}")
