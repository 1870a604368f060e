"""Published experiments run on the observer.

What is not stated where an experiment was found is stated here, as a condition. Constants were inferred from limits and
reaction times on the forearm, and from none of the others.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial
from itertools import product

import numpy as np

from thermicon.circuit import Rig

from ..experiments.measure import ADAPTIVE, Condition, Setting, logs_of
from ..identification.skin_alone import noticed_K
from ..observer.channels import CHANNELS, SIGN, Channel, Variable
from ..observer.mechanisms.age import YOUNG_YEARS
from ..observer.observer import Observer, load_thresholds
from ..sensation.bench import Bench, Stimulus, Surface, raised_cosine, ramp
from ..sensation.detection import criterion_of, detect
from ..sensation.percept import perceive
from .predicted import DRAWS, Predicted, Query, laboratory_of, predict

RATES_K_PER_S = (0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.3)
FLAT_K_PER_S = (0.1, 0.2, 0.3)
AREAS_CM2 = (2.5, 5.0, 10.0)
RAMP_K, RAMP_K_PER_S = 8.0, 5.0
PEOPLE = 100
LIMIT_K = 12.0
"""Where a ramp of limits ends, K."""
SIZES_K = np.geomspace(0.005, 8.0, 33)
"""Sizes of forced choice: many, since a threshold is compared with that at another rate."""
AT_THE_SKIN = 1e-7
"""Contact resistance of a stimulus that is prescribed at the skin, m²K/W: none that counts."""
LIMITS: dict[str, tuple[str, float]] = {"hand": ("hand-dorsum", 9.0), "forearm": ("forearm", 10.0)}
"""Rig and area of contact, cm²; on the hand it is not stated where the norms were found, and is assumed."""
PULSE_K, PULSE_S = 4.0, 8.0
HOLD_S = 4.0
STEEP_K, STEEP_K_PER_S = 4.0, 3.0
STEEP = f"display step of {STEEP_K:g} K at {STEEP_K_PER_S:g} K/s, thenar, percept clock"


@lru_cache(maxsize=2048)
def measured(setting: Setting, condition: Condition, person: Observer) -> float:
    """A person's result in a task, in the unit of the condition; inf where the largest change is not felt."""
    value = float(np.exp(logs_of(laboratory_of(person, setting), setting, condition, SIZES_K)[0].mean()))
    return value if condition.method not in ADAPTIVE or value < 0.999 * SIZES_K[-1] else np.inf


def _threshold(method: str, channel: Channel, rate_K_per_s: float = 1.0, hold_s: float = 3.0) -> Condition:
    size = LIMIT_K if method == "limits" else None
    return Condition("threshold", method, channel, 32.0, size, rate_K_per_s, hold_s)


def rate_curve(variable: Variable = "temperature", *, draws: int = DRAWS, seed: int = 0) -> tuple[Predicted, ...]:
    """Thresholds on the forearm against the rate of change, as Kenshalo, Holmes & Wood 1968 studied."""
    setting = Setting("forearm", AT_THE_SKIN, 9.0)
    how = "forced choice at the skin, forearm, from 32 °C; the end of the ramp is held for 1 s"

    def at(channel: Channel, rate: float, person: Observer) -> float:
        return measured(setting, _threshold("forced_choice", channel, rate, 1.0), person)

    def change(channel: Channel, person: Observer) -> float:
        found = [at(channel, rate, person) for rate in FLAT_K_PER_S]
        return max(found) / min(found) - 1.0

    def raised(channel: Channel, rate: float, person: Observer) -> float:
        return at(channel, rate, person) / at(channel, FLAT_K_PER_S[0], person)

    queries, named = [], {rate: f"threshold at {rate:g} K/s" for rate in RATES_K_PER_S}
    for channel in CHANNELS:
        queries += [
            Query(name, channel, "K", how, partial(at, channel, rate), noticed_K(channel))
            for rate, name in named.items()
        ]
        queries.append(Query("largest change over 0.1 to 0.3 K/s", channel, "1", how, partial(change, channel), 0.0))
        queries += [
            Query(f"{name} over that at 0.1", channel, "1", how, partial(raised, channel, rate), 1.0)
            for rate, name in named.items()
            if rate not in FLAT_K_PER_S
        ]
    return predict("rate curve", queries, variable, draws, seed)


def limits(
    site: str = "hand",
    variable: Variable = "temperature",
    *,
    people: int = PEOPLE,
    age_years: float | None = None,
    draws: int = DRAWS,
    seed: int = 0,
) -> tuple[Predicted, ...]:
    """Limits at 1 °C/s from 32 °C, cold then warm: the median of `people`, of 20 to 30 years if no age is given."""
    rig, area = LIMITS[site]
    setting, aged = _setting(rig, area), "" if age_years is None else f", {age_years:g} years"
    how = f"display ramp of 1 K/s, {area:g} cm²{aged}"
    years = YOUNG_YEARS if age_years is None else age_years
    crowd = laboratory_of(Observer.load(variable=variable), setting, people=people, seed=seed, age_years=years)
    conditions = [_threshold("limits", channel) for channel in CHANNELS]
    queries = [
        Query("limits threshold", one.channel, "K", how, partial(measured, setting, one), noticed_K(one.channel))
        for one in conditions
    ]
    found = predict(f"limits on the {site}", queries, variable, draws, seed)
    middle = [float(np.median(np.exp(logs_of(crowd, setting, one)[0]))) for one in conditions]
    return tuple(replace(each, value=value) for each, value in zip(found, middle, strict=True))


def reaction_times(variable: Variable = "temperature", *, draws: int = DRAWS, seed: int = 0) -> tuple[Predicted, ...]:
    """Choice reaction times on the forearm at 5 °C/s from 31 °C: a median for each area, their exponent and ratio."""
    how = f"display ramp of {RAMP_K_PER_S:g} K/s up to {RAMP_K:g} K from 31 °C, forearm, warm or cold?"
    widest = AREAS_CM2[-1]

    def at(channel: Channel, area_cm2: float, person: Observer) -> float:
        timed = Condition("reaction_time", "choice", channel, 31.0, RAMP_K, RAMP_K_PER_S, 0.0)
        return measured(_setting("forearm", area_cm2), timed, person)

    def exponent(channel: Channel, person: Observer) -> float:
        times = [at(channel, area, person) for area in AREAS_CM2]
        return float(np.polyfit(np.log(AREAS_CM2), np.log(times), 1)[0])

    queries = [
        Query(f"reaction time at {area:g} cm²", channel, "s", how, partial(at, channel, area))
        for channel, area in product(CHANNELS, AREAS_CM2)
    ]
    queries += [
        Query("exponent of area", c, "1", f"{how}; over {AREAS_CM2} cm²", partial(exponent, c)) for c in CHANNELS
    ]
    queries.append(Query("warm over cold", "both", "1", how, lambda o: at("warm", widest, o) / at("cold", widest, o)))
    return predict("choice reaction time", queries, variable, draws, seed)


def _setting(rig: str, area_cm2: float) -> Setting:
    """The skin of a rig under its own contact."""
    return replace(Setting.of(Rig.load(rig)), area_cm2=area_cm2)


def peak_lead(variable: Variable = "temperature", *, draws: int = DRAWS, seed: int = 0) -> tuple[Predicted, ...]:
    """Felt peak minus physical peak (s, negative: felt before), and lag of the felt onset, per channel.

    The stimulus is one smooth pulse of the display on the thenar, for the onset also a steep step: its lag is what heat
    must lead a touch by to seem simultaneous if touch itself took no time.
    """
    how = f"raised-cosine display pulse of {PULSE_K:g} K in {PULSE_S:g} s, thenar, percept clock"

    def lead(surface: Surface, channel: Channel, person: Observer) -> float:
        played = _pulse(channel)
        peak = perceive(played.traces[0], person).felt_peak_s(channel)
        moved = SIGN[channel] * played.surface_C(surface)[0]
        return float(np.inf) if peak is None else peak - float(played.time_s[int(moved.argmax())])

    def onset(play: Callable[[Channel], Stimulus], channel: Channel, person: Observer) -> float:
        found = perceive(play(channel).traces[0], person)
        return float(np.inf) if found.onset_s is None else found.onset_s - person.decision_s

    queries = [Query("felt peak minus the display's", c, "s", how, partial(lead, "display", c)) for c in CHANNELS]
    queries += [Query("felt peak minus the skin's", c, "s", how, partial(lead, "skin", c)) for c in CHANNELS]
    queries += [Query("lag of the felt onset", c, "s", how, partial(onset, _pulse, c)) for c in CHANNELS]
    queries += [Query("lag of the felt onset", c, "s", STEEP, partial(onset, _steep, c)) for c in CHANNELS]
    return predict("felt peak", queries, variable, draws, seed)


def first_and_return(variable: Variable = "temperature", *, draws: int = DRAWS, seed: int = 0) -> tuple[Predicted, ...]:
    """Probability that the return of a step near threshold is reported, for each direction of the step.

    Half of the steps are reported by an observer who is not cautious. Published: only the first direction is felt.
    """
    alarms = load_thresholds().one("false-alarm rate near threshold").central
    how = f"skin steps at 1 K/s half of which are reported, held for {HOLD_S:g} s, {alarms:g} false alarms, thenar"
    setting = Setting("thenar", AT_THE_SKIN, 9.0)

    def returned(channel: Channel, person: Observer) -> float:
        criterion = criterion_of(alarms, person.noise_correlation_s, HOLD_S)
        keen = replace(person, criterion=criterion, unhurried=criterion)
        size = measured(setting, _threshold("yes_no", channel, hold_s=HOLD_S), keen)
        start = round(size + HOLD_S, 2)
        played = _thenar("skin").play([ramp(channel, size, 1.0, HOLD_S, back=True)], start + HOLD_S + 2.0)
        cold, warm = (psi[0] for psi in played.felt(keen))
        after = (warm if channel == "cold" else cold)[round(start / played.dt_s) :]
        return float(detect(after, np.zeros_like(after), played.dt_s, keen).probability)

    queries = [Query("report of the return", c, "proportion", how, partial(returned, c)) for c in CHANNELS]
    return predict("step and return near threshold", queries, variable, draws, seed)


@lru_cache(maxsize=2)
def _pulse(channel: Channel) -> Stimulus:
    return _thenar("display").play([raised_cosine(channel, PULSE_K, PULSE_S)], PULSE_S + 4.0)


def _steep(channel: Channel) -> Stimulus:
    return _thenar("display").play([ramp(channel, STEEP_K, STEEP_K_PER_S, 2.0)], 4.0)


def _thenar(surface: Surface) -> Bench:
    return Bench(Rig.load("thenar"), surface=surface)
