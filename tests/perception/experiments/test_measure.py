"""Simulated measurements of a new laboratory in agreement with the evidence."""

from dataclasses import replace

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.perception.evidence.rows import load_evidence
from thermicon.perception.experiments import published
from thermicon.perception.experiments.laboratory import Laboratory
from thermicon.perception.experiments.measure import Condition, Setting, logs_of, measure
from thermicon.perception.observer.constants import BETWEEN_LABORATORIES, Both
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.observer.observer import Observer

FOREARM = Rig.load("tcs2")
LIMITS, CHOICE, YES_NO = (
    Condition("threshold", method, "warm", 32.0, size, 1.0, hold)
    for method, size, hold in (("limits", 12.0, 0.0), ("forced_choice", None, 3.0), ("yes_no", None, 1.5))
)


def test_limits_of_a_new_laboratory_cover_the_published_ones_with_its_scatter() -> None:
    found, known = measure(LIMITS, FOREARM, draws=40), load_evidence()
    assert found.low < known.find("E3", "threshold_gm", "warm").value < found.high
    within = np.log(10.0) * known.find("E3", "within_sd_log10_median_person", "warm").value
    assert found.within == pytest.approx(within, rel=0.4)
    assert repr(found).startswith("Measurement(warm, limits, 1 K/s: ")


def test_an_interval_is_that_of_new_laboratories_drawn_with_their_offsets() -> None:
    found, known, setting = measure(LIMITS, FOREARM, draws=5, seed=3), PosteriorDraws.load(), Setting.of(FOREARM)
    places = np.linspace(0, 999, 5).round().astype(int)
    offsets = np.random.default_rng(3).standard_normal((5, 2)) * known.values(BETWEEN_LABORATORIES)[places, None]
    logs = [
        logs_of(setting.laboratory(known.observer(k), offset), setting, LIMITS)[0]
        for k, offset in zip(places.tolist(), offsets.tolist(), strict=True)
    ]
    low, middle, high = np.exp(np.percentile([each.mean() for each in logs], [2.5, 50.0, 97.5]))
    assert (found.low, found.value, found.high) == pytest.approx((low, middle, high))
    assert found.between == pytest.approx(np.median([each.std() for each in logs]))


def test_methods_have_their_order() -> None:
    choice, asked, limits = (measure(each, FOREARM, draws=12).value for each in (CHOICE, YES_NO, LIMITS))
    assert choice < asked
    assert choice < limits


@pytest.mark.parametrize("kind", ["reaction_time", "rating"])
def test_a_larger_change_is_faster_and_stronger(kind: str) -> None:
    method = {"reaction_time": "choice", "rating": "magnitude"}[kind]
    small, large = (
        measure(Condition(kind, method, "cold", 31.0, size, 5.0, 0.7), FOREARM, draws=4)  # type: ignore[arg-type]
        for size in (1.5, 6.0)
    )
    assert (large.value < small.value) == (kind == "reaction_time")


def test_who_does_not_answer_counts_a_second_beyond_the_end() -> None:
    setting, known = Setting.of(FOREARM), PosteriorDraws.load()
    numb = setting.laboratory(known.observer(0), (-40.0, -40.0))
    timed = Condition("reaction_time", "simple", "warm", 32.0, 1.0, 1.0, 0.0)
    assert np.exp(logs_of(numb, setting, timed)[0].max()) == pytest.approx(1.0 + 3.0 + 1.0)
    assert np.exp(logs_of(numb, setting, LIMITS)[0].max()) == pytest.approx(12.0 + 1.0)


@pytest.mark.parametrize("site", ["forearm", "thenar"])
def test_wrong_qualities_are_a_matter_of_chance_for_what_is_not_felt_and_seldom_for_what_is(site: str) -> None:
    nothing, cold, warm = (
        measure(Condition("wrong_quality", "choice", channel, 31.0, size, 5.0, 0.0), Rig.load(site), draws=6)
        for channel, size in (("warm", 0.01), ("cold", 8.0), ("warm", 8.0))
    )
    assert nothing.value == pytest.approx(0.5, abs=0.1)
    assert 0.0 < warm.low < warm.value < warm.high < nothing.low
    assert warm.value < cold.value < 0.5
    assert repr(cold).startswith("Measurement(cold, wrong quality of a speeded choice, 8 K at 5 K/s: 0.0")


@pytest.mark.parametrize("strips", [(1,), (5,)])
def test_people_in_haste_name_the_wrong_quality_as_seldom_as_was_measured(
    strips: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """E8: warm was called cold in 0.6 % of the choices, cold called warm in 3.3 %."""
    monkeypatch.setattr(published, "STRIPS", strips)

    def shares(**changes: float) -> tuple[float, ...]:
        person = replace(Observer.load(), **changes)
        return tuple(dict(published.quality_in_haste(Laboratory.of(person, {"E1": Both(0.0, 0.0)}))).values())

    cold, warm = shares()
    assert 0.001 < warm < 0.02 < cold < 0.07
    # Hasty people need the floor: without it noise answers for those whose criterion is low.
    hasty = {"criterion": 3.0, "criterion_between": 0.7}
    assert shares(**hasty, criterion_floor=0.0)[1] > 0.04 > 2.0 * shares(**hasty)[1]
    renamed, same = shares(wrong_labels=Observer.load().wrong_labels - 0.03)
    assert (cold - renamed, warm - same) == pytest.approx((0.03, 0.0), abs=0.002)


def test_messages() -> None:
    with pytest.raises(ValueError, match=r"an interval needs at least 2 laboratories, not 1"):
        measure(LIMITS, FOREARM, draws=1)
    with pytest.raises(ValueError, match=r"limits needs the size of the change, above 0 K"):
        Condition("threshold", "limits", "cold", 32.0, None, 1.0, 0.0)
    with pytest.raises(ValueError, match=r"wrong quality of a speeded choice needs the size of the change, above 0 K"):
        Condition("wrong_quality", "choice", "cold", 32.0, None, 1.0, 0.0)
    for kind in ("rating", "wrong_quality"):
        with pytest.raises(ValueError, match=f"there is no {kind} by limits of cold"):
            Condition(kind, "limits", "cold", 32.0, 5.0, 1.0, 0.0)  # type: ignore[arg-type]
