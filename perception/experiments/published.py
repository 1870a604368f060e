"""Simulations of the conditioning experiments.

Numbers on a log scale are logarithms.
"""

import math
from collections.abc import Callable, Iterator
from itertools import chain

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..observer.channels import CHANNELS, Channel
from .abstracts import LIMIT_K, cool_skin, matched_fingers, order_of_sites, warm_skin
from .laboratory import DT_S, Laboratory, samples_of
from .tasks import DisplayRamp, Key, Stimulated, yes_no_logs

Predictions = dict[Key, float]
LN10 = math.log(10.0)

STRIP_CM2 = 1.96
TWO_STRIPS_CM2 = 3.58
"""Areas of contact: one strip of E1 to E3, and two of 7.4 × 24.2 mm of E4 and E5."""
RAMPS: dict[Channel, tuple[float, float]] = {"cold": (5.0, 26.0), "warm": (4.81, 14.0)}
"""Rate in K/s as it really ran, and how far the reaction-time ramps went, K."""
MEAN_AGE_YEARS = {"E1": 28.0, "E3": 24.5, "E4": 30.0, "E5": 27.0}
"""Mean age of the people whose rows are used; that of E1 and E5 is the middle of the range."""
AGES_YEARS = {"E4": (21.0, 80.0)}
"""Youngest and oldest of the people whose rows follow age."""
ANTICIPATION_K = 0.2
"""Earlier presses of E3 were left out (evidence.toml)."""


def predict(laboratory: Laboratory) -> Predictions:
    """Predictions of all conditioning experiments."""
    return dict(chain.from_iterable(experiment(laboratory) for experiment in EXPERIMENTS))


def reaction_times(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
    """E1: warm or cold, as fast as possible, by area."""
    log_medians: dict[tuple[Channel, int], Array] = {}
    for channel, (rate, size) in RAMPS.items():
        played = Stimulated.of(laboratory, DisplayRamp("forearm", channel, 31.0, size, rate, 6.0))
        for strips in (1, 5):
            gain = laboratory.gain(channel, strips * STRIP_CM2, "E1", "forearm", MEAN_AGE_YEARS["E1"])
            times = np.minimum(played.answers_s(gain, "forearm", choice=True), 7.0)
            log_medians[channel, strips] = np.log(np.median(times, axis=1))
        five = log_medians[channel, 5]
        yield ("E1", "rt_gm_5strip_onset_clock", channel), float(five.mean())
        yield ("E1", "rt_between_sd_ln_5strip_onset_clock", channel), float(five.std())
        yield (("E1", "rt_within_sd_ln_5strip_onset_clock", channel), float(np.median(np.log(times).std(axis=1))))
        exponent = float((five - log_medians[channel, 1]).mean()) / math.log(5.0)
        yield ("E1", "rt_area_exponent_onset_clock", channel), exponent
    both = _correlation(log_medians["cold", 5], log_medians["warm", 5])
    yield ("E1", "rt_cold_warm_correlation_5strip_onset_clock", "both"), both


STRIPS = range(1, 6)
"""Numbers of strips of E1, E2 and E8."""


def quality_in_haste(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
    """E8: the task of E1, and how often its answers name the wrong quality, in the mean over its areas."""
    for (channel, (rate, size)), other in zip(RAMPS.items(), reversed(CHANNELS), strict=True):
        played, shares = Stimulated.of(laboratory, DisplayRamp("forearm", channel, 31.0, size, rate, 6.0)), []
        for strips in STRIPS:
            at = strips * STRIP_CM2, "E1", "forearm", MEAN_AGE_YEARS["E1"]
            gain, warm_gain = laboratory.gain(channel, *at), laboratory.gain("warm", *at)
            shares.append(played.misnamed(gain, warm_gain, "forearm").mean())
        yield ("E8", f"share_{channel}_called_{other}_all_fast", channel), float(np.mean(shares))


def _correlation(first: Array, second: Array) -> float:
    return float(np.corrcoef(first, second)[0, 1])


def limits(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
    """E3: limits at 1 K/s on the forearm, repeated."""
    means = []
    for channel in CHANNELS:
        played = Stimulated.of(laboratory, DisplayRamp.held("forearm", channel, 32.0, LIMIT_K, 1.0, 0.0))
        gain = laboratory.gain(channel, 5 * STRIP_CM2, "E3", "forearm", MEAN_AGE_YEARS["E3"])
        pressed_K = played.limits_K(gain, "forearm")
        logs = np.log(np.where(pressed_K > ANTICIPATION_K, pressed_K, np.nan))
        person = np.nanmean(logs, axis=1)
        means.append(person)
        yield ("E3", "threshold_gm", channel), float(person.mean())
        yield ("E3", "between_sd_log10_noise_removed", channel), float(person.std()) / LN10
        yield ("E3", "within_sd_log10_median_person", channel), float(np.median(np.nanstd(logs, axis=1))) / LN10
    yield ("E3", "cold_warm_correlation_log", "both"), _correlation(*means)


SIZES_K: dict[Channel, Array] = {"cold": np.geomspace(0.05, 25.0, 9), "warm": np.geomspace(0.3, 20.0, 9)}
DETECTION_K_PER_S, PLATEAU_S = 2.5, 1.5


def yes_no(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
    """E4: was it cold (warm)? The size at one half and the width of each person's psychometric function."""
    thresholds = []
    for channel in CHANNELS:
        gain = laboratory.gain(channel, TWO_STRIPS_CM2, "E4", "forearm", MEAN_AGE_YEARS["E4"])
        sizes = SIZES_K[channel].tolist()
        ramps = [DisplayRamp.held("forearm", channel, 30.0, size, DETECTION_K_PER_S, PLATEAU_S) for size in sizes]
        log_half, log_width = yes_no_logs(laboratory, ramps, gain)
        thresholds.append(log_half)
        yield ("E4", "threshold50_gm_age30", channel), float(log_half.mean())
        yield ("E4", "threshold_between_sd_log10_noise_removed", channel), float(log_half.std()) / LN10
        yield ("E4", "sigma_gm_age30", channel), float(log_width.mean())
        yield ("E4", "sigma_between_sd_log10_noise_removed", channel), float(log_width.std()) / LN10
        # Age acts on sensitivity alone; people show how a threshold follows sensitivity.
        log_sensitivity = -np.log(laboratory.people.threshold(channel))
        slope = -float(np.cov(log_sensitivity, log_half)[0, 1]) / max(float(log_sensitivity.var(ddof=1)), 1e-9)
        lost = laboratory.constants.lost_per_decade.of(channel)
        yield ("E4", "threshold50_ln_per_decade", channel), slope * lost
    yield ("E4", "cold_warm_threshold_correlation_person_fits", "both"), _correlation(*thresholds)


PEAKS_C = (34.9, 38.0, 45.4, 47.2)
"""Mean peaks of the four levels of the young group of E5."""
PREPULSE_K_PER_S, HELD_S, FOREPERIOD_S, COOLED_K = 2.5, 0.75, 0.25, 14.0


def after_warmth(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
    """E5: cooling at 1 K/s after a warm pulse; press at the first change, then say which it was."""
    constants = laboratory.constants
    at = TWO_STRIPS_CM2, "E4", "forearm", MEAN_AGE_YEARS["E5"]
    gain, warm_gain = (laboratory.gain(channel, *at) for channel in CHANNELS)
    caution, samples, lowest = constants.caution_after_pulse, samples_of(((COOLED_K, -COOLED_K),), COOLED_K), 0.0
    for level, peak in enumerate(PEAKS_C, start=1):
        rise_s = (peak - 32.0) / PREPULSE_K_PER_S
        start_s = round((2.0 * rise_s + HELD_S + FOREPERIOD_S) / DT_S) * DT_S
        pulse = [(rise_s, peak - 32.0), (rise_s + HELD_S, peak - 32.0), (2.0 * rise_s + HELD_S, 0.0), (start_s, 0.0)]
        corners = [*pulse, (start_s + COOLED_K, -COOLED_K)]
        drive = laboratory.drive("forearm", "cold", 32.0, corners, start_s + COOLED_K)
        cooled = np.ascontiguousarray(drive[round(start_s / DT_S) :])
        answers = laboratory.answers_s(cooled, samples, "cold", gain, site="forearm", caution=caution)
        logs = np.log(np.minimum(answers, COOLED_K + 1.0))
        mean = float(logs.mean())
        if level == 1:
            lowest = mean
            yield ("E5", "cold_change_at_report_peak1_age_lt36", "cold"), mean
            yield ("E5", "between_people_sd_peak1_age_lt36", "cold"), float(logs.mean(axis=1).std())
            yield ("E5", "within_sd_ln_peak1", "cold"), float(np.median(logs.std(axis=1)))
        else:
            yield ("E5", f"ratio_to_lowest_peak{level}_age_lt36", "cold"), mean - lowest
        warmth = laboratory.drive("forearm", "warm", 32.0, pulse, start_s).max() * warm_gain
        share = constants.called_warm(float(constants.psi(warmth)))
        yield ("E5", f"share_called_warm_peak{level}_age_lt36", "cold"), share


FORCED_CHOICE: tuple[tuple[str, str, str, dict[Channel, float]], ...] = (
    ("thenar", "hand", "thenar", {"cold": 0.11, "warm": 0.20}),
    ("wrist", "forearm", "forearm", {"cold": 0.15, "warm": 0.23}),
)
"""Laboratory, site, rig whose skin it is, and the published thresholds in K, each played at 1 K/s and held for 3 s."""


def forced_choice(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
    """Published forced-choice thresholds in multiples of threshold: 1 would be right (log 0)."""
    for place, site, rig, sizes in FORCED_CHOICE:
        for channel, size in sizes.items():
            peak = Stimulated.of(laboratory, DisplayRamp.held(rig, channel, 32.0, size, 1.0, 3.0)).peak
            gain = laboratory.gain(channel, 9.0, place, site, 25.0)
            yield (place, "detection threshold", channel), -math.log(max(peak * gain, 1e-6))
    for channel in CHANNELS:
        spread = laboratory.constants.sensitivity_between.of(channel)
        yield ("wrist", "spread of detection thresholds", channel), spread


PEDESTALS = np.geomspace(1.5, 4.5, 3)
"""Smaller of two pulses in multiples of threshold; assumed, since amplitudes are not stated where found."""


def differences(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
    """Amplitude differences of two pulses felt, and steps from threshold to pain."""
    for channel, size in FORCED_CHOICE[0][3].items():
        steps = size * laboratory.constants.difference_threshold(PEDESTALS)
        yield ("amplitudes", "amplitude difference threshold", channel), float(np.log(steps).mean())
    peak = Stimulated.of(laboratory, DisplayRamp("forearm", "warm", 34.0, 10.0, 0.5, 20.0)).peak
    multiple = peak / laboratory.constants.threshold_drive.warm
    yield (
        ("steps", "steps from threshold to pain", "warm"),
        math.log(max(float(laboratory.constants.psi(multiple)), 0.01)),
    )


RATED: dict[Channel, tuple[float, float]] = {"cold": (5.0, 11.0), "warm": (4.81, 11.0)}
"""Rate in K/s and size in K of E2."""
E6_SIZES: dict[Channel, tuple[float, float]] = {"cold": (15.8, 3.75), "warm": (10.05, 5.6)}
"""Median change in K and area in cm² of E6."""
E6_K_PER_S = 40.0
"""Between the two rates that were used, 20 and 100 K/s; the size of a held change hardly depends on it."""


def ratings(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
    """E2 and E6: ratings by area and by size; a rating is a power of the largest drive in multiples of threshold."""
    constants = laboratory.constants
    for channel, (rate, size) in RATED.items():
        peak = Stimulated.of(laboratory, DisplayRamp.held("forearm", channel, 31.0, size, rate, 0.7)).peak
        one, five = (
            peak * laboratory.gain(channel, n * STRIP_CM2, "E1", "forearm", MEAN_AGE_YEARS["E1"]) for n in (1, 5)
        )
        exponent, unit = constants.rating_exponent.of(channel), constants.rating_at_threshold.of(channel)
        yield ("E2", "rating_mean_5strip", channel), math.log(unit) + exponent * math.log(max(five, 1e-6))
        yield ("E2", "rating_area_exponent_group", channel), exponent * math.log(five / one) / math.log(5.0)
        middle = unit * math.sqrt(one * five) ** exponent
        scatter = math.hypot(constants.rating_scatter, exponent * middle * constants.gain_noise)
        yield ("E2", "rating_within_sd_pooled", channel), math.log(scatter)
        change, _ = E6_SIZES[channel]
        low, high = (
            Stimulated.of(laboratory, DisplayRamp.held("forearm", channel, 30.0, times * change, E6_K_PER_S, 2.0)).peak
            for times in (0.8, 1.25)
        )
        yield (
            ("E6", "rating_local_exponent_mean", channel),
            exponent * math.log(max(high, 1e-6) / max(low, 1e-6)) / math.log(1.25 / 0.8),
        )


EXPERIMENTS: tuple[Callable[[Laboratory], Iterator[tuple[Key, float]]], ...] = (
    reaction_times,
    quality_in_haste,
    limits,
    order_of_sites,
    matched_fingers,
    cool_skin,
    warm_skin,
    yes_no,
    after_warmth,
    forced_choice,
    differences,
    ratings,
)
