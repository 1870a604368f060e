"""The procedures of published experiments agree with the likelihood that the constants were inferred from.

Both play the same stimuli on the same skin: the likelihood by modes of the skin and tables, the procedures through
circuit, traces and the observer. What is compared is one median person, young, of a laboratory without an offset.
"""

import math

import numpy as np
import pytest

from thermicon.circuit import Rig
from thermicon.circuit.records import RecordError, Table
from thermicon.perception import Observer, draw_people
from thermicon.perception.evidence.results import load_constants
from thermicon.perception.evidence.statistics import load_evidence
from thermicon.perception.experiments import published as experiments
from thermicon.perception.experiments.laboratory import Laboratory
from thermicon.perception.experiments.prepulse import cooling_after_pulse
from thermicon.perception.experiments.psychometric import PsychometricFunction, psychometric_function
from thermicon.perception.experiments.published import PEAKS_C, STRIP_CM2, TWO_STRIPS_CM2, Predictions
from thermicon.perception.experiments.rating import magnitude_rating
from thermicon.perception.experiments.repeated_limits import RepeatedLimits, repeated_limits
from thermicon.perception.experiments.thermode_lag import thermode_lag
from thermicon.perception.observer.observer import variant_records
from thermicon.perception.sensation.bench import Bench

CHANNELS = ("cold", "warm")
NOBODY_DIFFERS = (
    "cold sensitivity between people",
    "warm sensitivity between people",
    "criterion between people",
    "decision time between people",
    "sensitivity between laboratories",
    "cold sensitivity lost per decade",
    "warm sensitivity lost per decade",
)


@pytest.fixture(scope="module")
def values() -> dict[str, float]:
    return {each.name: each.value for each in load_constants()}


@pytest.fixture(scope="module")
def laboratory(values: dict[str, float]) -> Laboratory:
    return Laboratory({**values, **dict.fromkeys(NOBODY_DIFFERS, 1e-9)})


@pytest.fixture(scope="module")
def predicted(laboratory: Laboratory) -> Predictions:
    return {
        key: value
        for run in (experiments.limits, experiments.yes_no, experiments.after_warmth, experiments.ratings)
        for key, value in run(laboratory)
        if math.isfinite(value)
    }


@pytest.fixture(scope="module")
def person() -> Observer:
    return Observer.load()


def skin_of_the_likelihood(values: dict[str, float], area_cm2: float) -> Rig:
    """A thermode that is where it is told, on the forearm with the contact and the living skin that were inferred."""
    rig = Rig.load("tcs2")
    changes: dict[str, float] = {
        "contact.area_cm2": area_cm2,
        "contact.resistance_m2K_per_W": values["contact resistance of a thermode"],
        "skin.cold_receptor_mm": values["cold receptor depth"],
        "skin.warm_receptor_mm": values["warm receptor depth"],
        "thermode.lag_s": 0.0,
        "thermode.resolution_K": 0.0,
    }
    for k, layer in enumerate(rig.skin.layers[1:], start=1):
        changes[f"skin.layer.{k}.conductivity_W_per_mK"] = (
            values["effusivity of living skin"] * layer.conductivity_W_per_mK
        )
        changes[f"skin.layer.{k}.heat_capacity_J_per_kgK"] = (
            values["effusivity of living skin"] * layer.heat_capacity_J_per_kgK
        )
    return rig.with_(**changes)


def bench(values: dict[str, float], strips_cm2: float, baseline_C: float) -> Bench:
    return Bench(skin_of_the_likelihood(values, strips_cm2), baseline_C, "display")


@pytest.mark.parametrize("channel", CHANNELS)
def test_ratings(channel: str, values: dict[str, float], predicted: Predictions, person: Observer) -> None:
    """E2: means within 1 %, their SD within 5 %, the exponent of area within 0.01."""
    rate = abs(experiments.RATED[channel][0])  # type: ignore[index]
    one, five = (
        magnitude_rating(person, bench(values, n * STRIP_CM2, 31.0), channel, rate_K_per_s=rate)  # type: ignore[arg-type]
        for n in (1, 5)
    )
    assert five.mean[0, -1] == pytest.approx(math.exp(predicted["E2", "rating_mean_5strip", channel]), rel=0.01)
    by_area = math.log(five.mean[0, -1] / one.mean[0, -1]) / math.log(5.0)
    assert by_area == pytest.approx(predicted["E2", "rating_area_exponent_group", channel], abs=0.01)
    scatter = math.sqrt(one.sd[0, -1] * five.sd[0, -1])
    assert scatter == pytest.approx(math.exp(predicted["E2", "rating_within_sd_pooled", channel]), rel=0.05)


@pytest.mark.parametrize("channel", CHANNELS)
def test_limits(channel: str, values: dict[str, float], predicted: Predictions, person: Observer) -> None:
    """E3: the geometric mean within 3 %, scatter of trials within 15 %: 2000 trials here, 16 there."""
    pressed = repeated_limits(person, bench(values, 5 * STRIP_CM2, 32.0), channel, trials=2000)  # type: ignore[arg-type]
    assert pressed.person_K[0] == pytest.approx(math.exp(predicted["E3", "threshold_gm", channel]), rel=0.03)
    scatter = predicted["E3", "within_sd_log10_median_person", channel]
    assert pressed.within_sd_log10 == pytest.approx(scatter, rel=0.15)


@pytest.mark.parametrize("channel", CHANNELS)
def test_yes_no(channel: str, values: dict[str, float], predicted: Predictions, person: Observer) -> None:
    """E4: threshold and width within 2 %; the likelihood has nine sizes, and so has this."""
    sizes = experiments.SIZES_K[channel].tolist()  # type: ignore[index]
    asked = psychometric_function(person, bench(values, TWO_STRIPS_CM2, 30.0), channel, sizes_K=sizes)  # type: ignore[arg-type]
    assert asked.threshold_K[0] == pytest.approx(math.exp(predicted["E4", "threshold50_gm_age30", channel]), rel=0.02)
    assert asked.width_K[0] == pytest.approx(math.exp(predicted["E4", "sigma_gm_age30", channel]), rel=0.02)


def test_cooling_after_warmth(values: dict[str, float], predicted: Predictions, person: Observer) -> None:
    """E5: falls at the press within 3 %, shares called warm within 0.001, for every peak."""
    on = bench(values, TWO_STRIPS_CM2, 32.0)
    lowest = predicted["E5", "cold_change_at_report_peak1_age_lt36", "cold"]
    for level, peak in enumerate(PEAKS_C, start=1):
        found = cooling_after_pulse(person, on, peak_C=peak)
        more = 0.0 if level == 1 else predicted["E5", f"ratio_to_lowest_peak{level}_age_lt36", "cold"]
        assert found.change_K[0] == pytest.approx(math.exp(lowest + more), rel=0.03)
        share = predicted["E5", f"share_called_warm_peak{level}_age_lt36", "cold"]
        assert found.called_warm[0] == pytest.approx(share, abs=0.001)
        assert found.label == "cold"


def test_the_lag_of_a_thermode_is_that_of_the_published_one() -> None:
    """E7 at 2.5 K/s: within 0.02 s of the offset-free lag and of the best shift; reading errors are not modelled."""
    lag, known = thermode_lag(Rig.load("tcs2"), rate_K_per_s=2.5), load_evidence()
    assert lag.offset_free_s == pytest.approx(known.find("E7", "lag_offset_free_2.5K_per_s", "both").value, abs=0.02)
    assert lag.best_shift_s == pytest.approx(known.find("E7", "best_single_lag_2.5K_per_s", "both").value, abs=0.03)
    assert lag.offset_K == pytest.approx(0.0, abs=0.01)
    slow = thermode_lag(Rig.load("tcs2").with_(**{"thermode.lag_s": 0.4}), rate_K_per_s=2.5)
    assert slow.offset_free_s == pytest.approx(0.4, abs=0.02)


def test_people_differ_as_they_are_drawn(values: dict[str, float], person: Observer) -> None:
    crowd = draw_people(60, seed=3)
    on = bench(values, 5 * STRIP_CM2, 32.0)
    pressed = repeated_limits(person, on, "cold", trials=40, people=crowd)
    few = repeated_limits(person, on, "cold", trials=3, people=crowd)
    assert few.between_sd_log10 == pytest.approx(pressed.between_sd_log10, rel=0.2)
    assert np.log10(few.person_K).std(ddof=1) > few.between_sd_log10
    rated = magnitude_rating(person, on, "cold", people=crowd)
    assert np.corrcoef(np.log(rated.mean[:, 0]), np.log(crowd.threshold_cold))[0, 1] == pytest.approx(-1.0)
    assert (rated.d_prime() > rated.d_prime(1, 2)).all()
    asked = psychometric_function(person, on, "cold", sizes_K=np.geomspace(0.02, 25.0, 12).tolist(), people=crowd)
    assert np.corrcoef(np.log(asked.threshold_K), np.log(crowd.threshold_cold * crowd.criterion_cold))[0, 1] > 0.7


def test_presses_that_do_not_count() -> None:
    limits = RepeatedLimits("cold", np.array([[1.0, 2.0, np.nan], [4.0, np.inf, np.nan], [np.inf] * 3]), "by hand")
    assert limits.person_K[:2] == pytest.approx([math.sqrt(2.0), 4.0])
    assert np.isnan(limits.person_K[2])
    assert limits.anticipated == pytest.approx(2.0 / 9.0)
    assert limits.within_sd_log10 == pytest.approx(np.log10([1.0, 2.0]).std(ddof=1))
    with pytest.raises(ValueError, match=r"an SD within people needs two trials or more"):
        _ = RepeatedLimits("cold", np.array([[1.0], [2.0]]), "by hand").within_sd_log10
    with pytest.raises(ValueError, match=r"a spread between people needs two who pressed: give `people`"):
        _ = RepeatedLimits("cold", np.array([[1.0, 2.0]]), "by hand").between_sd_log10
    with pytest.raises(ValueError, match=r"presses must have people and trials, not shape \(2,\)"):
        RepeatedLimits("cold", np.array([1.0, 2.0]), "by hand")


def test_a_missing_constant_is_named(values: dict[str, float], person: Observer) -> None:
    on = bench(values, STRIP_CM2, 32.0)
    shipped = variant_records()

    def lacking(quantity: str) -> Table:
        return Table("mine.toml", tuple(record for record in shipped if record.quantity != quantity))

    with pytest.raises(
        RecordError, match=r"magnitude rating needs 'rating exponent' \(warm\), which mine.toml does not"
    ):
        magnitude_rating(person, on, "warm", records=lacking("rating exponent"))
    with pytest.raises(
        RecordError, match=r"magnitude rating needs 'scatter of ratings', which mine.toml does not have"
    ):
        magnitude_rating(person, on, "warm", records=lacking("scatter of ratings"))
    with pytest.raises(RecordError, match=r"yes/no with slope needs 'criterion of yes and no', which mine.toml"):
        psychometric_function(person, on, "warm", records=lacking("criterion of yes and no"))
    with pytest.raises(
        RecordError, match=r"cooling after a warm pulse needs 'wrong labels', .* add the record, or leave"
    ):
        cooling_after_pulse(person, on, records=lacking("wrong labels"))


def test_messages(values: dict[str, float], person: Observer) -> None:
    on = bench(values, STRIP_CM2, 32.0)
    with pytest.raises(ValueError, match=r"magnitude rating: at least 2 sizes are needed, not 1: add to sizes_K"):
        magnitude_rating(person, on, "cold", sizes_K=(3.0,))
    with pytest.raises(ValueError, match=r"sizes_K must rise from above 0 K, not 3, 2, 5: they are without sign"):
        psychometric_function(person, on, "cold", sizes_K=(3.0, 2.0, 5.0))
    with pytest.raises(ValueError, match=r"the criterion must be above 0 d′, not 0"):
        psychometric_function(person, on, "cold", criterion=0.0)
    with pytest.raises(ValueError, match=r"4 K is reported in .* % of trials already: add a smaller size to sizes_K"):
        _ = psychometric_function(person, on, "cold", sizes_K=(4.0, 5.0, 6.0)).threshold_K
    with pytest.raises(ValueError, match=r"at least one trial is needed, not 0"):
        repeated_limits(person, on, "cold", trials=0)
    with pytest.raises(ValueError, match=r"anticipation_K = 12 K must be 0 or more and below limit_K, 12 K"):
        repeated_limits(person, on, "cold", anticipation_K=12.0)
    with pytest.raises(ValueError, match=r"peak_C = 31 °C must lie above the baseline of the bench, 32 °C"):
        cooling_after_pulse(person, on, peak_C=31.0)
    with pytest.raises(ValueError, match=r"rig thenar has no \[thermode\], whose lag is asked for: use a rig with one"):
        thermode_lag(Rig.load("thenar"))
    with pytest.raises(
        ValueError, match=r"flanks of 0.4 s are too short for a lag of 0.21 s to settle: raise size_K to"
    ):
        thermode_lag(Rig.load("tcs2"), size_K=1.0)
    flat = PsychometricFunction("cold", np.array([1.0, 2.0]), np.array([[0.0, 0.3]]), "by hand")
    assert np.isinf(flat.threshold_K[0])
