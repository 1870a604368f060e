from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from thermicon.perception import Observer, Percept, perceive
from thermicon.perception.observer.constants import Both
from thermicon.perception.sensation.percept import on_one_clock
from thermicon.perception.sensation.received import uniform_clock


def test_a_cooling_is_felt_cold(cue: Any, observer: Observer) -> None:
    percept = perceive(cue(change=-4.0, name="dip"), observer)
    assert (percept.channel, percept.icon, percept.outside_data) == ("cold", "dip", ())
    assert percept.detected_probability == pytest.approx(1.0)
    assert 0.55 < percept.onset_s < 0.8
    assert repr(percept).startswith("Percept(dip, nominal person: felt at 0.")
    assert not percept.psi_cold.flags.writeable
    far = perceive(cue(change=-19.0), observer)
    assert "13" in far.outside_data[0] and repr(far).endswith("receptor clock, outside the data)")


def test_the_words_follow_from_the_probability(cue: Any, observer: Observer) -> None:
    """Just below and just above one half, found by bisection of the size of a cooling."""
    low, high = 0.05, 4.0
    for _ in range(12):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if perceive(cue(change=-middle), observer).felt else (middle, high)
    unfelt, felt = perceive(cue(change=-low), observer), perceive(cue(change=-high), observer)
    assert unfelt.detected_probability < 0.5 <= felt.detected_probability < 0.52
    assert unfelt.summary == f"not felt, p {unfelt.detected_probability:.3f}"
    assert felt.summary == f"felt at {felt.onset_s:.2f} s by cold, p {felt.detected_probability:.3f}"
    nothing = perceive(cue(change=0.0), observer)
    for percept in (unfelt, nothing):
        assert (percept.onset_s, percept.channel) == (None, None)
    assert nothing.detected_probability == pytest.approx(0.0, abs=1e-6)


FLAT = np.zeros(3)


@pytest.mark.parametrize(
    ("made", "said"),
    [
        ((FLAT, FLAT, 0.01, None, None, 0.961), r"an onset and a channel belong to an icon that is felt .*p 0\.961"),
        ((FLAT, FLAT, 0.01, 1.0, "cold", 0.4), r"onset_s = 1\.0, channel = cold, p 0\.4"),
        ((FLAT, FLAT, 0.01, 1.0, "cold", 1.2), r"detected_probability = 1\.2 must lie in 0 to 1"),
        ((FLAT, np.zeros(4), 0.01, None, None, 0.0), "psi_cold has 3 samples and psi_warm 4"),
        ((FLAT, np.full(3, np.nan), 0.01, None, None, 0.0), "psi_warm must be one trace of finite numbers"),
        ((FLAT, FLAT, 0.0, None, None, 0.0), "dt_s = 0 s must be above 0"),
    ],
)
def test_a_percept_is_two_finite_traces_and_cannot_contradict_its_probability(made: Any, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        Percept(*made)


def test_a_larger_area_and_a_shorter_path_are_felt_sooner(cue: Any, observer: Observer) -> None:
    trace = cue(change=1.0)
    hand, forearm = perceive(trace, observer).onset_s, perceive(trace.but(site="forearm"), observer).onset_s
    large = perceive(trace, observer, area_m2=36e-4).onset_s
    assert hand is not None and forearm is not None and large is not None
    assert hand - forearm == pytest.approx(0.15 / 0.5, abs=5e-3)
    assert large < hand


def test_sites_of_the_forearm_have_thresholds_of_their_own(cue: Any, observer: Observer) -> None:
    trace, dull = cue(change=1.0), replace(observer, forearm_factor=Both(2.0, 2.0))
    wrist, arm, thenar, hand = (
        perceive(trace.but(site=site), dull).psi_warm.max()
        for site in ("left wrist", "Forearm", "thenar", "hand-dorsum")
    )
    assert wrist == arm < thenar == hand


def test_felt_peaks_are_later_by_conduction(cue: Any, observer: Observer) -> None:
    percept = perceive(cue(change=-4.0, rate=2.0, hold=0.0), observer)
    peak, felt = percept.peak_s("cold"), percept.felt_peak_s("cold")
    assert 1.9 < peak < 2.1
    assert felt == pytest.approx(peak + 0.7 / 2.0 + 0.225 / 12.0)
    assert percept.conduction_s == (pytest.approx(0.35 + 0.225 / 12.0), pytest.approx(1.4 + 0.225 / 2.0))
    assert perceive(cue(change=0.0), observer).felt_peak_s("warm") is None


def test_a_peak_lies_between_samples_and_may_lie_at_the_end() -> None:
    time = 0.1 * np.arange(60)
    percept = Percept(5.0 - (time - 2.34) ** 2, time, 0.1, None, None, 0.0)
    assert percept.peak_s("cold") == pytest.approx(2.34, abs=1e-9)
    assert percept.peak_s("warm") == pytest.approx(5.9)


def test_the_onset_says_that_it_is_on_another_clock(cue: Any, observer: Observer) -> None:
    percept, unfelt = perceive(cue(change=-4.0, name="dip"), observer), perceive(cue(change=0.0), observer)
    axes = percept.plot()
    assert (axes.get_title(), axes.get_xlabel()) == ("dip", "time (s), receptor clock")
    assert axes.get_ylabel() == "sensation (d′)" and percept._repr_html_().startswith("<svg")
    said = f"reported as cold at {percept.onset_s:.2f} s by the nominal person\n(response clock"
    for shown, last in ((axes, said), (unfelt.plot(), "not felt by the nominal person (p 0.00)")):
        labels = [text.get_text() for text in shown.get_legend().get_texts()]
        assert labels[:2] == ["cold", "warm"] and labels[2].startswith(last)


def test_clocks_agree_and_a_shorter_percept_is_held_at_its_end() -> None:
    def percept(cold: float, samples: int, dt_s: float = 0.01) -> Percept:
        return Percept(np.full(samples, cold), np.zeros(samples), dt_s, None, None, 0.0)

    cold, warm, dt = on_one_clock([percept(7.0, 2000), percept(6.0, 500)])
    assert (cold.shape, warm.shape, dt) == ((2, 2000), (2, 2000), 0.01)
    assert np.array_equal(cold[1], np.full(2000, 6.0))
    with pytest.raises(ValueError, match=r"on clocks of 0.01 s and 0.02 s: simulate all at one rate"):
        on_one_clock([percept(7.0, 20), percept(0.0, 9, 0.02)])
    assert uniform_clock([0.0, 0.5, 1.0, 1.2]) == (0.5, 3)
    for clock, said in (([0.0, 0.1, 0.3, 0.4], "needs a uniform clock: simulate at one"), ([0.0], "at least two rows")):
        with pytest.raises(ValueError, match=said):
            uniform_clock(clock)
