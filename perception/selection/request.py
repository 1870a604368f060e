"""The request for a choice and the reasons why it cannot be met."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from thermicon.base.checks.arguments import InputError, checked
from thermicon.base.words.near_words import did_you_mean
from thermicon.base.words.number_text import count_of

Objective = Literal["worst", "felt-and-named", "named", "bits", "bits-per-s"]


class ChoiceError(InputError):
    """The requested choice cannot be made; the text states why and what would help."""


class UndecidedError(ChoiceError):
    """It remains open whether any choice keeps the totals."""


@checked
@dataclass(frozen=True, slots=True)
class Selection:
    """A request: how many icons to choose, and what for; a `ChoiceError` for what cannot be requested of any set.

    Attributes
    ----------
    count
        Number of icons, 2 or more.
    objective
        What is maximised: `worst` (d′ of the worst pair), `felt-and-named`, `named`, `bits` or `bits-per-s`.
    must
        Names of icons that are in any choice.
    most_s, most_J
        Most time, s, that all chosen icons together last, and most energy, J, that they take of the driver; None: any.

    Examples
    --------
    >>> Selection(3, must=("a", "a")).must
    ('a',)
    """

    count: int
    objective: Objective = "worst"
    must: tuple[str, ...] = ()
    most_s: float | None = None
    most_J: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "must", tuple(dict.fromkeys(self.must)))
        if self.count < 2:
            raise ChoiceError(f"{self.count} cannot be chosen: at least 2 icons are needed to be distinguished")
        if len(self.must) > self.count:
            raise ChoiceError(f"{len(self.must)} icons must be among {self.count}: choose more, or ask for fewer")
        for name, most, unit in (("time", self.most_s, "s"), ("energy", self.most_J, "J")):
            if most is not None and not (math.isfinite(most) and most > 0):
                raise ChoiceError(f"the total {name} must be above 0, not {most:g} {unit}")


def check_selection(asked: Selection, names: Sequence[str]) -> None:
    """Raise `ChoiceError` for more icons than there are, or one that must be in and is not there."""
    if asked.count > len(names):
        raise ChoiceError(too_few(asked.count, len(names), ()))
    for name in asked.must:
        if name not in names:
            hint = did_you_mean(name, names)
            raise ChoiceError(f"no icon is called {name!r}, which must be among the chosen; {hint}")


def too_few(count: int, icons: int, excluded: Sequence[tuple[str, str]]) -> str:
    """Why so many of all icons cannot be chosen, with the first reasons of those that are excluded."""
    if not excluded:
        return f"{count} icons cannot be chosen: there {'is' if icons == 1 else 'are'} only {count_of(icons, 'icon')}"
    reasons = "; ".join(f"{name} {reason}" for name, reason in excluded[:3])
    more = f"; and {len(excluded) - 3} more" if len(excluded) > 3 else ""
    left = icons - len(excluded)
    rest = "none is left" if left == 0 else f"only {left} of {icons} are left"
    return f"{count} icons cannot be chosen: {rest} ({reasons}{more})"
