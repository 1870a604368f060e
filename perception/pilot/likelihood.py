r"""The likelihood of answers in a laboratory.

A participant j of laboratory ℓ is one of its people, nobody knows which. With S virtual people whose confusions are
C, and N_j[a, b] answers b to icon a,

    L_j(ℓ) = (1/S) Σ_s Π_ab C_ℓs[a, b]^N_j[a, b],      w_ℓ ∝ Π_j L_j(ℓ),      ESS = (Σ w)² / Σ w².

Each participant is integrated over people on their own, so that a few odd answers of one person do not move the
constants of the laboratory as the same answers of many would.

With many participants or trials, the mixture over a few virtual people is a matter of who they happen to be. The sum of
all answers hardly is: over participants it is nearly normal (a synthetic likelihood, Wood 2010),

    y ~ N(μ(ℓ), V),   V = J·Cov_people(n·C) + Σ_a n_a·E[diag(C_a) − C_a C_aᵀ]

with n presentations of each icon to each of J participants. V has the share of pairs, whose scores are integrated. μ is
a polynomial of the laboratory's coordinates for each form of memory, fitted to simulated laboratories in the few
directions in which they differ most against V; what the fit leaves is added to V.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from thermicon.base.numbers.arrays import Array

from ..identification.confusion import normalised
from .playing import Confusions
from .states import Laboratories

AT_ONCE = 4_000_000
"""Logarithms of probabilities that are held at once: 32 MB."""


def log_likelihoods(probability: Array, counts: Array) -> Array:
    """Ln L_j (laboratories, participants) of (laboratories, people, icons, icons) and (participants, icons, icons)."""
    laboratories, people = probability.shape[:2]
    used = np.flatnonzero(counts.sum(axis=0).ravel())
    answers = counts.reshape(len(counts), -1)[:, used].T
    each = np.empty((laboratories, people, len(counts)))
    rows = max(1, AT_ONCE // max(people * used.size, 1))
    for start in range(0, laboratories, rows):
        part = probability[start : start + rows].reshape(-1, probability.shape[-1] ** 2)[:, used]
        each[start : start + rows] = (np.log(part) @ answers).reshape(-1, people, len(counts))
    largest = each.max(axis=1)
    return np.asarray(largest + np.log(np.exp(each - largest[:, None]).mean(axis=1)))


def normalised_weights(log_weights: Array) -> Array:
    """Weights that add up to 1, from their logarithms; a FloatingPointError where these are not numbers."""
    largest = float(log_weights.max())
    if not np.isfinite(largest):
        raise FloatingPointError(f"the largest log weight is {largest}")
    own = np.exp(log_weights - largest)
    return np.asarray(own / own.sum())


def effective(weights: Array) -> float:
    """Effective sample size of weights that add up to 1."""
    return float(1.0 / np.square(weights).sum())


DIRECTIONS, LEAST_RATIO = 10, 0.05
"""At most so many directions, each with a variance between laboratories of at least this share of V."""
STRONGEST = 6
"""Coordinates whose squares and products are fitted: more of them blur a fit to some hundred laboratories."""
PENALTIES = tuple(10.0 ** (k / 2) for k in range(9))
RIDGE = 1e-9
"""Least variance of a cell of the pooled answers, as a share of the mean over cells: far above rounding, and far below
the variance of the rarest answer."""
STEPS, RISING, STEP = 1500, 0.5, 0.3
"""Steps of a walk, the share of them in which the power of the likelihood rises to 1, and the first step size."""
ACCEPTED = 0.3
LEAST_SPREAD = 1e-3
"""Spread of pairs (ln) that is as good as none."""
WEIGHED = 25
"""Steps of a rising power after which chains are resampled, so that each form of memory has as many as it is likely."""


@dataclass(frozen=True, slots=True)
class Polynomial:
    """Pooled answers of laboratories with one form of memory, in directions in which their errors are independent.

    `coefficients` (features, directions) predict `observed` (directions,), with a variance of 1 and that of pairs of a
    laboratory, which is `by_spread` (directions,) times the square of their spread; `log_spread` (features,) predicts
    that. `scale` is the ln of the size of the directions.
    """

    observed: Array
    coefficients: Array
    by_spread: Array
    log_spread: Array
    pairs: tuple[tuple[int, int], ...]
    scale: float

    def __call__(self, place: Array) -> Array:
        """Ln likelihood (n,) at coordinates (n, d), up to a constant that all forms share."""
        features = features_of(place, self.pairs)
        variance = 1.0 + np.exp(2.0 * features @ self.log_spread)[:, None] * self.by_spread
        off = self.observed - features @ self.coefficients
        return np.asarray(self.scale - 0.5 * (np.square(off) / variance + np.log(variance)).sum(axis=1))


@dataclass(frozen=True, slots=True)
class PooledLikelihood:
    """Ln likelihood of pooled answers by a polynomial for each form of memory."""

    by_form: Mapping[int, Polynomial]

    @classmethod
    def fit(
        cls, some: Laboratories, played: Confusions, counts: Array, scores: Array, weight: Array | None = None
    ) -> PooledLikelihood:
        """Fit to laboratories with a `weight` (n,), for answers (participants, icons, icons).

        `scores` (n, icons, icons) are pairs by chance. A LinAlgError where V cannot be factorised.
        """
        own = np.ones(len(some)) if weight is None else weight / weight.mean()
        shown = counts.sum(axis=2)
        # All answers to an icon together have no variance: rows that do not add up to 1 would give them some below 0.
        people = normalised(np.asarray(played.probability, dtype=np.float64))
        noise = _noise(people, shown, own)
        least = RIDGE * float(np.trace(noise)) / len(noise)
        root: Any = np.linalg.cholesky(noise + least * np.eye(len(noise)))
        # Pairs of both signs, so that the mean over scores is nearly free of chance.
        more, less = (_expected(played.with_scores(sign * scores).pooled, shown) for sign in (1.0, -1.0))
        middle = 0.5 * (more + less).mean(axis=0)
        rows = (counts.sum(axis=0).ravel()[None] - middle, 0.5 * (more + less) - middle, 0.5 * (more - less))
        seen, whitened, by_pairs = np.split(np.linalg.solve(root, np.vstack(rows).T).T, [1, 1 + len(some)])
        groups = {form: np.flatnonzero(some.form == form) for form in np.unique(some.form).tolist()}
        fits = {form: smooth_features(some.place[which], whitened[which], own[which]) for form, which in groups.items()}
        smooth = np.empty(whitened.shape)
        for form, which in groups.items():
            smooth[which] = fits[form][0] @ ridge(fits[form][0], whitened[which], own[which])[0]
        # Directions of the smooth part: differences between simulated people are not a property of a laboratory.
        sizes, turned = np.linalg.eigh(np.cov(smooth.T, aweights=own))
        used = np.flatnonzero(sizes > LEAST_RATIO)[::-1][:DIRECTIONS]
        turned = turned[:, used] if used.size else turned[:, -1:]
        spread = np.maximum(played.spread, LEAST_SPREAD)
        by_form = {}
        for form, which in groups.items():
            features, pairs = fits[form]
            coefficients, missed = ridge(features, whitened[which] @ turned, own[which])
            log_spread = ridge(features, np.log(spread[which])[:, None], own[which])[0][:, 0]
            half = by_pairs[which] @ turned / np.sqrt((1.0 + missed) * (own[which] @ np.square(spread[which])))
            by_spread, axes = np.linalg.eigh((half * own[which, None]).T @ half)
            axes = axes / np.sqrt(1.0 + missed)[:, None]
            scale = -0.5 * float(np.log1p(missed).sum())
            observed = (seen @ turned @ axes)[0]
            by_form[form] = Polynomial(observed, coefficients @ axes, by_spread.clip(0.0), log_spread, pairs, scale)
        return cls(by_form)

    def __call__(self, place: Array, form: NDArray[np.int64]) -> Array:
        """Ln likelihood (n,) at coordinates (n, d) with forms of memory (n,), up to a constant."""
        found = np.empty(len(place))
        for own, polynomial in self.by_form.items():
            which = form == own
            found[which] = polynomial(place[which])
        return found


Target: TypeAlias = "Callable[[Array, NDArray[np.int64]], Array]"


def walk(
    start: Array, form: NDArray[np.int64], target: Target, rng: np.random.Generator
) -> tuple[Array, NDArray[np.int64]]:
    """Sample coordinates (n, d) and forms (n,) from the prior times the likelihood, by n chains from the prior.

    Preconditioned Crank–Nicolson; the power of the likelihood rises to 1 in the first half, in which the step is set
    and chains are resampled by what the rise adds to them (a sequential sampler, Del Moral et al. 2006): a form of
    memory is not walked to, but has its share of the chains.
    """
    place, form = start.copy(), form.copy()
    value, step, last, gained = target(place, form), STEP, 0.0, np.zeros(len(start))
    if not np.isfinite(value).all():
        raise FloatingPointError("the log likelihood is not finite where the walk starts")
    for k in range(STEPS):
        power = min(1.0, (k + 1) / (RISING * STEPS))
        gained += (power - last) * value
        if last < 1.0 and (k + 1) % WEIGHED == 0:
            chosen = systematic(normalised_weights(gained), len(place), rng)
            place, form, value = place[chosen], form[chosen], value[chosen]
            gained[:] = 0.0
        last = power
        proposed = np.sqrt(1.0 - step**2) * place + step * rng.standard_normal(place.shape)
        other = target(proposed, form)
        accepted: NDArray[np.bool_] = np.log(rng.random(len(place))) < power * (other - value)
        place[accepted], value[accepted] = proposed[accepted], other[accepted]
        if power < 1.0:
            step = float(np.clip(step * np.exp(0.2 * (accepted.mean() - ACCEPTED)), 0.01, 0.95))
    return place, form


def systematic(weights: Array, n: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Numbers of n resampled items, by one random start: each as often as its weight says, up to rounding."""
    ends = np.cumsum(weights)
    found: NDArray[np.int64] = np.searchsorted(ends / ends[-1], (np.arange(n) + rng.random()) / n, side="right")
    return np.minimum(found, len(weights) - 1)


def _expected(pooled: Array, shown: Array) -> Array:
    """Expected pooled answers (laboratories, cells)."""
    return np.asarray((pooled * shown.sum(axis=0)[:, None]).reshape(len(pooled), -1))


def _noise(people: Array, shown: Array, weight: Array) -> Array:
    """V (cells, cells) of people and their answers, the mean over laboratories."""
    total, icons = shown.sum(axis=0), shown.shape[1]
    cells = np.repeat(total / total.sum(), icons)
    each = people.reshape(*people.shape[:2], -1)
    within = (each - each.mean(axis=1, keepdims=True)) * cells
    within *= np.sqrt(weight)[:, None, None]
    flat = within.reshape(-1, icons**2)
    spread = flat.T @ flat / (len(flat) * (1.0 - 1.0 / each.shape[1]))
    # Participants with more trials weigh more in the sum.
    noise = spread * float(np.square(shown.sum(axis=1)).sum())
    for a in range(icons):
        rows = people[:, :, a].reshape(-1, icons)
        share = np.repeat(weight, each.shape[1]) / len(rows)
        own = slice(a * icons, (a + 1) * icons)
        noise[own, own] += total[a] * (np.diag(share @ rows) - (rows * share[:, None]).T @ rows)
    return np.asarray(noise)


def smooth_features(place: Array, values: Array, weight: Array) -> tuple[Array, tuple[tuple[int, int], ...]]:
    """Features that explain values (n, cells), and the products among them."""
    plain = features_of(place, ())
    slopes, _ = ridge(plain, values, weight)
    strength = np.square(slopes[1:]).sum(axis=1)
    strongest = sorted(np.argsort(-strength)[:STRONGEST].tolist())
    pairs = tuple(combinations_with_replacement(strongest, 2))
    return features_of(place, pairs), pairs


def features_of(place: Array, pairs: tuple[tuple[int, int], ...]) -> Array:
    """Features (n, features) of coordinates: a constant, linear terms, and squares and products of some pairs."""
    first, second = [a for a, _ in pairs], [b for _, b in pairs]
    products = place[:, first] * place[:, second] - np.equal(first, second)
    return np.hstack([np.ones((len(place), 1)), place, products])


def ridge(features: Array, values: Array, weight: Array) -> tuple[Array, Array]:
    """Coefficients (features, targets) with each target's best penalty, and its leave-one-out mean square error."""
    root = np.sqrt(weight)[:, None]
    features, targets = features * root, values * root
    scale = np.ones(features.shape[1])
    scale[0] = 1e3  # the constant is hardly shrunk
    left, sizes, right = np.linalg.svd(features * scale, full_matrices=False)
    along = left.T @ targets
    best, found = np.full(targets.shape[1], np.inf), np.zeros((features.shape[1], targets.shape[1]))
    for penalty in PENALTIES:
        shrink = sizes**2 / (sizes**2 + penalty)
        free = np.maximum(1.0 - np.square(left) @ shrink, 0.05)
        error = np.square((targets - left @ (shrink[:, None] * along)) / free[:, None]).mean(axis=0)
        better = error < best
        own = scale[:, None] * (right.T @ ((sizes / (sizes**2 + penalty))[:, None] * along))
        best[better], found[:, better] = error[better], own[:, better]
    return found, best
