"""When a noisy sensation first passes the criterion: a distribution of times, not one crossing.

Sensation is its mean plus unit noise of autocorrelation e^(−t²/2τ²). The rate of first crossings of
a criterion not passed yet is Rice's for a moving mean, over the probability of being below it; this
takes crossings as independent, good as long as they are rare or the rise is fast (tests compare it
with drawn noise). A response comes later by the conduction of its channel and by decision.
The rule itself is compiled, in `kernels.passage`; detection and response times share it.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_rows, own_arrays
from ..kernels.parallel import over_rows
from ..observer.observer import Observer


@dataclass(frozen=True, slots=True)
class ResponseTimes:
    """Distributions of response times, one a row: `time_s` (n_time,), `probability` (rows, n_time) of one by then.

    `cold_share` (rows,) is the share of the responses that the cold channel gave.
    """

    time_s: Array
    probability: Array
    cold_share: Array

    def __post_init__(self) -> None:
        own_arrays(self, "time_s", "probability", "cold_share")
        if self.probability.shape != (self.cold_share.size, self.time_s.size):
            raise ValueError(f"response times: {self.probability.shape} probabilities for {self.time_s.size} times")

    def quantile(self, share: float = 0.5) -> Array:
        """Time (rows,) by which a response came in this share of trials, s; inf where it comes in fewer.

        Early false alarms count, as they do in an experiment.
        """
        if not 0.0 < share < 1.0:
            raise ValueError(f"a share of trials lies between 0 and 1, not {share:g}")
        return np.array([time_of(given, self.time_s, share) for given in self.probability])

    def __repr__(self) -> str:
        low, middle, high = (float(np.median(self.quantile(share))) for share in (0.25, 0.5, 0.75))
        by = f"quarters by {low:.2f}, {middle:.2f} and {high:.2f} s"
        return f"ResponseTimes({self.cold_share.size} rows: {by})"


def response_times(
    psi_cold: ArrayLike,
    psi_warm: ArrayLike,
    dt_s: float,
    observer: Observer,
    *,
    conduction_s: tuple[ArrayLike, ArrayLike],
    decision_s: ArrayLike,
    criterion: tuple[ArrayLike, ArrayLike] = (1.0, 1.0),
) -> ResponseTimes:
    """Response to whichever channel's crossing arrives first; sensations of shape (..., n_time).

    `conduction_s` (cold, warm), `decision_s` in s and `criterion` (cold, warm), in multiples of the observer's, are one
    number or one for each leading index. Gain and decision differ from trial to trial. Times run on past the end of
    the sensations by the slowest delay, so that none is cut off.

    >>> import numpy as np
    >>> rise = np.minimum(np.arange(0.0, 2.0, 0.01) * 20.0, 20.0)
    >>> found = response_times(rise, 0 * rise, 0.01, Observer.load(), conduction_s=(0.3, 1.4), decision_s=0.2)
    >>> bool(0.5 < found.quantile()[0] < 0.9)
    True
    """
    rows, samples = as_rows(psi_cold)[0].shape
    slowest = float(np.exp(quarters(observer.decision_noise)).max() * np.max(decision_s))
    latest = max(float(np.max(each)) for each in conduction_s) + slowest
    times = samples + int(np.ceil(latest / dt_s)) + 1
    _, given, share = report_courses(
        psi_cold, psi_warm, dt_s, observer, conduction_s, decision_s, criterion, times=times, corrected=False
    )
    return ResponseTimes(dt_s * np.arange(times), given.reshape(rows, times), share.reshape(rows))


def report_courses(
    psi_cold: ArrayLike,
    psi_warm: ArrayLike,
    dt_s: float,
    observer: Observer,
    conduction_s: tuple[ArrayLike, ArrayLike],
    decision_s: ArrayLike,
    criterion: tuple[ArrayLike, ArrayLike],
    *,
    times: int,
    corrected: bool,
    every: int = 1,
) -> tuple[Array, Array, Array]:
    """Probability (...,) of a report, of one by each of so many times (..., times), and cold's share of it.

    Arguments are as in `response_times`; times lie `every` samples apart. Corrected, reports of noise alone are left
    out. Without times (0) only the first is computed.
    """
    from ..kernels.reports import report

    (cold, shape), (warm, warm_shape) = as_rows(psi_cold), as_rows(psi_warm)
    if shape != warm_shape:
        raise ValueError(f"cold and warm sensation differ in shape: {shape} and {warm_shape}")
    rows, lead = cold.shape[0], shape[:-1]

    def both(values: tuple[ArrayLike, ArrayLike]) -> Array:
        return np.stack([np.broadcast_to(np.asarray(own, dtype=np.float64), lead).reshape(-1) for own in values], -1)

    criteria, late = observer.criterion * both(criterion), both(conduction_s)
    decisions = both((decision_s, 0.0))[:, :1] * np.exp(quarters(observer.decision_noise))
    raised = np.exp(observer.p * quarters(observer.gain_noise))
    probability, reported, share = np.empty(rows), np.empty((rows, times)), np.zeros(rows)

    def work(part: slice) -> None:
        report(
            cold[part], warm[part], dt_s, criteria[part], observer.noise_correlation_s, observer.a, raised,
            late[part], decisions[part], corrected, every, probability[part], reported[part], share[part],
        )  # fmt: skip

    over_rows(work, rows, cold.size)
    return probability.reshape(lead), reported.reshape(*lead, times), share.reshape(lead)


def time_of(given: Array, time_s: Array, probability: float) -> float:
    """When (s) the probability (n_time,) of a report first reaches a value; inf where it never does.

    >>> time_of(np.array([0.0, 0.2, 0.6]), np.array([0.0, 1.0, 2.0]), 0.4)
    1.5
    """
    reached = given >= probability
    k = int(reached.argmax())
    if not reached[k]:
        return float(np.inf)
    return float(np.interp(probability, given[k - 1 : k + 1], time_s[k - 1 : k + 1])) if k else float(time_s[0])


def quarters(sd: float) -> Array:
    """A normal number of mean 0 at the middles of four equal parts of its distribution; 0 alone where it has no spread.

    >>> quarters(1.0).round(2)
    array([-1.15, -0.32,  0.32,  1.15])
    """
    if sd == 0.0:
        return np.zeros(1)
    return sd * np.array([NormalDist().inv_cdf(share) for share in (0.125, 0.375, 0.625, 0.875)])
