"""Members of families as a search varies them: parameters as shares between 0 and 1.

Found icons have names that say their numbers, no idle repeat, and tags that say where they come from.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from thermicon.base.words.number_text import number
from thermicon.circuit import Rig
from thermicon.icons import CueErrors, Family, Icon, IconSet
from thermicon.icons.model.context import Metadata
from thermicon.icons.model.parameter import Parameter
from thermicon.icons.model.statements import Repeat

MOVED = 0.5
FOUND = "found by search"
"""Tag of an icon that a search has found."""
FINE = 200
"""Parts of a span that a found value is rounded to, at least: 1 to 6 °C by 0.01 °C."""
UNITS = {"°C": "K", "K": "K", "°C/s": "Kps", "K/s": "Kps", "s": "s", "Hz": "Hz", "A": "A", "": "x"}
"""Units in names, which have letters and digits only; a number without a unit counts something."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """One icon that is tried: its family and a share, 0–1, for each parameter; no family for a plain icon."""

    icon: Icon
    family: Family | None = None
    shares: tuple[float, ...] = ()

    def moved(self, rng: np.random.Generator, step: float) -> Candidate | None:
        """The same family about half of whose parameters moved by a random step; None where that cannot be run."""
        if self.family is None:
            return None
        which = rng.random(len(self.shares)) < MOVED
        which[rng.integers(len(self.shares))] = True
        jump = np.clip(np.array(self.shares) + which * step * rng.normal(size=len(self.shares)), 0.0, 1.0)
        fresh = rng.random(len(self.shares))
        # A list has no neighbours: half of the time a listed value is drawn anew.
        listed = np.array([p.span is None or not p.unit for p in self.family.parameters])
        anew = which & listed & (rng.random(len(self.shares)) < MOVED)
        return candidate_at(self.family, np.where(anew, fresh, jump).tolist())


def candidate_at(family: Family, shares: Sequence[float]) -> Candidate | None:
    """The candidate at these shares, spans taken as continuous between their ends; None where it cannot be run."""
    values = {each.name: value_at(each, share) for each, share in zip(family.parameters, shares, strict=True)}
    try:
        return Candidate(family.variant(values), family, tuple(shares))
    except (CueErrors, ValueError):
        return None


def sample_candidates(families: Sequence[Family], count: int, rng: np.random.Generator) -> list[Candidate]:
    """Members of the families, as many of each: all that they count out where these are few, else drawn at random."""
    found: list[Candidate | None] = []
    each = max(2, count // len(families))
    for family in families:
        some = rng.choice(len(family), each, replace=False) if len(family) > each else np.arange(len(family))
        for index in np.sort(some):
            found.append(candidate_at(family, _shares(family, int(index))))
    return [candidate for candidate in found if candidate is not None]


def _shares(family: Family, place: int) -> tuple[float, ...]:
    """The shares of the member at a place of its family."""
    places = np.unravel_index(place, [len(parameter) for parameter in family.parameters])
    return tuple(share_of(each, int(k)) for each, k in zip(family.parameters, places, strict=True))


def value_at(parameter: Parameter, share: float) -> float:
    """Value of a parameter at a share of its range, in its unit: continuous in a span, else one of those listed."""
    if parameter.span is None or not parameter.unit:
        return parameter.value(min(int(share * len(parameter)), len(parameter) - 1))
    low, high, _ = parameter.span
    digits = math.ceil(math.log10(FINE / (high - low))) if high > low else 0
    return min(max(round(low + share * (high - low), digits), low), high)


def share_of(parameter: Parameter, place: int) -> float:
    """The share at which a parameter has the value that it counts at a place."""
    if parameter.span is None or not parameter.unit:
        return (place + 0.5) / len(parameter)
    low, high, _ = parameter.span
    return (parameter.value(place) - low) / (high - low) if high > low else 0.5


def members_of(icons: IconSet) -> list[Candidate]:
    """Every icon of a set, members of families with their shares."""
    every: list[Candidate] = []
    for entry in icons.entries:
        if isinstance(entry, Icon):
            every.append(Candidate(entry))
        else:
            every += [Candidate(icon, entry, _shares(entry, place)) for place, icon in enumerate(entry)]
    return every


def names_of(found: Sequence[Candidate]) -> list[str]:
    """A name for each icon: that of a plain icon as it is, of a member its family's with the values of its parameters.

    >>> from thermicon.icons import read_cue
    >>> names_of([candidate_at(read_cue("search-space").families[0], [0.5, 0.33, 0.0, 0.9])])
    ['dip-3p5K-1p66Kps-0p5s-2x']
    """
    taken = {each.icon.name for each in found if each.family is None}
    names = []
    for each in found:
        name = each.icon.name
        if each.family is not None:
            values = [
                f"{number(abs(value_at(parameter, share)), 2)}{UNITS.get(parameter.unit, '')}".replace(".", "p")
                for parameter, share in zip(each.family.parameters, each.shares, strict=True)
            ]
            name = "-".join([each.family.name, *values])
            again = 2
            while name in taken:
                name, again = f"{name.removesuffix(f'-{again - 1}')}-{again}", again + 1
            taken.add(name)
        names.append(name)
    return names


def set_of_run(icons: IconSet, found: Sequence[Candidate], rig: Rig, made: str, *tags: str) -> IconSet:
    """Icons that were found in a set, as a set of their own for the site, the baseline and the rig they were judged on.

    `made`, such as "best", says in its name what it is. Members of families become icons, with tags of their values.
    Its author and licence are for its author to state; an icon that stays as it was keeps its own.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> pool = read_cue("search-space")
    >>> best = set_of_run(pool, members_of(pool)[:2], Rig.load("forearm"), "best")
    >>> [icon.name for icon in best], best.context.site, best.metadata.tags
    (['dip-1K-1Kps-0p5s-1x', 'dip-1K-1Kps-0p5s-2x'], 'forearm', ('rig forearm',))
    """
    baseline = rig.skin.rest_C if icons.context.baseline_C is None else icons.context.baseline_C
    context = replace(icons.context, site=rig.site, baseline_C=baseline)
    entries = []
    for each, name in zip(found, names_of(found), strict=True):
        icon, facts = replace(each.icon, context=context), each.icon.metadata
        if each.family is not None:
            told = (*facts.tags, *tags, f"from {icon.name.replace('_', ' ')}")
            icon = Icon(name, _unrepeated(icon.statements), context, Metadata(facts.means, tags=told))
        entries.append(icon)
    title = f"{icons.title}: {made}" if icons.title else made.capitalize()
    of = tuple(each.replace(",", ";") for each in (f"rig {rig.name}", *rig.changes))
    return IconSet(
        f"{icons.name}-{made.split()[0]}" if icons.name else "", title, context, Metadata(tags=of), tuple(entries)
    )


def at_ends(found: Sequence[Candidate]) -> tuple[str, ...]:
    """Parameters of members that lie at an end of a range with a unit, each once.

    >>> from thermicon.icons import read_cue
    >>> at_ends([candidate_at(read_cue("search-space").families[0], [1.0, 0.33, 0.0, 0.9])])
    ('dip depth 6 °C',)
    """
    ends = []
    for each in found:
        for parameter, share in zip(each.family.parameters if each.family else (), each.shares, strict=True):
            value = value_at(parameter, share)
            low, high = (0.0, 0.0) if parameter.span is None or not parameter.unit else parameter.span[:2]
            if each.family is not None and low != high and value in (low, high):
                ends.append(f"{each.family.name} {parameter.name} {number(value, 2)} {parameter.unit}")
    return tuple(dict.fromkeys(ends))


def _unrepeated(statements: Sequence[Any]) -> tuple[Any, ...]:
    """Statements with the bodies of `repeat 1` in its place."""
    made: list[Any] = []
    for each in statements:
        if isinstance(each, Repeat):
            body = _unrepeated(each.body)
            made += body if each.count == 1 else [replace(each, body=body)]
        else:
            made.append(each)
    return tuple(made)
