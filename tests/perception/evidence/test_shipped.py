"""The shipped results against their inputs."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from thermicon.perception.evidence.posterior import Posterior
from thermicon.perception.evidence.results import (
    ABLATION,
    CONSTANTS,
    PREDICTIONS,
    inputs_digest,
    load_constants,
    load_predictions,
)
from thermicon.perception.evidence.rows import load_rows
from thermicon.perception.evidence.sampling import shipped_vector
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.observer.draws_file import current_inputs
from thermicon.perception.observer.observer import DATA


@pytest.fixture(scope="module")
def vector() -> np.ndarray:
    return shipped_vector(Posterior())


@pytest.mark.parametrize("name", [CONSTANTS, PREDICTIONS])
def test_tables_were_made_from_the_shipped_inputs(name: str) -> None:
    cure = "made from other evidence or priors: python -m thermicon.perception.evidence fit"
    assert current_inputs(DATA / name) == inputs_digest(), cure


@pytest.mark.parametrize("name", [ABLATION, "influence.csv", "left-out.csv", "variant-scores.csv"])
def test_finished_tables_name_the_version_and_the_inputs_that_made_them(name: str) -> None:
    with (DATA / name).open(encoding="utf-8") as file:
        assert re.match(r"# made by thermicon \d+\.\d+\.\d+ .*inputs [0-9a-f]{16}", file.readline())


def test_constants_give_the_shipped_predictions_and_miss_no_row_by_far(vector: np.ndarray) -> None:
    predictions, rows = Posterior().predictions(vector), {row.key: row for row in load_rows()}
    for shipped in load_predictions():
        row = rows[shipped.experiment, shipped.statistic, shipped.channel]
        predicted = predictions[row.key]
        assert row.shown(predicted) == pytest.approx(shipped.fitted, rel=2e-3, abs=2e-3)
        assert abs(predicted - row.value) < 3.5 * row.sd, row.label


def test_constants_are_a_maximum(vector: np.ndarray) -> None:
    posterior = Posterior()
    best = float(np.square(posterior.residuals(vector)).sum())
    rng = np.random.default_rng(0)
    for _ in range(12):
        step = rng.standard_normal(vector.size)
        away = vector + 0.5 * step / np.linalg.norm(step)
        assert float(np.square(posterior.residuals(away)).sum()) > best


def test_left_out_intervals_cover_and_contain_their_middle() -> None:
    rows = load_predictions()
    covered = [row.left_out_low <= row.published <= row.left_out_high for row in rows]
    assert sum(covered) >= 0.88 * len(rows)
    assert all(row.left_out_low < row.left_out < row.left_out_high for row in rows)


def test_draws_lie_around_the_maximum_and_fit_as_well() -> None:
    draws, posterior = PosteriorDraws.load(), Posterior()
    assert draws.header.converged and draws.header.left_out == ()
    for each in load_constants():
        low, _, high = draws.interval(each.name, 0.98)
        assert low < each.value < high, each.name
    priors = posterior.priors
    for k in range(0, 1000, 250):
        places = priors.places(dict(draws.draw(k)))
        residuals = posterior.residuals((places - priors.middle) / priors.sd)
        # Twice the negative log density of a draw is about that of the maximum plus the number of constants.
        assert 60.0 < float(np.square(residuals).sum()) < 190.0


@pytest.mark.slow
def test_sampling_makes_draws_of_the_shipped_distribution_from_their_seed(tmp_path: Path) -> None:
    """Six minutes of processor time. The draws themselves are the same only where a computer rounds alike."""
    made = tmp_path / "draws.csv"
    command = [sys.executable, "-m", "thermicon.perception.evidence", "sample", "--seed", "0", "-o", made]
    subprocess.run(command, check=True, capture_output=True)
    shipped, own = PosteriorDraws.load(), PosteriorDraws.load(made)
    assert (own.names, own.draws.shape) == (shipped.names, shipped.draws.shape)
    assert (own.header.evidence, own.header.priors) == (shipped.header.evidence, shipped.header.priors)
    spread = shipped.draws.std(axis=0)
    # With 400 effective draws each, means differ by 0.07 of the spread (1 SD), widths of intervals by 5 %.
    assert (np.abs(own.draws.mean(axis=0) - shipped.draws.mean(axis=0)) / spread).max() < 0.35
    # Not the SD: the slope of sensation has a tail of which a few draws decide it.
    ends = (np.quantile(each.draws, (0.05, 0.95), axis=0) for each in (own, shipped))
    own_width, shipped_width = (high - low for low, high in ends)
    assert np.abs(np.log(own_width / shipped_width)).max() < 0.3
