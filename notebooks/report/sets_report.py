"""The comparison of two sets by identification."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermicon.base.words.number_text import count_of, number, percent

from .blocks import Block, Text, grid
from .rank_details import trouble_lines

if TYPE_CHECKING:
    from thermicon.perception import Ranking


def sets_report(names: tuple[str, str], sets: tuple[Ranking, Ranking]) -> list[Block]:
    """Report the scores of both, what 95 % of people reach with each, and how often one is named better."""
    from thermicon.perception.selection.appraise import REACHED_BY

    one, other = sets
    rows = [
        ("rig", *(each.rig for each in sets)),
        ("icons", *(str(len(each.icons)) for each in sets)),
        ("felt and named", *(percent(each.felt_and_named) for each in sets)),
        ("named", *(percent(each.proportion_correct) for each in sets)),
        ("information, bits", *(f"{each.information_bits:.2f}" for each in sets)),
        ("worst pair", *(" and ".join(each.worst_pair or ("–",)) for each in sets)),
        ("smallest d′", *(number(min(pair.d_prime for pair in each.pairs)) for each in sets)),
    ]
    tail = "These are predictions of a model, not measurements."
    if one.new_laboratory is not None and other.new_laboratory is not None:
        reached = (
            np.quantile(each.new_laboratory.persons["felt_and_named"], 1.0 - REACHED_BY)
            for each in sets
            if each.new_laboratory is not None
        )
        rows.insert(3, (f"{percent(REACHED_BY)} of people", *(f"from {percent(float(level))}" for level in reached)))
        share = one.new_laboratory.ahead_of(other.new_laboratory)
        better = names[0] if share >= 0.5 else names[1]
        points = 100.0 * abs(one.felt_and_named - other.felt_and_named)
        tail = (
            f"{percent(max(share, 1.0 - share))} of people feel and name {better} better, by {number(points)} points "
            f"in the mean, with the uncertainty of the model ({one.new_laboratory.draws} draws). {tail}"
        )
    crowd = count_of(one.people, "virtual person", "virtual people")
    lost = [
        Text(f"{name}: {line}", "warn")
        for name, each in zip(names, sets, strict=True)
        for line in trouble_lines(each.icons, {})
    ]
    return [grid(("", *names), rows, names), *lost, Text(f"For {crowd}. {tail}")]
