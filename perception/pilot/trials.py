"""Answers of an identification experiment with their scores.

A trial without an answer is a play that was not felt: a miss of *felt and named*, and no part of *named* and of bits.
Bits are the plug-in estimate, biased upwards by about (cells − rows − columns + 1)/(2·trials·ln 2) with counts of what
was used (Miller 1955), and less that bias. Answers that are possible but did not occur are not counted. A few
participants may happen to be alike, or right throughout: no interval is narrower than Wilson's.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from thermicon.base.numbers.arrays import Array, own_arrays


@dataclass(frozen=True, slots=True, eq=False)
class Trials:
    """Answers of some participants to the icons of a set.

    Attributes
    ----------
    icons, participants
        Names of all icons that could be answered, in the order of the set, and of the participants.
    counts
        How often each answer was given (participants, icons presented, icons answered).
    source, digest
        Name of the file, and the first 16 digits of its SHA-256.
    unanswered
        Trials without an answer, not felt (participants, icons presented).
    passed
        Rows of the file with neither an icon nor an answer.
    grouped
        Whether the counts of a group are given as those of one participant.
    missing
        Trials marked as missing, which do not count.

    Examples
    --------
    >>> import numpy as np
    >>> Trials(("a", "b"), ("p1",), np.array([[[9.0, 1.0], [2.0, 8.0]]]))
    Trials(1 participant, 20 trials, 2 icons)
    """

    icons: tuple[str, ...]
    participants: tuple[str, ...]
    counts: Array
    source: str = ""
    digest: str = ""
    unanswered: Array = field(default_factory=lambda: np.zeros((1, 1)))
    passed: int = 0
    grouped: bool = False
    missing: int = 0

    def __post_init__(self) -> None:
        object.__setattr__(self, "unanswered", np.broadcast_to(self.unanswered, np.shape(self.counts)[:2]))
        own_arrays(self, "counts", "unanswered")
        counts = np.concatenate([self.counts, self.unanswered[..., None]], axis=2)
        wanted = (len(self.participants), len(self.icons), len(self.icons))
        if self.counts.shape != wanted or not self.participants:
            raise ValueError(f"counts of answers must have shape {wanted} with at least one participant")
        if not (counts >= 0.0).all() or (counts != np.floor(counts)).any():
            raise ValueError("counts of answers must be whole numbers of 0 or more")
        if (counts.sum(axis=(1, 2)) == 0.0).any() or not self.counts.any():
            raise ValueError("every participant needs at least one trial, and somebody an answer")

    @property
    def pooled(self) -> Array:
        """Answers of all participants together (icons, icons)."""
        return np.asarray(self.counts.sum(axis=0))

    @property
    def presented(self) -> Array:
        """Number of presentations to each participant of each icon (participants, icons)."""
        return np.asarray(self.counts.sum(axis=2) + self.unanswered)

    @property
    def forced(self) -> bool:
        """Whether each trial has an answer, as where nobody could say that nothing was felt: named alone is known."""
        return not self.unanswered.any()

    @property
    def total(self) -> int:
        """Number of trials of all participants."""
        return int(self.presented.sum())

    @property
    def never_presented(self) -> tuple[str, ...]:
        """Icons of the set that nobody was presented."""
        shown = self.presented.sum(axis=0)
        return tuple(name for name, times in zip(self.icons, shown.tolist(), strict=True) if not times)

    def __repr__(self) -> str:
        people = "1 participant" if len(self.participants) == 1 else f"{len(self.participants)} participants"
        return f"Trials({people}, {self.total} trial{'s' * (self.total != 1)}, {len(self.icons)} icons)"


Z_95 = 1.959964
FEWEST = 2
"""Participants that a spread between them needs."""


@dataclass(frozen=True, slots=True)
class AnswerScore:
    """Per cent correct, with a 95 % interval, and bits of some answers; trials without one are not correct.

    `named` is of the trials with an answer (None: there is none), as bits are; `proportion_correct` is felt and named.
    `information_bits_plugin` less its `information_bits_bias` are `information_bits`, within what a set can carry.
    """

    who: str
    trials: int
    proportion_correct: float
    proportion_correct_interval: tuple[float, float]
    information_bits_plugin: float
    information_bits_bias: float
    information_bits: float
    unanswered: int = 0
    named: float | None = None
    named_interval: tuple[float, float] | None = None


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


def score(who: str, counts: Array, unanswered: float | Array = 0.0) -> AnswerScore:
    """Scores of the answers (participants, icons, icons) of one participant or of several together.

    `unanswered` trials are not correct, and have no bits. The interval is Wilson's, or the jackknife's where wider.
    """
    pooled, hits = counts.sum(axis=0), np.trace(counts, axis1=1, axis2=2)
    answered = counts.sum(axis=(1, 2))
    trials = answered + unanswered
    total = float(trials.sum())
    (correct, ends), some = _share(hits, trials), answered > 0.0
    named = _share(hits[some], answered[some]) if some.any() else (None, None)
    bits, bias = plugin_information(pooled) if pooled.any() else (0.0, 0.0)
    corrected = min(max(bits - bias, 0.0), math.log2(len(pooled)))
    silent = int(total - pooled.sum())
    return AnswerScore(who, int(total), correct, ends, bits, bias, corrected, silent, *named)


def _share(hits: Array, trials: Array) -> tuple[float, tuple[float, float]]:
    """Share of the trials (participants,) that are hits, and its interval."""
    right, total = float(hits.sum()), float(trials.sum())
    low, high = wilson(right, total)
    if len(hits) >= FEWEST:
        from scipy.stats import t

        each = (right - hits) / (total - trials)
        spread = math.sqrt((len(each) - 1) / len(each) * float(np.square(each - each.mean()).sum()))
        half = float(t.ppf(0.975, len(each) - 1)) * spread
        low, high = max(min(right / total - half, low), 0.0), min(max(right / total + half, high), 1.0)
    return right / total, (low, high)


def wilson(successes: float, trials: float) -> tuple[float, float]:
    """Wilson's 95 % interval of a proportion."""
    share, square = successes / trials, Z_95**2 / trials
    middle = (share + 0.5 * square) / (1.0 + square)
    half = Z_95 * math.sqrt(share * (1.0 - share) / trials + 0.25 * square / trials) / (1.0 + square)
    return max(middle - half, 0.0), min(middle + half, 1.0)
