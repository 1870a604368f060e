"""Icons that a search found, as plain icons: names that say their numbers, no idle repeat, and where they come from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from thermicon.icons.number_text import number

from .candidates import Candidate, value_at

if TYPE_CHECKING:
    from thermicon.icons import Icon, IconSet

UNITS = {"°C": "K", "K": "K", "°C/s": "Kps", "K/s": "Kps", "s": "s", "Hz": "Hz", "A": "A", "": "x"}
"""Units in names, which have letters and digits only; a number without a unit counts something."""


def names_of(found: Sequence[Candidate]) -> list[str]:
    """A name for each icon: that of a plain icon as it is, of a member its family's with the values of its parameters.

    >>> from thermicon.icons import read_cue
    >>> from thermicon.perception.selection.candidates import candidate_at
    >>> names_of([candidate_at(read_cue("search-space").families[0], [0.5, 0.33, 0.0, 0.9])])
    ['dip-3p5K-1p66Kps-0p5s-2x']
    """
    taken = [each.icon.name for each in found if each.family is None]
    names = []
    for each in found:
        name = each.icon.name
        if each.family is not None:
            pairs = zip(each.family.parameters, each.shares, strict=True)
            values = [(value_at(parameter, share), parameter.unit) for parameter, share in pairs]
            name = "-".join([each.family.name, *(_worded(value, unit) for value, unit in values)])
            again = 2
            while name in taken:
                name, again = f"{name.removesuffix(f'-{again - 1}')}-{again}", again + 1
            taken.append(name)
        names.append(name)
    return names


def plain_icons(found: Sequence[Candidate], seed: int) -> tuple[Icon, ...]:
    """The icons under those names; tags of a member say the search and its values."""
    from thermicon.icons import Icon

    made = []
    for each, name in zip(found, names_of(found), strict=True):
        icon = each.icon
        if each.family is not None:
            tags = (*icon.metadata.tags, "found by search", f"seed {seed}", f"from {icon.name.replace('_', ' ')}")
            icon = Icon(name, _unrepeated(icon.statements), icon.context, replace(icon.metadata, tags=tags))
        made.append(icon)
    return tuple(made)


def found_set(icons: IconSet, found: Sequence[Candidate], seed: int) -> IconSet:
    """The set that was searched with the found icons in place of its families; site, author and licence stay."""
    from thermicon.icons import IconSet

    name = f"{icons.name}-found" if icons.name else ""
    title = f"{icons.title}, found by search" if icons.title else "Found by search"
    return IconSet(name, title, icons.context, icons.metadata, plain_icons(found, seed))


def at_ends(found: Sequence[Candidate]) -> tuple[str, ...]:
    """Parameters of members that lie at an end of a range with a unit, each once.

    >>> from thermicon.icons import read_cue
    >>> from thermicon.perception.selection.candidates import candidate_at
    >>> at_ends([candidate_at(read_cue("search-space").families[0], [1.0, 0.33, 0.0, 0.9])])
    ('dip depth 6 °C',)
    """
    ends = []
    for each in found:
        for parameter, share in zip(each.family.parameters if each.family else (), each.shares, strict=True):
            if parameter.span is None or not parameter.unit or parameter.span[0] == parameter.span[1]:
                continue
            value = value_at(parameter, share)
            if each.family is not None and value in parameter.span[:2]:
                ends.append(f"{each.family.name} {parameter.name} {number(value, 2)} {parameter.unit}")
    return tuple(dict.fromkeys(ends))


def listed_only(found: Sequence[Candidate]) -> tuple[str, ...]:
    """Parameters with a unit that take listed values, each once."""
    return tuple(
        dict.fromkeys(
            f"{each.family.name} {parameter.name}"
            for each in found
            if each.family is not None
            for parameter in each.family.parameters
            if parameter.span is None and parameter.unit
        )
    )


def _worded(value: float, unit: str) -> str:
    return f"{number(abs(value), 2)}{UNITS.get(unit, '')}".replace(".", "p").replace("−", "m")


def _unrepeated(statements: Sequence[Any]) -> tuple[Any, ...]:
    """Statements with the bodies of `repeat 1` in its place."""
    from thermicon.icons.model.statements import Repeat

    made: list[Any] = []
    for each in statements:
        if isinstance(each, Repeat):
            body = _unrepeated(each.body)
            made += body if each.count == 1 else [replace(each, body=body)]
        else:
            made.append(each)
    return tuple(made)
