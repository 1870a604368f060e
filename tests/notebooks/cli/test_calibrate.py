"""``thermicon calibrate``: what it refuses, and what it writes when chains have and have not converged."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from thermicon.perception.evidence import diagnostics, sampling
from thermicon.perception.evidence.diagnostics import Diagnostics
from thermicon.perception.evidence.posterior import Posterior
from thermicon.perception.evidence.sampling import Sampled, shipped_vector
from thermicon.perception.observer.draws import PosteriorDraws

Cli = Callable[..., Any]


@pytest.fixture(autouse=True)
def first_draw_is_nominal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Which draw is nominal takes a prediction of all evidence for each; `test_sampling.py` examines the choice."""
    monkeypatch.setattr(sampling, "in_the_middle", lambda *_: 0)


def sampled(r_hat: float) -> Sampled:
    posterior = Posterior()
    size = len(posterior.priors)
    chains = shipped_vector(posterior) + 0.3 * np.random.default_rng(0).standard_normal((4, 300, size))
    found = Diagnostics(posterior.priors.names, np.full(size, r_hat), np.full(size, 900.0))
    return Sampled(posterior, chains, np.zeros((4, 300)), 5000, 0.4, found, 0)


def test_draws_of_converged_chains_are_written(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sampling, "sample", lambda *_, **__: sampled(1.003))
    out = tmp_path / "mine.csv"
    said = cli("calibrate", "-o", out)
    assert said.exit_code == 0, said.stderr
    assert said.stderr == f"wrote {out}\n"
    words = " ".join(said.stdout.split())
    assert "Posterior of 52 constants, temperature" in words
    assert "R-hat up to 1.003, ESS from 900; 5000 likelihoods, 40 % accepted." in words
    draws = PosteriorDraws.load(out)
    assert len(draws) == 1000
    assert draws.header.converged


def test_what_did_not_converge_is_refused_and_marked_with_force(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sampling, "sample", lambda *_, **__: sampled(1.07))
    out = tmp_path / "mine.csv"
    said = cli("calibrate", "-o", out)
    assert said.exit_code == 3
    assert "was not written: cold conduction velocity has not converged (R-hat 1.070, limit 1.01" in said.stderr
    assert not out.exists()
    assert cli("calibrate", "-o", out, "--force").exit_code == 0
    with pytest.warns(UserWarning, match="NOT CONVERGED"):
        draws = PosteriorDraws.load(out)
    assert not draws.header.converged
    assert "NOT CONVERGED" in repr(draws)


def test_bad_options_are_refused_before_any_work(cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert "outside 100 to 100000" in cli("calibrate", "--steps", 5).stderr
    said = cli("calibrate", "-o", tmp_path / "mine.txt")
    assert said.exit_code == 1
    assert "a table of draws is written as .csv, not .txt" in said.stderr

    def absent() -> None:
        raise diagnostics.RecordError(diagnostics.EXTRA)

    monkeypatch.setattr(diagnostics, "require_extra", absent)
    said = cli("calibrate", "-o", tmp_path / "mine.csv")
    assert said.exit_code == 1
    assert 'not installed: pip install "thermicon[calibrate]"' in said.stderr


def test_draws_without_an_experiment_say_so() -> None:
    without = replace(sampled(1.0), posterior=Posterior(left_out=frozenset({"E3"})))
    assert without.draws().header.left_out == ("E3",)
