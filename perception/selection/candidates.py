"""Members of families as a search varies them: parameters as shares between 0 and 1.

Found icons have names that say their numbers, no idle repeat, and tags that say where they come from.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from thermicon.icons import CueErrors, Family, Icon, IconSet
from thermicon.icons.model.parameter import Parameter
from thermicon.icons.model.statements import Repeat
from thermicon.icons.number_text import number

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
            places = np.unravel_index(index, [len(parameter) for parameter in family.parameters])
            found.append(
                candidate_at(family, [share_of(p, int(k)) for p, k in zip(family.parameters, places, strict=True)])
            )
    return [candidate for candidate in found if candidate is not None]


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


def names_of(found: Sequence[Candidate]) -> list[str]:
    """A name for each icon: that of a plain icon as it is, of a member its family's with the values of its parameters.

    >>> from thermicon.icons import read_cue
    >>> names_of([candidate_at(read_cue("search-space").families[0], [0.5, 0.33, 0.0, 0.9])])
    ['dip-3p5K-1p66Kps-0p5s-2x']
    """
    taken = [each.icon.name for each in found if each.family is None]
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
            taken.append(name)
        names.append(name)
    return names


def found_set(icons: IconSet, found: Sequence[Candidate], seed: int) -> IconSet:
    """The set that was searched with the found icons in place of its families; site, author and licence stay.

    Tags of a member say the search and its values.
    """
    made = []
    for each, name in zip(found, names_of(found), strict=True):
        icon = each.icon
        if each.family is not None:
            tags = (*icon.metadata.tags, FOUND, f"seed {seed}", f"from {icon.name.replace('_', ' ')}")
            icon = Icon(name, _unrepeated(icon.statements), icon.context, replace(icon.metadata, tags=tags))
        made.append(icon)
    name = f"{icons.name}-found" if icons.name else ""
    title = f"{icons.title}, found by search" if icons.title else "Found by search"
    return IconSet(name, title, icons.context, icons.metadata, tuple(made))


def chosen_set(icons: IconSet, names: Sequence[str], site: str) -> IconSet:
    """The chosen icons as a set, for this site unless it has one: members of families get numbers, and tags say which
    they were.

    >>> from thermicon.icons import read_cue
    >>> six = read_cue("six-icons")
    >>> [icon.name for icon in chosen_set(six, ["cooling-step", "warming-step"], "thenar")]
    ['cooling-step', 'warming-step']
    >>> pool = read_cue("search-space")
    >>> [icon.name for icon in chosen_set(pool, [icon.name for icon in pool][:2], "thenar")]
    ['dip-1', 'dip-2']
    """
    counts: dict[str, int] = {}
    context = replace(icons.context, site=icons.context.site or site)
    made = []
    for name in names:
        icon = replace(icons[name], context=context)
        family = next((each.name for each in icons.families if name.startswith(f"{each.name}_")), None)
        if family is not None:
            counts[family] = counts.get(family, 0) + 1
            tags = (*icon.metadata.tags, f"from {name.replace('_', ' ')}")
            spoken = f"{family}-{counts[family]}"
            icon = Icon(spoken, _unrepeated(icon.statements), context, replace(icon.metadata, tags=tags))
        made.append(icon)
    title = f"{icons.title}: the best {len(made)}" if icons.title else f"The best {len(made)}"
    return IconSet(f"{icons.name}-best" if icons.name else "", title, context, icons.metadata, tuple(made))


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
