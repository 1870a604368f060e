"""Context and metadata of icons."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

from thermicon.base.words.clean_text import name_fault, text_fault

from .units import Control, fault

MOST_ELEMENTS = 100


@dataclass(frozen=True, slots=True)
class Context:
    """The controlled quantity (a temperature in °C, or under ``current`` a current in A), and the site on the body.

    ``baseline_C`` is the temperature from which icons start, −10 to 60 °C; None: that of the rig. ``site`` is a name,
    such as ``thenar``. ``elements`` are the names of display elements where there are several, 2 to 100, under control
    of a temperature. Raises ValueError for anything else.
    """

    control: Control = "skin"
    baseline_C: float | None = None
    site: str | None = None
    elements: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.elements and (refused := elements_fault(self.elements, self.control)):
            raise ValueError(f"elements: {refused[0]}; {refused[1]}")
        object.__setattr__(self, "elements", tuple(self.elements))
        if self.control not in get_args(Control):
            raise ValueError(f"control must be one of {', '.join(get_args(Control))}, not {self.control!r}")
        if self.site is not None and (wrong := name_fault(self.site)):
            raise ValueError(f"site: {wrong}")
        if self.baseline_C is not None:
            baseline = float(self.baseline_C) + 0.0
            if found := fault(baseline, "absolute"):
                raise ValueError(f"baseline_C: {found[1]}")
            object.__setattr__(self, "baseline_C", baseline)


def elements_fault(names: Sequence[str], control: Control) -> tuple[str, str] | None:
    """What keeps names from being the elements of a set, and the cure; None where nothing does."""
    if isinstance(names, str):
        return f"the text {names!r} is not a list of names", "give a tuple of names"
    if wrong := next(filter(None, map(name_fault, names)), None):
        return wrong, "a name has letters, digits and hyphens and begins with a letter"
    if "all" in names:
        return '"all" means every element, and cannot be the name of one', "give that element another name"
    if len(set(names)) < len(names):
        return "an element is named twice", "name each once"
    if len(names) < 2:
        return "a set for one element does not name it", 'leave out "elements", and "on" in the icons'
    if len(names) > MOST_ELEMENTS:
        return f"{len(names)} elements", f"a set has at most {MOST_ELEMENTS}"
    if control == "current":
        return "several elements take no current", 'write "control display" or "control skin"'
    return None


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
