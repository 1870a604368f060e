"""The shipped results: made from the shipped inputs, and at a maximum of the posterior."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from thermicon.perception.evidence.posterior import Posterior
from thermicon.perception.evidence.results import (
    ABLATION,
    CONSTANTS,
    PREDICTIONS,
    constant,
    inputs_digest,
    load_ablation,
    load_constants,
    load_predictions,
)
from thermicon.perception.evidence.rows import load_rows
from thermicon.perception.evidence.statistics import DATA
from thermicon.perception.observer.draws_file import current_inputs
from thermicon.perception.observer.mechanisms import MECHANISMS


@pytest.fixture(scope="module")
def vector() -> np.ndarray:
    posterior = Posterior()
    places = posterior.priors.places({each.name: each.value for each in load_constants()})
    return (places - posterior.priors.middle) / posterior.priors.sd


@pytest.mark.parametrize("name", [CONSTANTS, PREDICTIONS])
def test_tables_were_made_from_the_shipped_inputs(name: str) -> None:
    assert current_inputs(DATA / name) == inputs_digest()


@pytest.mark.parametrize("name", [ABLATION, "variant-scores.csv", "memory_forms.csv"])
def test_finished_tables_name_the_version_and_the_inputs_that_made_them(name: str) -> None:
    with (DATA / name).open(encoding="utf-8") as file:
        assert re.match(r"# made by thermicon \d+\.\d+\.\d+ .*inputs [0-9a-f]{16}", file.readline())


def test_constants_give_the_shipped_predictions(vector: np.ndarray) -> None:
    predictions = Posterior().predictions(vector)
    shipped = {(row.experiment, row.statistic, row.channel): row for row in load_predictions()}
    for row in load_rows():
        assert row.shown(predictions[row.key]) == pytest.approx(shipped[row.key].fitted, rel=2e-3, abs=2e-3)


def test_constants_are_a_maximum(vector: np.ndarray) -> None:
    posterior = Posterior()
    best = float(np.square(posterior.residuals(vector)).sum())
    rng = np.random.default_rng(0)
    for _ in range(12):
        step = rng.standard_normal(vector.size)
        away = vector + 0.5 * step / np.linalg.norm(step)
        assert float(np.square(posterior.residuals(away)).sum()) > best


def test_no_row_that_was_fitted_is_far_off() -> None:
    shipped = {(row.experiment, row.statistic, row.channel): row for row in load_predictions()}
    for row in load_rows():
        fitted = math.log(shipped[row.key].fitted) if row.log else shipped[row.key].fitted
        assert abs(fitted - row.value) < 3.5 * row.sd, row.label


def test_left_out_intervals_cover_and_contain_their_middle() -> None:
    rows = load_predictions()
    covered = [row.left_out_low <= row.published <= row.left_out_high for row in rows]
    assert sum(covered) >= 0.88 * len(rows)
    assert all(row.left_out_low < row.left_out < row.left_out_high for row in rows)


def test_ablation_has_every_mechanism_and_variant() -> None:
    table = load_ablation()
    assert {row.without for row in table} >= {each.name for each in MECHANISMS} | {"", "all of them"}
    whole = [row for row in table if not row.without]
    assert [row.variable for row in whole] == ["temperature", "heat flow"]
    assert whole[0].difference == 0.0


def test_an_unknown_constant_names_the_nearest() -> None:
    with pytest.raises(ValueError, match=r"no constant 'warm limt'.*warm limit"):
        constant("warm limt")
