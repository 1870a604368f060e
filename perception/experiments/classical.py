"""Psychophysical procedures, simulated: the same observer asked in the ways that laboratories ask.

Published thresholds differ tenfold by method. A forced choice needs no criterion; yes/no, limits,
levels and reaction times have one, set by its false alarms. Each function plays stimuli on a bench
and returns a number for every person. The rig is the bench's for all: people differ here in
thresholds, conduction and decision, not in skin or touch.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from statistics import NormalDist

import numpy as np

from ..arrays import Array
from ..observer.channels import Channel
from ..observer.observer import Observer
from ..observer.people import People
from ..sensation.bench import Bench, Stimulus, ramp
from ..sensation.detection import criterion_of
from ..sensation.first_passage import ResponseTimes, response_times
from .measured import Crowd, Measurement, crowd_of
from .ramps import FEEBLE, ramps, size_reaching

UNIT_PROPORTION = NormalDist().cdf(2.0**-0.5)
"""Proportion correct of d′ = 1 in a choice of two, Φ(1/√2) = 0.76: what calibration takes a threshold to be."""


def forced_choice(
    observer: Observer,
    bench: Bench,
    channel: Channel,
    *,
    rate_K_per_s: float = 1.0,
    hold_s: float = 3.0,
    proportion: float = UNIT_PROPORTION,
    people: People | None = None,
) -> Measurement:
    """Measure a threshold in a choice of two intervals, one with a ramp that is held.

    The choice is correct with Φ(d′/√2), d′ being the largest sensation of either channel above rest.

    Parameters
    ----------
    observer, bench, channel
        The nominal person, what plays the ramps, and `cold` or `warm`.
    rate_K_per_s
        Rate of the ramp, K/s.
    hold_s
        How long it is held, s.
    proportion
        Proportion correct at threshold; by default that of d′ = 1.
    people
        Virtual people; None: the nominal person alone.

    Returns
    -------
    Measurement
        Threshold of each person, K.

    Raises
    ------
    ValueError
        For a proportion that is not between 0.5 and 1.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> found = forced_choice(Observer.load(), Bench(Rig.load("thenar")), "cold")
    >>> round(found.value, 3), found.unit
    (0.121, 'K')
    """
    if not 0.5 < proportion < 1.0:
        raise ValueError(f"the proportion correct in a choice of two lies between 0.5 and 1, not {proportion:g}")
    played, crowd = ramps(bench, channel, rate_K_per_s, hold_s), crowd_of(observer, bench.rig.site, people)
    d_prime = np.sqrt(2.0) * NormalDist().inv_cdf(proportion)

    def log_peak(k: int) -> Array:
        logs: Array = np.log(np.maximum(played.peak(k, observer, crowd), FEEBLE))
        return logs

    return Measurement(
        "forced choice of two",
        channel,
        "K",
        size_reaching(log_peak, played.sizes_K, float(np.log(d_prime))),
        f"{said_of(bench, rate_K_per_s)}, held {hold_s:g} s, {proportion:.3g} correct",
    )


def yes_no(
    observer: Observer,
    bench: Bench,
    channel: Channel,
    *,
    rate_K_per_s: float = 1.0,
    hold_s: float = 3.0,
    hits: float = 0.5,
    false_alarms: float | None = None,
    people: People | None = None,
) -> Measurement:
    """Measure the threshold at which a share of ramps is reported, beyond false alarms.

    Parameters
    ----------
    observer, bench, channel
        The nominal person, what plays the ramps, and `cold` or `warm`.
    rate_K_per_s
        Rate of the ramp, K/s.
    hold_s
        How long it is held, s.
    hits
        Share of ramps that is reported at threshold.
    false_alarms
        Share of false alarms in an empty trial as long as the shortest one; None keeps the observer's criterion.
    people
        Virtual people; None: the nominal person alone.

    Returns
    -------
    Measurement
        Threshold of each person, K.

    Raises
    ------
    ValueError
        For a share that is not between 0 and 1.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> yes_no(Observer.load(), Bench(Rig.load("thenar")), "cold").unit
    'K'
    """
    if not 0.0 < hits < 1.0:
        raise ValueError(f"the share of hits lies between 0 and 1, not {hits:g}")
    played, crowd = ramps(bench, channel, rate_K_per_s, hold_s), crowd_of(observer, bench.rig.site, people)
    asked = observer
    if false_alarms is not None:
        asked = replace(observer, criterion=criterion_of(false_alarms, observer.noise_correlation_s, hold_s))
    return Measurement(
        "yes/no",
        channel,
        "K",
        size_reaching(lambda k: played.reported(k, asked, crowd), played.sizes_K, hits),
        f"{said_of(bench, rate_K_per_s)}, held {hold_s:g} s, {hits:g} reported, criterion {asked.criterion:.2f} d′",
    )


def method_of_limits(
    observer: Observer,
    bench: Bench,
    channel: Channel,
    *,
    rate_K_per_s: float = 1.0,
    limit_K: float = 12.0,
    people: People | None = None,
) -> Measurement:
    """Measure how far a steady ramp has come at the bench's surface when half of the trials are answered.

    The answer waits for the criterion, conduction and decision; it may be a false alarm.

    Parameters
    ----------
    observer, bench, channel
        The nominal person, what plays the ramp, and `cold` or `warm`.
    rate_K_per_s
        Rate of the ramp, K/s.
    limit_K
        Where the ramp ends, K.
    people
        Virtual people; None: the nominal person alone.

    Returns
    -------
    Measurement
        Threshold of each person, K; inf where the end comes first.

    Raises
    ------
    CueErrors
        For a rate or a limit that is not above 0.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> method_of_limits(Observer.load(), Bench(Rig.load("thenar")), "cold").unit
    'K'
    """
    played, pressed = _half_answered(observer, bench, channel, rate_K_per_s, limit_K, people)
    each = change_at(pressed, played, bench, limit_K / rate_K_per_s)
    return Measurement("method of limits", channel, "K", each, f"{said_of(bench, rate_K_per_s)} up to {limit_K:g} K")


def change_at(pressed_s: Array, played: Stimulus, bench: Bench, end_s: float) -> Array:
    """How far the bench's surface has moved at some times, K without sign; inf for a time after the end of the ramp."""
    moved = np.abs(played.surface_C(bench.surface)[0] - bench.baseline_C)
    inside = pressed_s <= end_s
    return np.where(inside, np.interp(np.where(inside, pressed_s, 0.0), played.time_s, moved), np.inf)


def choice_reaction_time(
    observer: Observer,
    bench: Bench,
    channel: Channel,
    *,
    rate_K_per_s: float = 5.0,
    size_K: float = 8.0,
    people: People | None = None,
) -> ResponseTimes:
    """Predict the time from the start of a ramp to the answer warm or cold.

    Parameters
    ----------
    observer, bench, channel
        The nominal person, what plays the ramp, and `cold` or `warm`.
    rate_K_per_s
        Rate of the ramp, K/s.
    size_K
        Where it ends, K.
    people
        Virtual people; None: the nominal person alone.

    Returns
    -------
    ResponseTimes
        A distribution for each person.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> times = choice_reaction_time(Observer.load(), Bench(Rig.load("thenar")), "cold")
    >>> bool(0.3 < times.quantile()[0] < 2.0)
    True
    """
    return ramp_responses(observer, bench, channel, rate_K_per_s, size_K, people, choice_s=observer.choice_s)[1]


def ramp_responses(
    observer: Observer,
    bench: Bench,
    channel: Channel,
    rate_K_per_s: float,
    size_K: float,
    people: People | None = None,
    *,
    choice_s: float = 0.0,
) -> tuple[Stimulus, ResponseTimes]:
    """A ramp in K/s up to a size in K, and when people answer it; `choice_s` is what a choice adds, s."""
    played = _ramp(bench, channel, rate_K_per_s, size_K)
    return played, _responses(played, observer, crowd_of(observer, bench.rig.site, people), choice_s=choice_s)


def said_of(bench: Bench, rate_K_per_s: float) -> str:
    """What was played, in words."""
    return f"{rate_K_per_s:g} K/s at the {bench.surface} from {bench.baseline_C:g} °C on {bench.rig.name}"


@lru_cache(maxsize=32)
def _ramp(bench: Bench, channel: Channel, rate_K_per_s: float, size_K: float) -> Stimulus:
    return bench.play([ramp(channel, size_K, rate_K_per_s)], round(size_K / rate_K_per_s + 2.0, 2))


EARLY = 1.0 / 3.0
"""Share of a ramp by whose end nearly everybody has answered: the rest is computed only for those who have not."""


def _half_answered(
    observer: Observer, bench: Bench, channel: Channel, rate_K_per_s: float, limit_K: float, people: People | None
) -> tuple[Stimulus, Array]:
    """The ramp and the time (people,) by which half of the trials are answered, s; inf where fewer are."""
    played, crowd = _ramp(bench, channel, rate_K_per_s, limit_K), crowd_of(observer, bench.rig.site, people)
    early = int(EARLY * played.rows)
    pressed = _responses(played, observer, crowd, rows=early).quantile(0.5)
    late = pressed >= played.dt_s * (early - 1)
    if late.any():
        pressed[late] = _responses(played, observer, crowd.part(late)).quantile(0.5)
    return played, pressed


def _responses(
    played: Stimulus, observer: Observer, crowd: Crowd, *, choice_s: float = 0.0, rows: int | None = None
) -> ResponseTimes:
    """Answers to a ramp, or to its first rows."""
    cold, warm = (psi[:, 0, :rows] for psi in played.felt(observer, crowd.threshold_cold, crowd.threshold_warm))
    return response_times(
        cold,
        warm,
        played.dt_s,
        observer,
        conduction_s=crowd.conduction_s,
        decision_s=crowd.decision_s + choice_s,
        criterion=crowd.criterion,
    )
