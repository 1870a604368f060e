"""Identification in the subsets of a pool and the search for the best subset.

The same persons, points and noise serve all subsets. A presented icon is felt as its point plus noise and named after
the nearest point of the subset, as in `confuse`, but the points stay those of the whole pool.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermicon.base.numbers.arrays import Array
from thermicon.base.numbers.compiled import kernel
from thermicon.base.numbers.cores import quiet_blas

from ..identification.confusion import embed
from .goal import GoalPart
from .max_min_subset import SubsetChoice, Totals, max_min_subset
from .request import Objective

PEOPLE = 24
HALF = 64
"""Noise of every person, used with both signs: 24 people give 3,072 presentations of each icon."""
MOST_SUBSETS = 200_000
"""Pools with at most this many choices, such as all of up to 20 icons, are enumerated completely."""
ALIKE = -1.0
"""Stands for d′ between two icons that are never chosen together, such as members of one family."""
LEAST_GAIN = 1e-9
"""A swap that gains no more is rounding."""
RESTARTS = 6
"""Random choices that larger pools are also climbed from."""
SHORT = 8
"""Best choices that are kept, to be judged by all people where a goal is set."""
TIE = 1e-3
"""Of an objective beside margins, so that it decides between equal ones, and of d′ beside the objective."""


def _tally(counts: Any, size: int, draws: int, lapse: float) -> tuple[float, float]:
    """Proportion correct and bits of one person's counts (size, size)."""
    correct = 0.0
    bits = 0.0
    for b in range(size):
        column = 0.0
        for a in range(size):
            column += counts[a, b]
        answered = ((1.0 - lapse) * column / draws + lapse) / size
        correct += (1.0 - lapse) * counts[b, b] / draws + lapse / size
        for a in range(size):
            p = (1.0 - lapse) * counts[a, b] / draws + lapse / size
            if p > 0.0:
                bits += p / size * math.log2(p / answered)
    return correct / size, bits


def _replaced(half: Any, push: Any, lapse: Any, chosen: Any, place: int, others: Any) -> Any:
    """Proportion correct and bits (2, others, people) of a subset with one icon replaced by each of `others`.

    Who is nearest among those that stay is found once, so that each of `others` costs only its own distances.
    """
    people, draws, size = push.shape[0], push.shape[2], chosen.size
    each = np.empty((2, others.size, people))
    near = np.empty((size, draws))
    who = np.empty((size, draws), dtype=np.int64)
    for p in range(people):
        for a in range(size):
            for s in range(draws):
                best = a
                least = -push[p, chosen[a], s]
                for b in range(size):
                    value = half[p, chosen[a], chosen[b]] - push[p, chosen[b], s]
                    if b != place and value < least:
                        least = value
                        best = b
                near[a, s] = least
                who[a, s] = best
        for k in range(others.size):
            other = others[k]
            counts = np.zeros((size, size))
            for a in range(size):
                if a == place:
                    continue
                edge = half[p, chosen[a], other]
                for s in range(draws):
                    counts[a, place if edge - push[p, other, s] < near[a, s] else who[a, s]] += 1.0
            for s in range(draws):
                best = place
                least = -push[p, other, s]
                for b in range(size):
                    value = half[p, other, chosen[b]] - push[p, chosen[b], s]
                    if b != place and value < least:
                        least = value
                        best = b
                counts[place, best] += 1.0
            each[0, k, p], each[1, k, p] = tally(counts, size, draws, lapse[p])
    return each


def _right(half: Any, push: Any, lapse: Any, reports: Any, chosen: Any, place: int, others: Any) -> Any:
    """The proportions correct (others, people) of `replaced` alone, each times how often a person reports the icon, in
    loops that the processor does several steps of at once.
    """
    people, draws, size = push.shape[0], push.shape[2], chosen.size
    correct = np.empty((others.size, people))
    near, nearest, counts = np.empty((size, draws)), np.empty(draws), np.zeros(size, dtype=np.int64)
    kept = counts.copy()
    for p in range(people):
        for a in range(size):
            if a == place:
                continue
            _approach(half[p, chosen[a]], push[p], chosen, a, place, nearest)
            kept[a] = 0
            for s in range(draws):
                own = -push[p, chosen[a], s]
                # Where it is not named right, nothing that comes nearer can lose it a trial.
                near[a, s] = own if own <= nearest[s] else -math.inf
                kept[a] += own <= nearest[s]
        for k in range(others.size):
            other = push[p, others[k]]
            for a in range(size):
                edge, lost = half[p, chosen[a], others[k]], 0
                for s in range(draws if a != place else 0):
                    lost += edge - other[s] < near[a, s]
                counts[a] = kept[a] - lost
            _approach(half[p, others[k]], push[p], chosen, place, place, nearest)
            counts[place] = 0
            for s in range(draws):
                counts[place] += -other[s] <= nearest[s]
            total = 0.0
            for a in range(size):
                icon = others[k] if a == place else chosen[a]
                total += reports[p, icon] * ((1.0 - lapse[p]) * counts[a] / draws + lapse[p] / size)
            correct[k, p] = total / size
    return correct


def _to_nearest(half: Any, push: Any, chosen: Any, a: int, place: int, nearest: Any) -> None:
    """How far the nearest of the chosen is in each draw, without those at two places."""
    nearest[:] = math.inf
    for b in range(chosen.size):
        if b not in (a, place):
            edge, one = half[chosen[b]], push[chosen[b]]
            for s in range(nearest.size):
                value = edge - one[s]
                nearest[s] = value if value < nearest[s] else nearest[s]


_compile: Any = kernel(nogil=True, error_model="numpy")
_approach: Any = _compile(_to_nearest)
tally: Callable[..., tuple[float, float]] = _compile(_tally)
replaced: Callable[[Array, Array, Array, Any, int, Any], Array] = _compile(_replaced)
right: Callable[[Array, Array, Array, Array, Any, int, Any], Array] = _compile(_right)


@dataclass(frozen=True, slots=True)
class SubsetIdentification:
    """A pool as some people feel it: `half` (people, n, n) half squared distances, `push` (people, n, draws) noise
    projected on the points, `lapse` (people,), `reports` (people, n) how often icons are reported, `durations_s` (n,).
    A subset scores the mean of its people; with `parts` of a goal, the least margin of their means, d′ from `middle`.
    """

    half: Array
    push: Array
    lapse: Array
    reports: Array
    durations_s: Array
    middle: Array = field(default_factory=lambda: np.empty((0, 0)))
    parts: tuple[GoalPart, ...] = ()

    @classmethod
    def of(
        cls, d_prime: Array, lapse: Array, reports: Array, durations_s: Array, seed: int, most: int = PEOPLE
    ) -> SubsetIdentification:
        """The first `most` people of d′ (people, n, n); a person's noise does not depend on how many they are."""
        with quiet_blas():
            points = embed(d_prime[:most])
        people, _, axes = points.shape
        noise = np.random.default_rng(np.random.SeedSequence([seed, 5])).standard_normal((people, HALF, axes))
        push = np.einsum("psa,pna->pns", noise, points)
        own = (points**2).sum(axis=-1)
        half = 0.5 * (own[:, :, None] + own[:, None, :]) - np.einsum("pia,pja->pij", points, points)
        return cls(half, np.concatenate([push, -push], axis=2), np.asarray(lapse[:most]), reports[:most], durations_s)

    def __len__(self) -> int:
        return int(self.half.shape[1])

    def score(self, chosen: Sequence[int], objective: Objective) -> float:
        """The objective of the chosen, mean over people, or their least margin."""
        # The last is "replaced" by itself; of equally near ones it wins no more often than where it stands.
        return float(self.replaced(chosen, len(chosen) - 1, chosen[-1:], objective)[0])

    def replaced(self, chosen: Sequence[int], place: int, others: Sequence[int], objective: Objective) -> Array:
        """Scores (others,) of the chosen with the one at a place replaced by each of `others`."""
        own = self.values(chosen, place, others, objective)
        if not self.parts:
            return own
        nearest = self.values(chosen, place, others, "worst")
        return np.asarray(self._margins(chosen, place, others) + TIE * own + TIE**2 * nearest)

    def margin(self, chosen: Sequence[int]) -> float:
        """The least margin of the chosen over the parts of the goal."""
        return float(self._margins(chosen, len(chosen) - 1, chosen[-1:])[0])

    def _margins(self, chosen: Sequence[int], place: int, others: Sequence[int]) -> Array:
        apart = [part.margin(self.values(chosen, place, others, _meant(part.quantity))) for part in self.parts]
        return np.asarray(np.min(apart, axis=0))

    def values(self, chosen: Sequence[int], place: int, others: Sequence[int], objective: str) -> Array:
        """The same of an objective alone, or of `detected`, how often the icon detected least is reported."""
        if objective in ("worst", "detected"):
            rest = [k for spot, k in enumerate(chosen) if spot != place]
            if objective == "detected":
                each = np.minimum(self.reports[:, rest].min(axis=1)[:, None], self.reports[:, list(others)])
                return np.asarray(each.mean(axis=0))
            inside = self.middle[np.ix_(rest, rest)][np.triu_indices(len(rest), 1)]
            return np.asarray(np.minimum(self.middle[np.ix_(rest, others)].min(axis=0), inside.min(initial=math.inf)))
        index, tried = np.asarray(chosen, dtype=np.int64), np.asarray(others, dtype=np.int64)
        of, trial = (self.half, self.push, self.lapse), (index, place, tried)
        if objective in ("felt-and-named", "named"):
            reports = self.reports if objective == "felt-and-named" else np.ones_like(self.reports)
            each = right(*of, reports, *trial)
        else:
            each = replaced(*of, *trial)[1]
        # A running sum does not depend on how many are scored together, so that equal choices have equal scores.
        mean = np.asarray(np.add.accumulate(each, axis=-1)[..., -1] / each.shape[-1])
        if objective != "bits-per-s":
            return mean
        trials = np.repeat(index[None], tried.size, axis=0)
        trials[:, place] = tried
        return np.asarray(mean / self.durations_s[trials].mean(axis=1))

    def swapped(self, chosen: Sequence[int], objective: Objective, allowed: NDArray[np.bool_]) -> Array:
        """Scores (k, n) with one chosen icon replaced by another; −inf where `allowed` (k, n) says no."""
        found = np.full((len(chosen), len(self)), -math.inf)
        for place in range(len(chosen)):
            others = np.flatnonzero(allowed[place])
            if others.size:
                found[place, others] = self.replaced(chosen, place, others.tolist(), objective)
        return found

    def enumerated(self, count: int, objective: Objective, must: Sequence[int], limits: Totals) -> SubsetChoice | None:
        """The best of all subsets that hold `must` and keep the limits.

        All that share all but their last icon are scored together.
        """
        rest = [k for k in range(len(self)) if k not in must]
        missing = count - len(must)
        heads = [tuple(must[:-1])] if not missing else [(*must, *some) for some in combinations(rest, missing - 1)]
        best, seen = list[tuple[float, tuple[int, ...]]](), 0
        keep = SHORT if self.parts else 1
        for head in heads:
            last = [k for k in rest if missing == 1 or k > head[-1]] if missing else must[-1:]
            last = [k for k in last if limits.kept([*head, k])]
            if not last:
                continue
            scores = self.replaced([*head, last[0]], count - 1, last, objective)
            seen += len(last)
            least = best[-1][0] if len(best) == keep else -math.inf
            if scores.max() > least:
                first = np.argsort(-scores, kind="stable")[:keep].tolist()
                best += [(float(scores[k]), tuple(sorted((*head, last[k])))) for k in first]
                best = sorted(best, key=lambda each: -each[0])[:keep]
        return _told(self, best, objective, None, seen) if best else None


def pick(
    middle: Array,
    namings: SubsetIdentification | None,
    count: int,
    objective: Objective,
    must: Sequence[int] = (),
    limits: Totals | None = None,
    seed: int = 0,
    restarts: int = RESTARTS,
) -> SubsetChoice | None:
    """The best `count` by one objective: of median d′ (n, n) for `worst`, else of the namings; None: no choice fits."""
    within = limits or Totals.none(len(middle))
    if namings is None or (objective == "worst" and not namings.parts):
        return max_min_subset(middle, count, must, within)
    if math.comb(len(middle) - len(must), count - len(must)) <= MOST_SUBSETS:
        return namings.enumerated(count, objective, must, within)
    return _climbed(middle, namings, count, objective, must, within, seed, restarts)


def _climbed(
    middle: Array,
    namings: SubsetIdentification,
    count: int,
    objective: Objective,
    must: Sequence[int],
    limits: Totals,
    seed: int,
    restarts: int,
) -> SubsetChoice | None:
    """The best of the widest choice and of random ones, each improved by single swaps until none helps."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 6]))
    others = [k for k in range(len(middle)) if k not in must]
    widest = max_min_subset(middle, count, must, limits)
    if widest is None:
        return None
    drawn = [
        (*must, *sorted(int(k) for k in rng.choice(others, count - len(must), replace=False))) for _ in range(restarts)
    ]
    best, seen = dict[tuple[int, ...], float](), 0
    for start in [widest.chosen, *(one for one in drawn if limits.kept(one))]:
        chosen, score, looked = climb(namings, start, objective, middle, must, limits, best)
        seen += looked
        best[tuple(sorted(chosen))] = score
    # Of equal ones the first; sums in another order differ by rounding.
    ranked = sorted(((round(score, 11), one) for one, score in best.items()), key=lambda each: -each[0])
    bound = widest.bound if objective == "worst" else ceiling(namings, count, objective)
    return _told(namings, ranked[: SHORT if namings.parts else 1], objective, bound, seen)


def _meant(quantity: str) -> str:
    """The objective that a quantity of a goal is."""
    return {"d_prime": "worst"}.get(quantity, quantity.replace("_", "-"))


def _told(
    namings: SubsetIdentification, ranked: Sequence[tuple[float, tuple[int, ...]]], objective: Objective,
    bound: float | None, seen: int,
) -> SubsetChoice:  # fmt: skip
    """The first of the ranked choices with its objective, and the others; without a bound all were looked at."""
    best, *others = (chosen for _, chosen in ranked)
    value = float(namings.values(best, len(best) - 1, best[-1:], objective)[0])
    return SubsetChoice(best, value, value if bound is None else max(bound, value), seen, tuple(others))


def ceiling(namings: SubsetIdentification, count: int, objective: Objective) -> float:
    """The score of `count` icons that are never confused: lapses are answered at random."""
    kept = 1.0 - namings.lapse
    if objective in ("felt-and-named", "named"):
        reports = namings.reports if objective == "felt-and-named" else np.ones_like(namings.reports)
        best = np.sort(reports, axis=1)[:, -count:].mean(axis=1)
        return float(np.mean(best * (kept + (1.0 - kept) / count)))
    shortest = np.sort(namings.durations_s)[:count].mean()
    return math.log2(count) if objective == "bits" else float(math.log2(count) / shortest)


def climb(
    namings: SubsetIdentification,
    start: Sequence[int],
    objective: Objective,
    middle: Array,
    must: Sequence[int],
    limits: Totals,
    near: dict[tuple[int, ...], float] | None = None,
) -> tuple[list[int], float, int]:
    """Single swaps that improve an objective until none does: the places, their score, and how many were tried.

    With parts of a goal, `near` takes the best swaps of the last round.
    """
    chosen, score, tried = list(start), namings.score(start, objective), 0
    while True:
        # Not one that must stay, none for one that is alike another of the chosen, and within limits.
        allowed = np.ones((len(chosen), len(middle)), dtype=bool)
        allowed[:, chosen] = False
        for row, thing in zip(allowed, chosen, strict=True):
            rest = [k for k in chosen if k != thing]
            row &= (middle[rest] > ALIKE).all(axis=0) & (thing not in must)
            for one in np.flatnonzero(row).tolist() if limits.most else []:
                row[one] = limits.kept([*rest, one])
        found = namings.swapped(chosen, objective, allowed)
        tried += int(allowed.sum())
        place, other = (int(k) for k in np.unravel_index(int(found.argmax()), found.shape))
        if not found[place, other] > score + LEAST_GAIN:
            for spot in np.argsort(-found, axis=None)[: SHORT if namings.parts and near is not None else 0].tolist():
                place, other = divmod(spot, found.shape[1])
                if near is not None and math.isfinite(found[place, other]):
                    swapped = sorted((*chosen[:place], *chosen[place + 1 :], other))
                    near.setdefault(tuple(swapped), float(found[place, other]))
            return chosen, score, tried
        score, chosen[place] = float(found[place, other]), other
