"""Thresholds by bisection are those of a scan of all sizes; what is left out of a computation changes nothing."""

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.perception import Observer, draw_people
from thermicon.perception.evidence.predicted import plausible_observers
from thermicon.perception.experiments import classical
from thermicon.perception.experiments.classical import method_of_limits
from thermicon.perception.experiments.measured import crowd_of
from thermicon.perception.experiments.ramps import SIZES_K, ramps, size_reaching
from thermicon.perception.observer.variants import VARIABLES
from thermicon.perception.sensation.bench import Bench


@pytest.fixture(scope="module")
def bench() -> Bench:
    return Bench(Rig.load("hand-dorsum"), surface="display")


@pytest.mark.parametrize("variable", VARIABLES)
def test_what_is_felt_and_reported_rises_with_size(variable: str, bench: Bench) -> None:
    """Bisection needs it, for every variant and for observers far from the nominal one."""
    for observer in plausible_observers(4, 1, variable=variable):  # type: ignore[arg-type]
        nobody = crowd_of(observer, bench.rig.site, None)
        for channel in ("cold", "warm"):
            played = ramps(bench, channel, 1.0, 1.0)  # type: ignore[arg-type]
            peaks = np.array([played.peak(k, observer, nobody)[0] for k in range(SIZES_K.size)])
            assert (np.diff(peaks) >= -1e-9).all()
            reported = np.array([played.reported(k, observer, nobody)[0] for k in range(SIZES_K.size)])
            inside = (reported > 0.01) & (reported < 0.99)
            assert (np.diff(reported[inside]) > 0.0).all()


def test_the_peak_is_that_of_the_whole_course(bench: Bench) -> None:
    observer, people = Observer.load(), draw_people(3, seed=2)
    crowd = crowd_of(observer, bench.rig.site, people)
    played = ramps(bench, "cold", 1.0, 1.0)
    courses = played.played(20).felt(observer, crowd.threshold_cold, crowd.threshold_warm)
    largest = np.maximum(*((psi - psi[..., :1]).max(axis=-1) for psi in courses))[:, 0]
    assert played.peak(20, observer, crowd) == pytest.approx(largest, rel=1e-12)


def test_bisection_finds_what_a_scan_finds() -> None:
    rng = np.random.default_rng(0)
    values = np.cumsum(rng.random((5, SIZES_K.size)), axis=1)
    asked: list[int] = []

    def at(k: int) -> np.ndarray:
        asked.append(k)
        return values[:, k]

    reached = size_reaching(at, SIZES_K, 7.0)
    for person, own in enumerate(values):
        k = int(np.argmax(own >= 7.0))
        share = (7.0 - own[k - 1]) / (own[k] - own[k - 1])
        assert reached[person] == pytest.approx(SIZES_K[k - 1] * (SIZES_K[k] / SIZES_K[k - 1]) ** share)
    assert len(asked) == len(set(asked)) < SIZES_K.size
    assert np.isinf(size_reaching(at, SIZES_K, 1e9)).all()
    with pytest.raises(ValueError, match=r"a step of 0.005 K is felt already"):
        size_reaching(at, SIZES_K, -1.0)


def test_slow_ramps_lack_the_sizes_that_take_too_long(bench: Bench) -> None:
    assert ramps(bench, "warm", 0.01, 1.0).sizes_K[-1] <= 6.0 < SIZES_K[-1]


def test_the_start_of_a_ramp_is_enough_for_limits(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    people = draw_people(30, seed=5)
    soon = method_of_limits(Observer.load(), bench, "warm", people=people).each
    monkeypatch.setattr(classical, "EARLY", 1.0)
    assert soon.tolist() == method_of_limits(Observer.load(), bench, "warm", people=people).each.tolist()
