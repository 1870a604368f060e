"""Perceptual rows of a sweep."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

    from .ranking import Ranking

SITE, AGE = "site", "people.age_years"
"""A site is skin, contact and blood of a shipped rig: the only key whose values are names."""
OF_SITE = ("skin", "contact", "blood")
"""Tables of the rig file that come with a site; module, driver, heat sink and room stay."""
ALL = "all icons"
"""Name of the row of the whole set, which no icon can have."""
MEASURES: Mapping[str, tuple[str, ...]] = {
    "felt_and_named": ("felt_and_named", "felt_and_named_low", "felt_and_named_high"),
    "felt_and_named_95": ("felt_and_named_95",),
    "named": ("named", "named_low", "named_high"),
    "named_95": ("named_95",),
    "detected": ("detected", "detected_low", "detected_high"),
    "onset": ("onset_s", "onset_low_s", "onset_high_s"),
    "d_prime": ("d_prime", "d_prime_low", "d_prime_high"),
    "bits": ("bits", "bits_low", "bits_high"),
}
"""What can be measured, and its columns: the value and its 95 % interval for a new laboratory.

Those that end with `_95` are what 95 % of people reach, people and model together, as in a goal, without an interval.
"""
OF_95 = ("felt_and_named_95", "named_95")
OF_THE_SET = (*OF_95, "bits")
"""Measures that single icons do not have."""
REACHED = 0.05
"""The quantile of what 95 % of people reach, over people of all draws."""


def sites() -> tuple[str, ...]:
    """Sites of the shipped rigs that stand for them."""
    from thermicon.circuit import Rig
    from thermicon.circuit.rig.rig import rig_names

    return tuple(sorted(name for name in rig_names() if Rig.load(name).site == name))


def check_conditions(changes: Mapping[str, float | str], rig: Rig) -> None:
    """Raise an InputError for a site or an age that is not covered, and for a key that no rig has."""
    from thermicon.circuit import InputError
    from thermicon.circuit.rig.settings import put

    for key, value in changes.items():
        if key == SITE:
            if value not in sites():
                raise InputError(f"site={value}: there is no such site; there are {', '.join(sites())}")
        elif key == AGE:
            from ..observer.observer_model import ObserverModel

            try:
                ObserverModel.load().aged(float(value))
            except ValueError as problem:
                raise InputError(f"{AGE}={value:g}: {problem}") from None
        else:
            put(json.loads(rig.document), key, float(value))


def rig_under(rig: Rig, changes: Mapping[str, float | str]) -> Rig:
    """The rig under changed conditions: keys of its file, and the site, whose skin, contact and blood it takes."""
    from thermicon.circuit import Rig

    moved: dict[str, object] = {}
    if SITE in changes:
        document, now = json.loads(Rig.load(str(changes[SITE])).document), json.loads(rig.document)
        for table in OF_SITE:
            moved |= {f"{table}.{key}": None for key in now[table] if key not in document[table]}
            moved |= {f"{table}.{key}": value for key, value in document[table].items()}
    moved |= {key: value for key, value in changes.items() if key not in (SITE, AGE)}
    return rig.with_(**moved) if moved else rig


def measured_rows(
    icons: IconSet,
    rig: Rig,
    changes: Mapping[str, float | str],
    measures: Sequence[str],
    *,
    people: int = 60,
    parameters: int = 64,
    seed: int = 0,
) -> dict[str, dict[str, float | None]]:
    """Rank a set under changed conditions and return, by the name of each icon and `ALL`, columns of `MEASURES`.

    Confusions are with the whole set; `changes` are keys of the rig file, `site` and `people.age_years` with their
    values, `measures` names out of `MEASURES`. People, draws (`parameters`) and seed are as in `rank`, the same at
    every value. Bits and what 95 % of people reach, which needs draws, are of the set alone. d′ is that of the nearest
    other icon, of the set that of the nearest pair.
    """
    from ..observer.observer_model import ObserverModel
    from .rank import rank

    model = ObserverModel.load()
    if AGE in changes:
        model = model.aged(float(changes[AGE]))
    found = rank(icons, rig_under(rig, changes), people=people, parameters=parameters, seed=seed, observer=model)
    rows = {ALL: _of_set(found), **{name: _of_icon(found, place) for place, name in enumerate(found.labels)}}
    wanted = [column for measure in measures for column in MEASURES[measure]]
    return {name: {column: row.get(column) for column in wanted} for name, row in rows.items()}


def _of_set(found: Ranking) -> dict[str, Any]:
    shares = {"felt_and_named": found.felt_and_named, "named": found.proportion_correct}
    row: dict[str, Any] = {**shares, **_nearest(found, None)}
    lab = found.new_laboratory
    if len(found.icons) > 1:
        row["bits"] = found.information_bits
    if lab is not None:
        for name, (low, high) in (("felt_and_named", lab.felt_and_named), ("named", lab.proportion_correct)):
            reached = float(np.quantile(lab.persons[name], REACHED))
            row |= {f"{name}_low": low, f"{name}_high": high, f"{name}_95": reached}
        if len(found.icons) > 1:
            row["bits_low"], row["bits_high"] = lab.information_bits
    return row


def _of_icon(found: Ranking, place: int) -> dict[str, Any]:
    icon, lab = found.icons[place], found.new_laboratory
    row: dict[str, Any] = {
        "felt_and_named": icon.felt_and_named,
        "named": icon.proportion_correct,
        "detected": icon.detected_probability,
        "onset_s": icon.onset_s,
        **_nearest(found, icon.name),
    }
    if lab is not None:
        row["felt_and_named_low"], row["felt_and_named_high"] = lab.each_felt_and_named[place]
        row["detected_low"], row["detected_high"] = lab.detected[place]
        row["onset_low_s"], row["onset_high_s"] = lab.onset_s[place] or (None, None)
    return row


def _nearest(found: Ranking, name: str | None) -> dict[str, Any]:
    """d′ of the nearest pair, of those with one icon where it is named."""
    pairs = [pair for pair in found.pairs if name is None or name in (pair.a, pair.b)]
    if not pairs:
        return {}
    pair = min(pairs, key=lambda each: each.d_prime)
    row: dict[str, Any] = {"d_prime": pair.d_prime}
    if found.new_laboratory is not None:
        i, j = found.labels.index(pair.a), found.labels.index(pair.b)
        row["d_prime_low"], row["d_prime_high"] = found.new_laboratory.pair(i, j)
    return row
