"""Answers of an experiment in which icons were named, and their scores: per cent correct and bits, with intervals.

Bits are the plug-in estimate, which is biased upwards by about (cells − rows − columns + 1)/(2·trials·ln 2) with
counts of what was used (Miller 1955); less that, they are called Miller–Madow here. Answers that are possible but did
not occur are not counted, so that with a few trials an icon some bias is left. The interval is normal about the
corrected bits, with the jackknife's standard error over participants, or over trials where there is one participant.

A few participants may happen to be alike, or right throughout: the interval of all answers is therefore never narrower
than the one that their number alone leaves, Wilson's for per cent correct and the jackknife over trials for bits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, own_arrays


@dataclass(frozen=True, slots=True)
class Trials:
    """Answers of some participants to the icons of a set.

    `icons` are the names of all that could be answered, in the order of the set; `counts` (participants, icons
    presented, icons answered). `time_s` is the median time of each participant's correct answers, s (NaN: none was
    recorded); `source` and `digest` are the name of the file and the first 16 digits of its SHA-256, `warnings` what is
    doubtful about it, with place and cure.

    Examples
    --------
    >>> import numpy as np
    >>> Trials(("a", "b"), ("p1",), np.array([[[9.0, 1.0], [2.0, 8.0]]]))
    Trials(1 participant, 20 trials, 2 icons)
    """

    icons: tuple[str, ...]
    participants: tuple[str, ...]
    counts: Array
    time_s: tuple[float, ...] = ()
    source: str = ""
    digest: str = ""
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        own_arrays(self, "counts")
        counts = self.counts
        wanted = (len(self.participants), len(self.icons), len(self.icons))
        if counts.shape != wanted or not self.participants:
            raise ValueError(f"counts of answers must have shape {wanted} with at least one participant")
        if not (counts >= 0.0).all() or (counts != np.floor(counts)).any():
            raise ValueError("counts of answers must be whole numbers of 0 or more")
        if (counts.sum(axis=(1, 2)) == 0.0).any():
            raise ValueError("every participant needs at least one answer")

    @property
    def pooled(self) -> Array:
        """Answers of all participants together (icons, icons)."""
        found: Array = self.counts.sum(axis=0)
        return found

    @property
    def presented(self) -> Array:
        """How often each participant was presented each icon (participants, icons)."""
        found: Array = self.counts.sum(axis=2)
        return found

    @property
    def total(self) -> int:
        """Number of trials of all participants."""
        return int(self.counts.sum())

    @property
    def never_presented(self) -> tuple[str, ...]:
        """Icons of the set that nobody was presented."""
        shown = self.presented.sum(axis=0)
        return tuple(name for name, times in zip(self.icons, shown.tolist(), strict=True) if not times)

    @property
    def single_trial(self) -> tuple[str, ...]:
        """Participants with one trial, of whom no spread is known."""
        each = self.counts.sum(axis=(1, 2)).tolist()
        return tuple(name for name, trials in zip(self.participants, each, strict=True) if trials == 1)

    def __repr__(self) -> str:
        people = "1 participant" if len(self.participants) == 1 else f"{len(self.participants)} participants"
        return f"Trials({people}, {self.total} trial{'s' * (self.total != 1)}, {len(self.icons)} icons)"


Z_95 = 1.959964
FEWEST = 2
"""Participants that a spread between them needs."""


@dataclass(frozen=True, slots=True)
class AnswerScore:
    """Per cent correct and bits of some answers.

    `proportion_correct` with a 95 % interval; `bits_plugin` as published information is computed, `bits` without its
    bias `bits_bias`, with a 95 % interval, of at most `bits_most`; `time_s` is the median time of correct answers (NaN:
    not recorded).
    """

    who: str
    trials: int
    proportion_correct: float
    proportion_interval: tuple[float, float]
    bits_plugin: float
    bits_bias: float
    bits_interval: tuple[float, float]
    time_s: float
    bits_most: float

    @property
    def bits(self) -> float:
        """Plug-in bits less their bias, within what a set of this size can carry."""
        return min(max(self.bits_plugin - self.bits_bias, 0.0), self.bits_most)

    def to_dict(self) -> dict[str, object]:
        """Plain data for JSON."""
        return {
            "who": self.who,
            "trials": self.trials,
            "proportion_correct": self.proportion_correct,
            "proportion_correct_interval": list(self.proportion_interval),
            "information_bits_plugin": self.bits_plugin,
            "information_bits_bias": self.bits_bias,
            "information_bits": self.bits,
            "information_bits_interval": list(self.bits_interval),
            "median_time_s": None if math.isnan(self.time_s) else self.time_s,
        }


def plugin_information(counts: Array) -> tuple[float, float]:
    """Plug-in bits of counts (icons, icons), and the bias that Miller and Madow's formula expects of them.

    The formula is negative where hardly an answer is wrong; there the plug-in estimate is not corrected.

    >>> bits, bias = plugin_information(np.array([[5.0, 0.0], [0.0, 5.0]]))
    >>> round(bits, 3), bias
    (1.0, 0.0)
    """
    total = counts.sum()
    joint = counts / total
    rows, columns = joint.sum(axis=1), joint.sum(axis=0)
    expected = rows[:, None] * columns[None, :]
    used = joint > 0.0
    bits = float((joint[used] * np.log2(joint[used] / expected[used])).sum())
    bias = (used.sum() - (rows > 0.0).sum() - (columns > 0.0).sum() + 1) / (2.0 * total * math.log(2.0))
    return bits, max(float(bias), 0.0)


def score_person(trials: Trials, person: int) -> AnswerScore:
    """Scores of one participant; the interval of the proportion is Wilson's."""
    counts = trials.counts[person]
    total, correct = float(counts.sum()), float(np.trace(counts))
    time = trials.time_s[person] if trials.time_s else math.nan
    return _score(trials.participants[person], counts, wilson(correct, total), _over_trials(counts), time)


def score_pooled(trials: Trials) -> AnswerScore:
    """Scores of all participants together; intervals follow their spread and the number of trials."""
    counts = trials.pooled
    known = [time for time in trials.time_s if not math.isnan(time)]
    time = float(np.median(known)) if known else math.nan
    if len(trials.participants) < FEWEST:
        ends = wilson(float(np.trace(counts)), float(counts.sum()))
        return _score("all", counts, ends, _over_trials(counts), time)
    without = counts[None] - trials.counts
    correct = np.trace(without, axis1=1, axis2=2) / without.sum(axis=(1, 2))
    share = float(np.trace(counts) / counts.sum())
    half = _student(len(without) - 1) * _jackknife(correct)
    low, high = wilson(float(np.trace(counts)), float(counts.sum()))
    ends = max(min(share - half, low), 0.0), min(max(share + half, high), 1.0)
    bits = np.array([_corrected(each) for each in without])
    spread = max(_student(len(without) - 1) * _jackknife(bits), _over_trials(counts))
    return _score("all", counts, ends, spread, time)


def wilson(successes: float, trials: float) -> tuple[float, float]:
    """Wilson's 95 % interval of a proportion."""
    share, square = successes / trials, Z_95**2 / trials
    middle = (share + 0.5 * square) / (1.0 + square)
    half = Z_95 * math.sqrt(share * (1.0 - share) / trials + 0.25 * square / trials) / (1.0 + square)
    return max(middle - half, 0.0), min(middle + half, 1.0)


def _score(who: str, counts: Array, ends: tuple[float, float], half: float, time_s: float) -> AnswerScore:
    bits, bias = plugin_information(counts)
    most = math.log2(len(counts))
    middle = min(max(bits - bias, 0.0), most)
    span = (max(middle - half, 0.0), min(middle + half, most))
    total = int(counts.sum())
    return AnswerScore(who, total, float(np.trace(counts) / total), ends, bits, bias, span, time_s, most)


def _corrected(counts: Array) -> float:
    bits, bias = plugin_information(counts)
    return bits - bias


def _jackknife(each: Array) -> float:
    return math.sqrt((len(each) - 1) / len(each) * float(np.square(each - each.mean()).sum()))


def _over_trials(counts: Array) -> float:
    """Half the 95 % interval of bits, by the jackknife over trials; of one trial all is possible.

    Answers that are all right show no spread: they are taken to be no surer than with one of them wrong.
    """
    total = int(counts.sum())
    if total < FEWEST:
        return math.log2(len(counts))
    if np.trace(counts) == total:
        icon = int(counts.sum(axis=1).argmax())
        slip = counts.copy()
        slip[icon, icon] -= 1.0
        slip[icon, icon - 1] += 1.0
        return _corrected(counts) - _corrected(slip) + _over_trials(slip)
    cells = np.argwhere(counts > 0.0)
    without, times = [], []
    for a, b in cells.tolist():
        left = counts.copy()
        left[a, b] -= 1.0
        without.append(_corrected(left))
        times.append(counts[a, b])
    values, weights = np.array(without), np.array(times)
    mean = float(values @ weights) / total
    return Z_95 * math.sqrt((total - 1) / total * float(np.square(values - mean) @ weights))


def _student(freedom: int) -> float:
    from scipy.stats import t

    return float(t.ppf(0.975, freedom))
