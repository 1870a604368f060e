"""Confusions from pairwise d′: how often each icon is called by each name.

Icons are points whose distances are the pairwise d′ (classical scaling, negative axes dropped).
A presented icon is felt as its point plus unit noise on every axis, and named after the nearest
point; in a share of trials (lapse) any name is given. For m
equally distant icons this is PC = ∫φ(x − d)Φ(x)^(m−1)dx with pairwise d′ = d√2.

Directly named, every trial is a sequence of felt episodes with noise, and gets the name that it costs least to give.
Noise belongs to what was felt, so that a presented icon can lose an episode in memory but never gains one; confusions
are then asymmetric without a constant for it.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.arrays import Array

from ..kernels.parallel import over_rows
from ..observer.observer import Observer
from ..sensation.detection import strata
from .episodes import Episodes, episode_distances, intensity_noise

SAMPLES = 10_240
"""Presentations of an icon to a person: no cell of that person's has a standard error of more than 0.00495."""


SMALL_NOISE = 16_384
"""Noise of a person that is kept for the next use has at most so many numbers: 128 persons take 8 MB."""
NEGLIGIBLE = 0.003
"""In d′: axes along which no point lies farther out are left out, since 50 of them change a d′ of 2 by under 0.001, and
points that are no farther apart count as one: single precision would decide between them, and not noise."""
IDENTICAL = 1e-9
"""In d′: icons that are no farther apart do not differ but by rounding."""
Single = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class Confusion:
    """Confusions of many people, and how accurate they are.

    Attributes
    ----------
    probability
        Probabilities (people, icons, icons) of each answer (last axis) to each presented icon; rows sum to 1.
    standard_error, person_standard_error
        Largest sampling error of a cell of the pooled matrix, at most, and of one person's; 0 where cells are exact.

    See Also
    --------
    confuse : Computes confusions.
    """

    probability: Array
    standard_error: float
    person_standard_error: float

    @property
    def pooled(self) -> Array:
        """Mean over people, shape (icons, icons)."""
        return normalised(self.probability.mean(axis=0))


@checked
def confuse(
    d_prime: ArrayLike, *, lapse: ArrayLike = 0.02, seed: int = 0, samples: int = SAMPLES, first: int = 0
) -> Confusion:
    """Compute confusion matrices from pairwise d′.

    A presented icon is felt as its point plus unit noise on every axis and named after the nearest point. Noise is
    drawn from `seed` and the person's number and nothing else: two sets of as many icons are compared on the same
    noise, whoever else takes part. One and two icons are exact.

    Parameters
    ----------
    d_prime
        Pairwise d′, of shape (people, icons, icons) or (icons, icons).
    lapse
        Share of trials with a random name, 0–1; one number or one for each person.
    seed
        Seed of the noise.
    samples
        Draws of noise for each person.
    first
        Number of the first person.

    Returns
    -------
    Confusion
        Matrices of every person, and how accurate they are.

    Raises
    ------
    ValueError
        For d′ of another shape, and for d′ that are not finite.

    Examples
    --------
    >>> import numpy as np
    >>> d = 2.78 * np.sqrt(2) * (1 - np.eye(6))
    >>> round(float(np.trace(confuse(d, lapse=0.0).pooled)) / 6, 2)
    0.91
    """
    distances = np.asarray(d_prime, dtype=np.float64)
    distances = distances[None] if distances.ndim == 2 else distances
    if distances.ndim != 3 or distances.shape[1] != distances.shape[2] or not distances.shape[2]:
        raise ValueError(f"d_prime must have shape (people, icons, icons), not {np.shape(d_prime)}")
    people, icons = distances.shape[:2]
    if not np.isfinite(distances).all():
        raise ValueError("d_prime must be finite: a pair without a distance cannot be named")
    if samples < 1:
        raise ValueError(f"at least one sample is needed, not {samples}")
    if icons == 1:
        named = np.ones((people, 1, 1))
    elif icons == 2:
        # Exact for two: each is named where noise stays below d′/2.
        right = np.array([0.5 * math.erfc(-0.5 * v / math.sqrt(2.0)) for v in distances[:, 0, 1].tolist()])
        named = np.stack([np.stack([right, 1.0 - right], -1), np.stack([1.0 - right, right], -1)], -2)
    else:
        named = _sampled(embed(distances), distances, seed, samples, first)
    return with_lapses(named, lapse, samples if icons > 2 else math.inf)


def with_lapses(named: Array, lapse: ArrayLike, samples: float) -> Confusion:
    """Confusions of people who give any name in a share of trials; as accurate as so many samples of an icon are."""
    people, icons = named.shape[:2]
    lapses = np.broadcast_to(np.asarray(lapse, dtype=np.float64), (people,))[:, None, None]
    probability = normalised((1.0 - lapses) * named + lapses / icons)
    pooled_error = sampling_error(probability.mean(axis=0), samples * people)
    return Confusion(probability, pooled_error, sampling_error(probability, samples))


def sampling_error(probability: ArrayLike, samples: float) -> float:
    """Largest standard error of a cell that was sampled so often: no more than this, since draws are stratified."""
    p = np.asarray(probability, dtype=np.float64)
    return float(np.sqrt((p * (1.0 - p)).max() / samples))


def embed(distances: Array) -> Array:
    """Points (people, icons, axes) whose distances come nearest the given ones; axes in order of their length."""
    squares = distances**2
    rows, columns = squares.mean(axis=-1, keepdims=True), squares.mean(axis=-2, keepdims=True)
    gram = -0.5 * (squares - rows - columns + squares.mean(axis=(-2, -1), keepdims=True))
    values, vectors = np.linalg.eigh(0.5 * (gram + np.swapaxes(gram, -1, -2)))
    axes = max(distances.shape[-1] - 1, 1)
    values, vectors = values[:, : -axes - 1 : -1], vectors[:, :, : -axes - 1 : -1]
    largest = np.take_along_axis(vectors, np.abs(vectors).argmax(axis=1, keepdims=True), axis=1)
    return np.ascontiguousarray(vectors * np.where(largest < 0, -1.0, 1.0) * np.sqrt(np.maximum(values, 0))[:, None])


def normalised(rows: Array) -> Array:
    """Rows divided by their sums, so that they add to 1 to the last bit that counts."""
    return np.asarray(rows / rows.sum(axis=-1, keepdims=True))


def shared_among_identical(named: Array, distances: Array, identical: float = IDENTICAL) -> Array:
    """Answers shared equally among icons that are identical for a person; the order of the file decided otherwise."""
    same = distances <= identical
    who = np.flatnonzero((same.sum(axis=2) > 1).any(axis=1))
    if not who.size:
        return named
    mean = same[who] / same[who].sum(axis=2, keepdims=True)
    shared = named.copy()
    shared[who] = mean @ named[who] @ mean
    return shared


def _sampled(points: Array, distances: Array, seed: int, samples: int, first: int) -> Array:
    """Shares of answers; draws are spread evenly along the two longest axes, which can only lower the error."""
    from ..kernels import kernels

    people, icons = points.shape[:2]
    counts = np.zeros((people, icons, icons))
    wide = np.abs(points).max(axis=1) > NEGLIGIBLE
    order = np.arange(wide.shape[1])
    needed = np.where(wide, order + 1, 1).max(axis=1)
    axes = np.minimum(-(-needed // 8) * 8, wide.shape[1])  # in eights: of few sizes, so that it is kept
    # Where noise has no part, distances have none either: noise alone makes one of two near icons the other.
    points = np.where(order < axes[:, None, None], points, 0.0)
    # Of x_j·(x_i + z) − |x_j|²/2 only what depends on the answer j counts: x_j·z − |x_i − x_j|²/2.
    gram, size = points @ np.swapaxes(points, 1, 2), (points**2).sum(axis=2)
    squares = np.maximum(size[:, :, None] + size[:, None, :] - 2.0 * gram, 0.0)
    near = (-0.5 * squares).astype(np.float32)
    single = points.astype(np.float32)

    def work(part: slice) -> None:
        for person in range(part.start, part.stop):
            used = int(axes[person])
            drawn = _noise if used * samples > SMALL_NOISE else _kept_noise
            noise = drawn(seed, first + person, used, samples)
            kernels.nearest(near[person], single[person, :, :used] @ noise, counts[person])

    over_rows(work, people, people * samples * icons * 8)
    return shared_among_identical(counts / samples, np.minimum(np.sqrt(squares), distances), NEGLIGIBLE)


def _noise(seed: int, person: int, axes: int, samples: int) -> Single:
    """Noise (axes, samples) of a person in single precision, read-only."""
    rng = np.random.default_rng(np.random.SeedSequence([seed, 1], spawn_key=(person,)))
    noise = rng.standard_normal((axes, samples))
    noise[0] = strata(samples)
    if axes > 1:
        noise[1] = strata(samples)[rng.permutation(samples)]
    found: Single = noise.astype(np.float32)
    found.setflags(write=False)
    return found


_kept_noise = lru_cache(maxsize=128)(_noise)
"""The draws of a posterior judge the same few people on the same noise."""


NAMED_SAMPLES = 400
"""Trials of an icon for a person: a cell of one person has a standard error of at most 0.025."""
FEW_NAMED, LEAST_NAMED = 1152, 4
"""Trials times the square of icons, where a mean over forms of memory or a draw counts: 32 trials of six icons."""
NOISES = 4
"""Features that carry noise: intensity, rate, length, pause."""


def few_named(icons: int, surfaces: int = 1) -> int:
    """Trials of an icon for one of many people: the fewer the more names, on so many surfaces, each is compared with.

    >>> few_named(6), few_named(6, surfaces=2), few_named(64)
    (32, 16, 4)
    """
    return min(NAMED_SAMPLES, max(LEAST_NAMED, FEW_NAMED // (surfaces * icons**2)))


def name_directly(
    felt: Episodes,
    observer: Observer,
    *,
    memory: ArrayLike = 1.0,
    louder: ArrayLike = 1.0,
    lapse: ArrayLike = 0.02,
    seed: int = 0,
    samples: int = NAMED_SAMPLES,
    first: int = 0,
) -> Confusion:
    """Confusions (people, icons, icons) of icons that are named episode by episode from the memory of an observer.

    `memory` and `lapse` are one number or one for each person; `louder` (people, icons) multiplies the noise of an
    icon. Noise is drawn from the seed and the person's number, which counts from `first`.
    """
    from ..kernels import alignment

    people, icons = felt.counts.shape
    own = np.broadcast_to(np.asarray(memory, dtype=np.float64), (people,))
    scale = np.ascontiguousarray(np.broadcast_to(np.asarray(louder, dtype=np.float64), (people, icons)))
    rated = felt.scaled("naming", observer)
    intensity, timing = intensity_noise("naming", observer, own), observer.timing_noise * own
    counts = np.zeros((people, icons, icons))

    def work(part: slice) -> None:
        for person in range(part.start, part.stop):
            rng = np.random.default_rng(np.random.SeedSequence([seed, 8], spawn_key=(first + person,)))
            # The place in an icon comes first, so that noise does not depend on how many episodes others feel.
            noise = rng.standard_normal((int(rated.counts[person].max(initial=0)), icons, samples, NOISES))
            alignment.name(
                rated.features[person], rated.counts[person], intensity[person], timing[person], scale[person],
                observer.missing_cost, noise, counts[person],
            )  # fmt: skip

    over_rows(work, people, people * icons * icons * samples)
    apart = episode_distances(felt, felt, observer, "naming", own)
    return with_lapses(shared_among_identical(counts / samples, apart), lapse, samples)
