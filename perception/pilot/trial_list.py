r"""Which few icons to present in a pilot: the list that is expected to narrow the prediction of a set most.

A list presents each icon n_a times to one participant, who may give any name of the set. Its worth is the expected
variance of the laboratory's proportion correct Q once the answers y are known,

    E_y Var(Q | y),   Var(Q | y) = Σ w_ℓ Q_ℓ² − (Σ w_ℓ Q_ℓ)²,   w_ℓ ∝ (1/S) Σ_s Π C_ℓs[a, y]

with y simulated in one laboratory after the other, which then carries no weight. Presentations are added one by one,
each the one that leaves the least variance; the finished list is judged on other simulated answers than it was made
with, beside random lists of the same length.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .playing import Confusions

EXPERIMENTS, JUDGED, RANDOM_LISTS = 320, 480, 8
MOST_STEPS = 30
"""Longer lists are built of several presentations at a time."""
MOST_LABORATORIES = 250


@dataclass(frozen=True, slots=True)
class TrialList:
    """A list of presentations: how often each icon, and the SD of the proportion correct that it is expected to leave.

    `sd_before` is without answers, `sd` after this list, `sd_random` after a random one (mean, and the SD between
    random lists), `sd_even` after one that presents all icons alike.
    """

    icons: tuple[str, ...]
    times: tuple[int, ...]
    sd_before: float
    sd: float
    sd_random: tuple[float, float]
    sd_even: float

    @property
    def length(self) -> int:
        """Number of presentations."""
        return sum(self.times)

    @property
    def presented(self) -> dict[str, int]:
        """How often each icon is presented, the most often first, without those that are not."""
        found = [(name, k) for name, k in zip(self.icons, self.times, strict=True) if k]
        return dict(sorted(found, key=lambda pair: -pair[1]))

    def order(self, seed: int = 0) -> tuple[str, ...]:
        """The presentations in random order."""
        every = [name for name, k in zip(self.icons, self.times, strict=True) for _ in range(k)]
        rng = np.random.default_rng(np.random.SeedSequence([seed, 21]))
        return tuple(every[k] for k in rng.permutation(len(every)))

    def to_dict(self, seed: int = 0) -> dict[str, Any]:
        """Plain data for JSON."""
        return {
            "length": self.length,
            "presented": self.presented,
            "order": list(self.order(seed)),
            "sd_before": self.sd_before,
            "sd_expected": self.sd,
            "sd_expected_random": self.sd_random[0],
            "sd_expected_even": self.sd_even,
        }


class Answers:
    """Answers simulated once for as many presentations of each icon as any list has: lists share their chance."""

    def __init__(self, played: Confusions, target: Array, length: int, experiments: int, seed: int) -> None:
        rng = np.random.default_rng(np.random.SeedSequence([seed, 22]))
        probability = played.probability[:MOST_LABORATORIES].astype(np.float64)
        laboratories, people, icons = probability.shape[:3]
        self.target = target[:laboratories]
        self.logs: Array = np.log(probability).transpose(2, 3, 0, 1).astype(np.float32)  # icon, answer, lab., person
        self.truth = np.arange(experiments) % laboratories
        person = rng.integers(people, size=experiments)
        upper = probability[self.truth, person].cumsum(axis=-1)  # experiment, icon, answer
        self.said: NDArray[np.int64] = np.minimum(
            (rng.random((experiments, icons, length, 1)) > upper[:, :, None]).sum(axis=-1), icons - 1
        )

    def added(self, logs: Array, icon: int, first: int, last: int) -> Array:
        """Ln likelihoods (experiments, laboratories, people) after further presentations of an icon."""
        for k in range(first, last):
            logs = logs + self.logs[icon, self.said[:, icon, k]]
        return logs

    def none(self) -> Array:
        """Ln likelihoods before any answer."""
        return np.zeros((len(self.truth), *self.logs.shape[2:]), dtype=np.float32)

    def variance(self, logs: Array) -> float:
        """Expected variance of the target given the answers."""
        own = np.exp(logs - logs.max(axis=(1, 2), keepdims=True)).mean(axis=2, dtype=np.float64)
        own[np.arange(len(own)), self.truth] = 0.0  # nobody may be recognised as oneself
        own /= own.sum(axis=1, keepdims=True)
        mean = own @ self.target
        return float((own @ np.square(self.target) - np.square(mean)).mean())

    def of_list(self, times: NDArray[np.int64]) -> float:
        """Expected variance of the target after a list."""
        logs = self.none()
        for icon, k in enumerate(times.tolist()):
            logs = self.added(logs, icon, 0, k)
        return self.variance(logs)


def best_list(
    played: Confusions, target: Array, length: int, *, seed: int = 0, step: Callable[[], None] | None = None
) -> TrialList:
    """Build the list of so many presentations that is expected to narrow `target` (laboratories,) most.

    Raises ValueError for fewer than one presentation. `step` is called after each of `steps_of(length)` additions.
    """
    if length < 1:
        raise ValueError(f"a list needs at least one presentation, not {length}")
    icons = len(played.icons)
    made = Answers(played, target, length, EXPERIMENTS, seed)
    times, logs, left = np.zeros(icons, dtype=np.int64), made.none(), length
    at_once = -(-length // MOST_STEPS)
    while left:
        more = min(at_once, left)
        tried = [made.added(logs, icon, int(times[icon]), int(times[icon]) + more) for icon in range(icons)]
        best = int(np.argmin([made.variance(each) for each in tried]))
        logs, left = tried[best], left - more
        times[best] += more
        if step is not None:
            step()
    even = np.full(icons, length // icons) + (np.arange(icons) < length % icons)
    if made.of_list(even) <= made.variance(logs):  # one addition at a time may miss what icons are worth together
        times = even
    judged = Answers(played, target, length, JUDGED, seed + 1)
    rng = np.random.default_rng(np.random.SeedSequence([seed, 23]))
    random = [np.bincount(rng.integers(icons, size=length), minlength=icons) for _ in range(RANDOM_LISTS)]
    left_by = [math.sqrt(judged.of_list(each)) for each in random]
    return TrialList(
        played.icons,
        tuple(times.tolist()),
        math.sqrt(judged.variance(judged.none())),
        math.sqrt(judged.of_list(times)),
        (float(np.mean(left_by)), float(np.std(left_by))),
        math.sqrt(judged.of_list(even)),
    )


def steps_of(length: int) -> int:
    """Number of additions that a list of a length is built in."""
    return -(-length // -(-length // MOST_STEPS))
