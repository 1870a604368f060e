"""The baseline that the model has to beat: a person who goes by the temperature of the skin and nothing else.

A change is noticed at one size, whatever its rate, area and method. Icons differ by the root mean square of the
difference of their skin temperatures until the longer of the two has ended, over one noise in K, and are named after
the nearest point, as by the model. The noise is set by the rate task, exactly as that of memory is (`task`). Skin
temperature has no delay and no scale of strength, so that it predicts no reaction times, lags and ratings.
"""

import math
from collections.abc import Sequence
from itertools import combinations
from statistics import NormalDist

import numpy as np

from ..arrays import Array
from ..identification.confusion import confuse
from ..observer.channels import Channel
from ..observer.observer import load_thresholds
from ..observer.people import People
from .targets import Published, Row
from .verdicts import judge_row

SAMPLES = 1024
"""Presentations of an icon to a person: with 200 people a pooled share is known to 0.001."""


def noticed_K(channel: Channel) -> float:
    """The change of skin temperature that is noticed: the published threshold by forced choice on the thenar, K."""
    return load_thresholds().one("detection threshold", channel=channel, site="thenar").central


def noise_K() -> float:
    """Noise at which the rate task comes out as published, mean square over its spans and both usual criteria, K.

    Of a ramp at a rate and one at k times the rate, both over a span s, the courses differ by (k − 1)·s/(k·√3), root
    mean square until the slower has ended: until 1/k of that time by (k − 1) times the slower, then by what it lacks.

    >>> round(noise_K(), 3)
    0.492
    """
    known = load_thresholds()
    faster = 1.0 + known.one("rate Weber fraction").central
    spans, criteria = (known.one(f"{what} of the rate task").interval for what in ("span", "criterion"))
    apart = [span * (faster - 1.0) / (faster * math.sqrt(3.0)) for span in spans]
    wanted = [math.sqrt(2.0) * NormalDist().inv_cdf(proportion) for proportion in criteria]
    return math.sqrt(sum((rms / d) ** 2 for rms in apart for d in wanted) / (len(apart) * len(wanted)))


def named_by_skin(skin_C: Array, rows: Sequence[int], crowd: People, seed: int) -> Array:
    """Confusions (people, icons, icons) by skin temperatures (people, icons, n_time), the icons so many rows long."""
    people, icons = skin_C.shape[:2]
    apart = np.zeros((people, icons, icons))
    for first, second in combinations(range(icons), 2):
        end = max(rows[first], rows[second])
        rms = np.sqrt(np.square(skin_C[:, first, :end] - skin_C[:, second, :end]).mean(axis=1))
        apart[:, first, second] = apart[:, second, first] = rms
    return confuse(apart / noise_K(), lapse=crowd.lapse, seed=seed, samples=SAMPLES).probability


def nearer_of(row: Row, model: float | None, baseline: float | None, published: Published) -> str:
    """Which of `model` and `baseline` is nearer to what was published; `both` where they are as near.

    To its number or interval, where there is one of the same quantity, else to the criterion of the row. Nothing where
    there is neither, or no baseline.
    """
    low, high = published.low, published.high
    if published.value is not None:
        low = high = published.value
    numbered = row.compared and row.unit == published.unit

    def off(value: float | None) -> tuple[bool, float]:
        if numbered and low is not None and high is not None:
            return False, math.inf if value is None else max(low - value, value - high, 0.0)
        verdict = judge_row(row, value, published)
        return verdict.holds is not True, verdict.miss

    (missed, model_off), (other_missed, baseline_off) = off(model), off(baseline)
    if baseline is None or (missed and not row.judged):
        return ""
    if missed == other_missed and math.isclose(model_off, baseline_off):
        return "both"
    return "model" if (missed, model_off) < (other_missed, baseline_off) else "baseline"
