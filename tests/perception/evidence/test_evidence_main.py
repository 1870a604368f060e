"""``python -m thermicon.perception.evidence`` at the command line."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from thermicon.perception.evidence import __main__ as main_module
from thermicon.perception.evidence import sampling
from thermicon.perception.evidence.__main__ import main
from thermicon.perception.evidence.chains import Diagnostics
from thermicon.perception.evidence.posterior import Posterior
from thermicon.perception.evidence.sampling import SampledPosterior, shipped_vector
from thermicon.perception.observer.draws import PosteriorDraws


@pytest.fixture(autouse=True)
def first_draw_is_nominal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Which draw is nominal takes a prediction of all evidence for each; `test_sampling.py` examines the choice."""
    monkeypatch.setattr(sampling, "in_the_middle", lambda *_: 0)


def sampled(r_hat: float) -> SampledPosterior:
    posterior = Posterior()
    size = len(posterior.priors)
    chains = shipped_vector(posterior) + 0.3 * np.random.default_rng(0).standard_normal((4, 300, size))
    found = Diagnostics(posterior.priors.names, np.full(size, r_hat), np.full(size, 900.0))
    return SampledPosterior(posterior, chains, 5000, found, 0)


def test_draws_of_converged_chains_are_written_and_others_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(main_module, "sample", lambda *_, **__: sampled(1.07))
    out = tmp_path / "mine.csv"
    assert main(["sample", "-o", str(out)]) == 3
    said = capsys.readouterr()
    assert "not converged, worst cold conduction velocity: R-hat up to 1.070" in said.out
    assert "nothing was written" in said.err
    assert not list(tmp_path.iterdir())
    monkeypatch.setattr(main_module, "sample", lambda *_, **__: sampled(1.003))
    assert main(["sample", "-o", str(out)]) == 0
    assert "R-hat up to 1.003, ESS from 900" in capsys.readouterr().out
    draws = PosteriorDraws.load(out)
    assert len(draws) == 1000
    assert draws.header.converged


@pytest.mark.parametrize("words", [("sample", "--steps", "5"), ("guess",), ()])
def test_bad_options_are_refused_before_any_work(words: tuple[str, ...]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(words)
    assert stopped.value.code == 2


def test_draws_without_an_experiment_say_so() -> None:
    without = replace(sampled(1.0), posterior=Posterior(left_out=frozenset({"E3"})))
    assert without.draws().header.left_out == ("E3",)
