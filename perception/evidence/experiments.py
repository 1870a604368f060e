"""Published experiments, run on the observer: thresholds against rate and method, reaction times.

Each function returns predictions, with the interval that unmeasured parameters leave, for one
sensory variable and receptor model. What is not stated where an experiment was found is stated here,
as a condition. Constants were inferred from limits and reaction times on the forearm, and from none of the others.
More in `experiments_timing`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache, partial

import numpy as np

from thermicon.circuit import Rig

from ..experiments.on_bench import choice_reaction_time, forced_choice, method_of_levels, method_of_limits
from ..observer.channels import CHANNELS, Channel, Variable
from ..observer.observer import Observer
from ..observer.people import draw_people
from ..sensation.bench import Bench, ramp
from .predicted import DRAWS, Asked, Predicted, predict, quantile_felt

RATES_K_PER_S = (0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.3)
FLAT_K_PER_S = (0.1, 0.2, 0.3)
AREAS_CM2 = (2.5, 5.0, 10.0)
RAMP_K, RAMP_K_PER_S = 8.0, 5.0
PEOPLE = 100
LIMITS: dict[str, tuple[str, float]] = {"hand": ("hand-dorsum", 9.0), "forearm": ("forearm", 10.0)}
"""Rig and area of contact, cm²; on the hand it is not stated where the norms were found, and is assumed."""


def rate_curve(
    variable: Variable = "temperature",
    *,
    rates_K_per_s: Sequence[float] = RATES_K_PER_S,
    draws: int = DRAWS,
    seed: int = 0,
) -> tuple[Predicted, ...]:
    """Thresholds on the forearm against the rate of change, as Kenshalo, Holmes & Wood 1968 studied.

    A threshold (K) for each channel and rate; then for each channel the largest change of threshold over
    0.1 to 0.3 K/s, and the thresholds at the other rates over that at 0.1 K/s.
    """
    bench = _bench("forearm", 9.0, "skin", 32.0)
    said = "forced choice at the skin, forearm, from 32 °C; the end of the ramp is held for 1 s"
    asked = []
    for channel in CHANNELS:
        at = lru_cache(maxsize=None)(partial(_threshold, bench, channel))
        asked += [Asked(f"threshold at {r:g} K/s", channel, "K", said, partial(_at_rate, at, r)) for r in rates_K_per_s]
        asked.append(Asked("largest change over 0.1 to 0.3 K/s", channel, "1", said, partial(_flatness, at)))
        slow = [r for r in rates_K_per_s if r not in FLAT_K_PER_S]
        asked += [
            Asked(f"threshold at {r:g} K/s over that at 0.1", channel, "1", said, partial(_raised, at, r)) for r in slow
        ]
    return predict("rate curve", asked, variable, draws, seed)


def limits(
    site: str = "hand",
    variable: Variable = "temperature",
    *,
    people: int = PEOPLE,
    age_years: float | None = None,
    draws: int = DRAWS,
    seed: int = 0,
) -> tuple[Predicted, ...]:
    """Limits at 1 °C/s from 32 °C on the back of the hand (9 cm²) or the forearm (10 cm²), cold then warm.

    `people` fill in the spread over persons, of 20 to 30 years unless `age_years` is given.
    """
    if site not in LIMITS:
        raise ValueError(f"limits are run on {' or '.join(LIMITS)}, not on {site!r}")
    bench = _bench(*LIMITS[site], "display", 32.0)
    aged = "" if age_years is None else f", {age_years:g} years"
    said = f"display ramp of 1 K/s, {LIMITS[site][1]:g} cm²{aged}"
    crowd = draw_people(people, seed, age_years=age_years)

    asked = [Asked("limits threshold", channel, "K", said, partial(_limits, bench, channel)) for channel in CHANNELS]
    made = []
    nominal = Observer.load(variable=variable)
    for one, channel in zip(predict(f"limits on the {site}", asked, variable, draws, seed), CHANNELS, strict=True):
        each = np.sort(method_of_limits(nominal, bench, channel, people=crowd))
        low, middle, high = (quantile_felt(each, share) for share in (0.16, 0.5, 0.84))
        spread = None if low is None or high is None else (low, high)
        made.append(replace(one, value=middle, people=spread))
    return tuple(made)


def reaction_times(
    variable: Variable = "temperature",
    *,
    areas_cm2: Sequence[float] = AREAS_CM2,
    draws: int = DRAWS,
    seed: int = 0,
) -> tuple[Predicted, ...]:
    """Choice reaction times on the forearm at 5 °C/s from 31 °C: a median for each area, their exponent, their ratio.

    The times of the largest area are those to compare with the published ones (about 10 cm²). Where the
    module falls behind the ramp of that area, the conditions say so.
    """
    at = {c: lru_cache(maxsize=None)(partial(_reaction, c)) for c in CHANNELS}
    areas = tuple(areas_cm2)
    if len(areas) < 2:
        raise ValueError("an exponent of area needs at least two areas")
    ramps = f"display ramp of {RAMP_K_PER_S:g} K/s up to {RAMP_K:g} K from 31 °C, forearm, warm or cold?"
    said = {c: f"{ramps}{_behind(_bench('forearm', areas[-1], 'display', 31.0), c)}" for c in CHANNELS}
    asked = [
        Asked(f"reaction time at {area:g} cm²", channel, "s", said[channel], partial(_at_rate, at[channel], area))
        for channel in CHANNELS
        for area in areas
    ]
    asked += [
        Asked("exponent of area", c, "1", f"{said[c]}; over {areas} cm²", partial(_slope, at[c], areas))
        for c in CHANNELS
    ]
    asked.append(
        Asked("warm over cold", "both", "1", ramps, lambda o: at["warm"](o, areas[-1]) / at["cold"](o, areas[-1]))
    )
    return predict("choice reaction time", asked, variable, draws, seed)


def methods(variable: Variable = "temperature", *, draws: int = 0, seed: int = 0) -> tuple[Predicted, ...]:
    """One observer by three methods at 1 K/s on the back of the hand: forced choice, levels, limits, in K."""
    bench = _bench(*LIMITS["hand"], "display", 32.0)
    said = "display ramps of 1 K/s from 32 °C on the back of the hand, 9 cm²"

    def levels(channel: Channel, observer: Observer) -> float:
        return float(np.median(method_of_levels(observer, bench, channel)))

    def choice(channel: Channel, observer: Observer) -> float:
        return forced_choice(observer, bench, channel)

    named: list[tuple[str, Callable[[Channel, Observer], float]]] = [
        ("forced choice", choice),
        ("levels", levels),
        ("limits", partial(_limits, bench)),
    ]
    asked = [Asked(f"threshold by {name}", c, "K", said, partial(by, c)) for name, by in named for c in CHANNELS]
    return predict("method", asked, variable, draws, seed)


@lru_cache(maxsize=32)
def _bench(rig: str, area_cm2: float, surface: str, baseline_C: float) -> Bench:
    made = Rig.load(rig).with_(**{"contact.area_cm2": area_cm2})
    return Bench(made, baseline_C, "display" if surface == "display" else "skin")


@lru_cache(maxsize=512)
def _limits(bench: Bench, channel: Channel, observer: Observer) -> float:
    """Limits of the nominal person, which two experiments on the hand ask for."""
    return float(method_of_limits(observer, bench, channel)[0])


def _threshold(bench: Bench, channel: Channel, observer: Observer, rate: float) -> float:
    return forced_choice(observer, bench, channel, rate_K_per_s=rate, hold_s=1.0)


def _at_rate(at: Callable[[Observer, float], float], rate: float, observer: Observer) -> float:
    return at(observer, rate)


def _flatness(at: Callable[[Observer, float], float], observer: Observer) -> float:
    found = [at(observer, rate) for rate in FLAT_K_PER_S]
    return max(found) / min(found) - 1.0


def _raised(at: Callable[[Observer, float], float], rate: float, observer: Observer) -> float:
    return at(observer, rate) / at(observer, FLAT_K_PER_S[0])


def _reaction(channel: Channel, observer: Observer, area_cm2: float) -> float:
    bench = _bench("forearm", area_cm2, "display", 31.0)
    found = choice_reaction_time(observer, bench, channel, rate_K_per_s=RAMP_K_PER_S, size_K=RAMP_K)
    return float(found.quantile()[0])


def _behind(bench: Bench, channel: Channel) -> str:
    """What keeps the display from following the reaction-time ramp; nothing where it follows."""
    (trace,) = bench.play([ramp(channel, RAMP_K, RAMP_K_PER_S)], RAMP_K / RAMP_K_PER_S).traces
    return "" if trace.reason is None else f"; the display {trace.reason}"


def _slope(at: Callable[[Observer, float], float], areas: tuple[float, ...], observer: Observer) -> float:
    times = [at(observer, area) for area in areas]
    return float(np.polyfit(np.log(areas), np.log(times), 1)[0])
