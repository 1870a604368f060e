"""Context and metadata of icons."""

from dataclasses import dataclass
from typing import get_args

from thermicon.base.words.clean_text import name_fault, text_fault

from .units import Control, fault


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
