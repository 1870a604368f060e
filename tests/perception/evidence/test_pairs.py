"""The spread of pairs is what published shares of six icons ask for."""

from dataclasses import replace

import numpy as np
import pytest

from thermicon.base.files.records import Record, RecordTable
from thermicon.perception.evidence.pairs import BEST, MEAN, WORST, extremes, pair_spread
from thermicon.perception.observer.observer import load_thresholds


@pytest.fixture(scope="module")
def shipped() -> Record:
    return pair_spread(load_thresholds())


def named(mean: float, best: float, worst: float) -> RecordTable:
    """The table, with other shares of the six icons."""
    table, shares = load_thresholds(), {MEAN: mean, BEST: best, WORST: worst}
    records = [
        replace(each, value=shares[each.conditions]) if each.quantity == "icon identification" else each
        for each in table
    ]
    return RecordTable(table.name, tuple(records))


def test_icons_that_are_all_named_alike_ask_for_less_and_an_outlier_for_more(shipped: Record) -> None:
    alike, apart = pair_spread(named(0.91, 0.95, 0.86)), pair_spread(named(0.91, 1.0, 0.45))
    assert alike.central < 0.7 * shipped.central < shipped.central < apart.central
    assert alike.interval[0] < alike.central < alike.interval[1] < shipped.interval[1]


@pytest.mark.parametrize(("least", "most"), [(51, 80), (70, 79), (0, 80), (60, 60)])
def test_extremes_are_as_frequent_as_in_trials_that_are_played(least: int, most: int) -> None:
    p, chance = np.array([0.72, 0.9, 0.97]), np.random.default_rng(4)
    played = chance.binomial(80, p, size=(400_000, 3))
    share = np.mean((played.min(axis=1) == least) & (played.max(axis=1) == most))
    assert extremes(p[None], 80, least, most)[0] == pytest.approx(share, abs=4e-4)
