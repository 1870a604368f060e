"""Detection: the probability that sensation is reported in a trial.

Sensation is its mean plus unit noise of autocorrelation e^(−t²/2τ²). A yes/no observer says yes when its change passes
a criterion, which is inferred from published answers. The rate of first crossings of a criterion not passed yet is
Rice's for a moving mean, over the probability of being below it; this takes crossings as independent, good as long as
they are rare or the rise is fast (tests compare it with drawn noise). A response comes later by the conduction of its
channel and by decision. The rule is compiled, in `kernels.crossing`; how often noise alone passes a criterion is
`false_alarms`. This is the definition of *felt* for every output: an icon is felt where at least half of the trials end
in a report, its onset is the median response time of those trials, its channel the one that most of them go by.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermicon.base.numbers.arrays import Array, as_rows

from ..criteria import FELT_FROM
from ..kernels.parallel import over_rows
from ..observer.observer import CHANNELS, Channel, Observer


def time_of(given: Array, time_s: Array, probability: float) -> float:
    """When (s) the probability (n_time,) of a report first reaches a value; inf where it never does."""
    reached = given >= probability
    k = int(reached.argmax())
    if not reached[k]:
        return float(np.inf)
    return float(np.interp(probability, given[k - 1 : k + 1], time_s[k - 1 : k + 1])) if k else float(time_s[0])


@lru_cache(maxsize=8)
def strata(count: int) -> Array:
    """Middles of equally likely parts of the standard normal distribution."""
    return np.array([NormalDist().inv_cdf((k + 0.5) / count) for k in range(count)])


def quarters(sd: float) -> Array:
    """A normal number of mean 0 at the middles of four equal parts of its distribution; without spread, 0 alone."""
    return np.zeros(1) if sd == 0.0 else sd * strata(4)


STEP_S = 0.02
"""Step of response times, over which they are linear: far below the spread of any of them."""
UNTIMED = "there are no response times: call detect with times=True"
LATEST_S = 5.0
"""Longest delay from the end of the sensations to a report that response times resolve; slower ones count as this."""


def report_step(dt_s: float) -> float:
    """Step (s) of the response times to sensations that are dt_s apart: whole samples, about `STEP_S`."""
    return dt_s * max(1, round(STEP_S / dt_s))


@dataclass(frozen=True, slots=True)
class Detection:
    """Trials that end in a report, arrays over traces: `probability` (...,), `cold_share` (...,) of the reports.

    `reported` (..., n_time) is that of a report by each time, `dt_s` apart (None: not asked for). Without any change an
    icon has probability 0: reports of noise alone are left out.
    """

    probability: Array
    cold_share: Array
    reported: Array | None
    dt_s: float

    @property
    def felt(self) -> NDArray[np.bool_]:
        """Whether at least half of the trials end in a report."""
        return np.asarray(self.probability >= FELT_FROM)

    @property
    def onset_s(self) -> Array:
        """Median response time (...,) of the trials that end in a report, s; NaN where the icon is not felt."""
        rows = self.courses.reshape(-1, self.courses.shape[-1])
        time: Array = self.dt_s * np.arange(rows.shape[1], dtype=np.float64)
        half = zip(rows, self.felt.reshape(-1).tolist(), strict=True)
        found = [time_of(row, time, 0.5 * float(row[-1])) if felt else math.nan for row, felt in half]
        return np.array(found).reshape(self.probability.shape)

    @property
    def courses(self) -> Array:
        """The `reported` courses; a ValueError where they were not asked for."""
        if self.reported is None:
            raise ValueError(UNTIMED)
        return self.reported

    def reported_sum(self) -> Array:
        """Number of persons, the first axis, who have reported by each time, with that axis kept (1, ..., n_time)."""
        return np.asarray(self.courses.sum(axis=0, keepdims=True))

    @property
    def channel(self) -> NDArray[np.int64]:
        """Channel (...,) that most reports go by: −1 not felt, 0 cold, 1 warm."""
        if self.reported is None:  # shares of the channels come with the times
            raise ValueError(UNTIMED)
        return np.where(self.felt, np.where(self.cold_share >= 0.5, 0, 1), -1).astype(np.int64)


def pooled(probability: Array, cold_share: Array, reported: Array, dt_s: float) -> Detection:
    """Detection by a person drawn at random, from persons (persons, ...) and the sum of their `reported`."""
    total, by_cold = probability.sum(axis=0), (probability * cold_share).sum(axis=0)
    share = np.divide(by_cold, total, out=np.zeros_like(total), where=total > 0.0)
    persons = len(probability)
    return Detection(total / persons, share, reported / persons, dt_s)


def detect(
    psi_cold: ArrayLike,
    psi_warm: ArrayLike,
    dt_s: float,
    observer: Observer,
    *,
    path_m: ArrayLike | None = None,
    criterion_cold: ArrayLike = 1.0,
    criterion_warm: ArrayLike = 1.0,
    decision_s: ArrayLike | None = None,
    times: bool = True,
) -> Detection:
    """Run the yes/no procedure on sensations of shape (..., n_time), with response `times` or without.

    What is detected is the change from the first sample, whose gain differs from presentation to presentation. Criteria
    are multiples of the observer's; the four keywords are one number or one for each leading index.
    """
    from ..kernels.reports import report

    path = np.asarray(observer.path_hand_m if path_m is None else path_m, dtype=np.float64)
    conduction = observer.delay_s("cold", path), observer.delay_s("warm", path)
    decision = observer.decision_s if decision_s is None else decision_s
    (cold, shape), (warm, warm_shape) = as_rows(psi_cold), as_rows(psi_warm)
    if shape != warm_shape:
        raise ValueError(f"cold and warm sensation differ in shape: {shape} and {warm_shape}")
    rows, lead = cold.shape[0], shape[:-1]
    step = report_step(dt_s)
    every = round(step / dt_s)
    count = math.ceil((shape[-1] + LATEST_S / dt_s) / every) if times else 0

    def each_row(*values: ArrayLike) -> Array:
        return np.stack([np.broadcast_to(np.asarray(own, dtype=np.float64), lead).reshape(-1) for own in values], -1)

    criteria = observer.criteria(observer.criterion, each_row(criterion_cold, criterion_warm))
    late = each_row(*conduction)
    decisions = each_row(decision) * np.exp(quarters(observer.decision_noise))
    raised = np.exp(observer.p * quarters(observer.gain_noise))
    probability, reported, share = np.empty(rows), np.empty((rows, count)), np.zeros(rows)

    def work(part: slice) -> None:
        report(
            cold[part], warm[part], dt_s, criteria[part], observer.noise_correlation_s, observer.a, raised,
            late[part], decisions[part], every, probability[part], reported[part], share[part],
        )  # fmt: skip

    over_rows(work, rows, cold.size)
    courses = reported.reshape(*lead, count) if times else None
    return Detection(probability.reshape(lead), share.reshape(lead), courses, step)


def channel_name(index: int) -> Channel | None:
    """Name of a channel index of `Detection.channel`; None where the icon is not felt."""
    return None if index < 0 else CHANNELS[index]


def false_alarms(criterion: float, correlation_s: float, wait_s: float) -> float:
    """Probability that noise alone passes the criterion in one of two channels within `wait_s`."""
    return -math.expm1(2.0 * log_no_crossing(criterion, correlation_s, wait_s))


def criterion_of(rate: float, correlation_s: float, wait_s: float) -> float:
    """Criterion (d′) whose false alarms in `wait_s` have probability `rate`, by bisection."""
    if not 0.0 < rate < 1.0:
        raise ValueError(f"the false-alarm rate must lie between 0 and 1, not {rate:g}")
    low, high = 0.0, 12.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if false_alarms(middle, correlation_s, wait_s) > rate else (low, middle)
    return 0.5 * (low + high)


def log_no_crossing(criterion: float, correlation_s: float, wait_s: float) -> float:
    """Log probability that one channel's noise, of autocorrelation e^(−t²/2τ²), stays below the criterion.

    Crossings come at Rice's rate over the probability of being below.
    """
    below = 0.5 * math.erfc(-criterion / math.sqrt(2.0))
    rate = math.exp(-0.5 * criterion * criterion) / (2.0 * math.pi * correlation_s)
    return math.log(below) - wait_s * rate / below
