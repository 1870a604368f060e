"""Published experiments, run on the observer: thresholds against rate and method, reaction times, peaks and returns.

Each function returns predictions, with the interval that unmeasured parameters leave, for one sensory variable. What is
not stated where an experiment was found is stated here, as a condition. Constants were inferred from limits and
reaction times on the forearm, and from none of the others.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, lru_cache, partial

import numpy as np

from thermicon.circuit import Rig

from ..experiments.on_bench import choice_reaction_time, forced_choice, method_of_levels, method_of_limits, yes_no
from ..observer.channels import CHANNELS, Channel, Variable, sign_of
from ..observer.observer import Observer, load_thresholds
from ..observer.people import draw_people
from ..sensation.bench import Bench, Stimulus, Surface, raised_cosine, ramp
from ..sensation.detection import criterion_of, detect
from ..sensation.percept import perceive
from .predicted import DRAWS, Asked, Predicted, predict, quantile_felt

RATES_K_PER_S = (0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.3)
FLAT_K_PER_S = (0.1, 0.2, 0.3)
AREAS_CM2 = (2.5, 5.0, 10.0)
RAMP_K, RAMP_K_PER_S = 8.0, 5.0
PEOPLE = 100
LIMITS: dict[str, tuple[str, float]] = {"hand": ("hand-dorsum", 9.0), "forearm": ("forearm", 10.0)}
"""Rig and area of contact, cm²; on the hand it is not stated where the norms were found, and is assumed."""
PULSE_K, PULSE_S = 4.0, 8.0
HOLD_S = 4.0
STEEP_K, STEEP_K_PER_S = 4.0, 3.0
STEEP = f"display step of {STEEP_K:g} K at {STEEP_K_PER_S:g} K/s, thenar, percept clock"


def rate_curve(variable: Variable = "temperature", *, draws: int = DRAWS, seed: int = 0) -> tuple[Predicted, ...]:
    """Thresholds on the forearm against the rate of change, as Kenshalo, Holmes & Wood 1968 studied.

    A threshold (K) for each channel and rate; then for each channel the largest change of threshold over
    0.1 to 0.3 K/s, and the thresholds at the other rates over that at 0.1 K/s.
    """
    bench = _bench("forearm", 9.0, "skin", 32.0)
    said = "forced choice at the skin, forearm, from 32 °C; the end of the ramp is held for 1 s"

    @cache
    def at(channel: Channel, rate: float, observer: Observer) -> float:
        return forced_choice(observer, bench, channel, rate_K_per_s=rate, hold_s=1.0)

    def change(channel: Channel, observer: Observer) -> float:
        found = [at(channel, rate, observer) for rate in FLAT_K_PER_S]
        return max(found) / min(found) - 1.0

    def raised(channel: Channel, rate: float, observer: Observer) -> float:
        return at(channel, rate, observer) / at(channel, FLAT_K_PER_S[0], observer)

    asked = []
    for channel in CHANNELS:
        asked += [
            Asked(f"threshold at {rate:g} K/s", channel, "K", said, partial(at, channel, rate))
            for rate in RATES_K_PER_S
        ]
        asked.append(Asked("largest change over 0.1 to 0.3 K/s", channel, "1", said, partial(change, channel)))
        asked += [
            Asked(f"threshold at {rate:g} K/s over that at 0.1", channel, "1", said, partial(raised, channel, rate))
            for rate in RATES_K_PER_S
            if rate not in FLAT_K_PER_S
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


def reaction_times(variable: Variable = "temperature", *, draws: int = DRAWS, seed: int = 0) -> tuple[Predicted, ...]:
    """Choice reaction times on the forearm at 5 °C/s from 31 °C: a median for each area, their exponent, their ratio.

    The times of the largest area are those to compare with the published ones (about 10 cm²). Where the
    module falls behind the ramp of that area, the conditions say so.
    """
    ramps = f"display ramp of {RAMP_K_PER_S:g} K/s up to {RAMP_K:g} K from 31 °C, forearm, warm or cold?"
    largest = AREAS_CM2[-1]

    @cache
    def at(channel: Channel, area_cm2: float, observer: Observer) -> float:
        bench = _bench("forearm", area_cm2, "display", 31.0)
        found = choice_reaction_time(observer, bench, channel, rate_K_per_s=RAMP_K_PER_S, size_K=RAMP_K)
        return float(found.quantile()[0])

    def exponent(channel: Channel, observer: Observer) -> float:
        times = [at(channel, area, observer) for area in AREAS_CM2]
        return float(np.polyfit(np.log(AREAS_CM2), np.log(times), 1)[0])

    said = {c: f"{ramps}{_behind(_bench('forearm', largest, 'display', 31.0), c)}" for c in CHANNELS}
    asked = [
        Asked(f"reaction time at {area:g} cm²", channel, "s", said[channel], partial(at, channel, area))
        for channel in CHANNELS
        for area in AREAS_CM2
    ]
    asked += [
        Asked("exponent of area", c, "1", f"{said[c]}; over {AREAS_CM2} cm²", partial(exponent, c)) for c in CHANNELS
    ]
    asked.append(Asked("warm over cold", "both", "1", ramps, lambda o: at("warm", largest, o) / at("cold", largest, o)))
    return predict("choice reaction time", asked, variable, draws, seed)


def _behind(bench: Bench, channel: Channel) -> str:
    """What keeps the display from following the reaction-time ramp; nothing where it follows."""
    (trace,) = bench.play([ramp(channel, RAMP_K, RAMP_K_PER_S)], RAMP_K / RAMP_K_PER_S).traces
    return "" if trace.reason is None else f"; the display {trace.reason}"


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


@lru_cache(maxsize=512)
def _limits(bench: Bench, channel: Channel, observer: Observer) -> float:
    """Limits of the nominal person, which two experiments on the hand ask for."""
    return float(method_of_limits(observer, bench, channel)[0])


@lru_cache(maxsize=32)
def _bench(rig: str, area_cm2: float, surface: Surface, baseline_C: float) -> Bench:
    return Bench(Rig.load(rig).with_(**{"contact.area_cm2": area_cm2}), baseline_C, surface)


def peak_lead(variable: Variable = "temperature", *, draws: int = DRAWS, seed: int = 0) -> tuple[Predicted, ...]:
    """Felt peak minus physical peak (s, negative: felt before), and lag of the felt onset, per channel.

    The stimulus is one smooth pulse, size·(1 − cos 2πt/T)/2 of the display on the thenar. The physical
    peak is that of the display, then that of the face of the skin; the felt one is on the percept clock.
    The onset lag, also on the percept clock, of the pulse and of a steep step, is what heat must lead a
    touch by to seem simultaneous if touch itself took no time.
    """
    said = f"raised-cosine display pulse of {PULSE_K:g} K in {PULSE_S:g} s, thenar, percept clock"

    def lead(surface: Surface, channel: Channel, observer: Observer) -> float:
        played = _pulse(channel)
        peak = perceive(played.traces[0], observer).felt_peak_s(channel)
        moved = sign_of(channel) * played.surface_C(surface)[0]
        return float(np.inf) if peak is None else peak - float(played.time_s[int(moved.argmax())])

    def onset(play: Callable[[Channel], Stimulus], channel: Channel, observer: Observer) -> float:
        found = perceive(play(channel).traces[0], observer)
        return float(np.inf) if found.onset_s is None else found.onset_s - observer.decision_s

    asked = [Asked("felt peak minus the display's", c, "s", said, partial(lead, "display", c)) for c in CHANNELS]
    asked += [Asked("felt peak minus the skin's", c, "s", said, partial(lead, "skin", c)) for c in CHANNELS]
    asked += [Asked("lag of the felt onset", c, "s", said, partial(onset, _pulse, c)) for c in CHANNELS]
    asked += [Asked("lag of the felt onset", c, "s", STEEP, partial(onset, _steep, c)) for c in CHANNELS]
    return predict("felt peak", asked, variable, draws, seed)


def first_and_return(variable: Variable = "temperature", *, draws: int = DRAWS, seed: int = 0) -> tuple[Predicted, ...]:
    """Probability that the return of a step near threshold is reported, for each direction of the step.

    The step is one that is reported in half of the trials by a yes/no observer who is not cautious, at
    1 K/s at the skin of the thenar, held, then returned; the report of the return is of the other channel
    after it began, by the same observer. Published: only the first direction is felt.
    """
    alarms = load_thresholds().one("false-alarm rate near threshold").central
    said = f"skin steps at 1 K/s half of which are reported, held for {HOLD_S:g} s, {alarms:g} false alarms, thenar"

    def returned(channel: Channel, observer: Observer) -> float:
        bench = _thenar("skin")
        asked = replace(observer, criterion=criterion_of(alarms, observer.noise_correlation_s, HOLD_S))
        size = yes_no(asked, bench, channel, hold_s=HOLD_S)
        start = round(size + HOLD_S, 2)
        played = bench.play([ramp(channel, size, 1.0, HOLD_S, back=True)], start + HOLD_S + 2.0)
        cold, warm = (psi[0, 0] for psi in played.felt(asked))
        after = (warm if channel == "cold" else cold)[round(start / played.dt_s) :]
        return float(detect(after, np.zeros_like(after), played.dt_s, asked).probability)

    asked = [Asked("report of the return", c, "proportion", said, partial(returned, c)) for c in CHANNELS]
    return predict("step and return near threshold", asked, variable, draws, seed)


@lru_cache(maxsize=2)
def _pulse(channel: Channel) -> Stimulus:
    return _thenar("display").play([raised_cosine(channel, PULSE_K, PULSE_S)], PULSE_S + 4.0)


@lru_cache(maxsize=2)
def _steep(channel: Channel) -> Stimulus:
    return _thenar("display").play([ramp(channel, STEEP_K, STEEP_K_PER_S, 2.0)], 4.0)


@lru_cache(maxsize=2)
def _thenar(surface: Surface) -> Bench:
    return Bench(Rig.load("thenar"), surface=surface)
