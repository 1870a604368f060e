"""Published experiments on peaks, onsets and returns, run on the observer.

As in `experiments`: predictions with intervals, for one sensory variable and receptor model, and
what is not stated where an experiment was found is stated here as a condition.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial

import numpy as np

from thermicon.circuit import Rig

from ..experiments.on_bench import yes_no
from ..observer.channels import CHANNELS, Channel, Variable, sign_of
from ..observer.observer import Observer, load_thresholds
from ..sensation.bench import Bench, Stimulus, Surface, raised_cosine, ramp
from ..sensation.detection import criterion_of, detect
from ..sensation.percept import perceive
from .predicted import DRAWS, Asked, Predicted, predict

PULSE_K, PULSE_S = 4.0, 8.0
HOLD_S = 4.0
STEEP_K, STEEP_K_PER_S = 4.0, 3.0
STEEP = f"display step of {STEEP_K:g} K at {STEEP_K_PER_S:g} K/s, thenar, percept clock"


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
