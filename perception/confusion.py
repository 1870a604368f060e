"""Pairwise d′ → how often each icon is called by each name.

Icons are points whose distances are the pairwise d′ (classical scaling, negative axes dropped).
A presented icon is felt as its point plus unit noise on every axis, and named after the nearest
point; in a share of trials (lapse) any name is given. For m equally distant icons this is
PC = ∫φ(x − d)Φ(x)^(m−1)dx with pairwise d′ = d√2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermicon.perception.parallel import over_rows
from thermicon.perception.receptors import Array

SAMPLES = 4096
WORK = 4.0e8


@dataclass(frozen=True, slots=True)
class Confusion:
    """Confusions of many people: `probability` (people, icons, icons), rows sum to 1.

    `stress` (people,) is how far the embedding bends the distances (0: not at all, as a share of
    their root mean square); `standard_error` is the largest sampling error of a pooled cell.
    """

    probability: Array
    stress: Array
    standard_error: float

    @property
    def pooled(self) -> Array:
        """Mean over people, shape (icons, icons)."""
        return normalised(self.probability.mean(axis=0))


def confuse(d_prime: ArrayLike, *, lapse: ArrayLike = 0.02, seed: int = 0, samples: int = SAMPLES) -> Confusion:
    """Confusion matrices of pairwise d′ of shape (people, icons, icons) or (icons, icons).

    Noise is drawn from `seed` alone, so two sets of as many icons are compared on the same noise;
    person i has the same noise however many people there are. Two icons are exact. Many icons
    get fewer samples (stated by `standard_error`).

    >>> import numpy as np
    >>> d = 2.78 * np.sqrt(2) * (1 - np.eye(6))
    >>> round(float(np.trace(confuse(d, lapse=0.0).pooled)) / 6, 2)
    0.91
    """
    distances = np.asarray(d_prime, dtype=np.float64)
    distances = distances[None] if distances.ndim == 2 else distances
    people, icons = distances.shape[0], distances.shape[-1]
    if distances.ndim != 3 or distances.shape[1] != icons or not icons:
        raise ValueError(f"d_prime must have shape (people, icons, icons), not {np.shape(d_prime)}")
    if not np.isfinite(distances).all():
        raise ValueError("d_prime must be finite: a pair without a distance cannot be named")
    lapses = np.broadcast_to(np.asarray(lapse, dtype=np.float64), (people,))[:, None, None]

    points, stress = embed(distances)
    error = 0.0
    if icons == 1:
        named = np.ones((people, 1, 1))
    elif icons == 2:
        named = _two(distances[:, 0, 1])
    else:
        drawn = max(64, min(samples, int(WORK / (people * icons * (icons + points.shape[-1])))))
        named = _shared(_sampled(points, seed, drawn), distances)
        pooled = named.mean(axis=0)
        error = float(np.sqrt((pooled * (1.0 - pooled)).max() / (drawn * people)))
    return Confusion(normalised((1.0 - lapses) * named + lapses / icons), stress, error)


def embed(distances: Array) -> tuple[Array, Array]:
    """Points (people, icons, axes) whose distances come nearest the given ones, and the stress (people,)."""
    icons = distances.shape[-1]
    centre = np.eye(icons) - 1.0 / icons
    gram = -0.5 * centre @ (distances**2) @ centre
    values, vectors = np.linalg.eigh(0.5 * (gram + np.swapaxes(gram, -1, -2)))
    axes = max(icons - 1, 1)
    values, vectors = values[:, -axes:], vectors[:, :, -axes:]
    largest = np.take_along_axis(vectors, np.abs(vectors).argmax(axis=1, keepdims=True), axis=1)
    points = np.ascontiguousarray(vectors * np.where(largest < 0, -1.0, 1.0) * np.sqrt(np.maximum(values, 0))[:, None])
    found = np.linalg.norm(points[:, :, None] - points[:, None], axis=-1)
    size = np.sqrt((distances**2).sum(axis=(1, 2)))
    bent = np.sqrt(((found - distances) ** 2).sum(axis=(1, 2)))
    return points, np.divide(bent, size, out=np.zeros_like(bent), where=size > 0)


def equal_percent_correct(d: float, icons: int) -> float:
    """Proportion correct for equally distant icons, PC = ∫φ(x − d)Φ(x)^(m−1)dx, with d = d′/√2.

    >>> round(equal_percent_correct(2.78, 6), 2)
    0.91
    """
    x = np.linspace(-9.0, 9.0 + d, 4001)
    density = np.exp(-0.5 * (x - d) ** 2) / math.sqrt(2.0 * math.pi)
    return float(np.trapezoid(density * _cumulative(x) ** (icons - 1), x))


def normalised(rows: Array) -> Array:
    """Rows divided by their sums, so that they add to 1 to the last bit that counts."""
    scaled: Array = rows / rows.sum(axis=-1, keepdims=True)
    return scaled


def _cumulative(x: Array) -> Array:
    return np.array([0.5 * math.erfc(-v / math.sqrt(2.0)) for v in x.tolist()], dtype=np.float64)


def _two(d_prime: Array) -> Array:
    right = _cumulative(0.5 * d_prime)
    return np.stack([np.stack([right, 1.0 - right], -1), np.stack([1.0 - right, right], -1)], -2)


def _shared(named: Array, distances: Array) -> Array:
    """Answers shared equally among icons that nobody can tell apart, which the nearest point leaves to rounding."""
    same = (distances < 1e-9).all(axis=0).astype(np.float64)
    mean = same / same.sum(axis=1, keepdims=True)
    return mean @ named @ mean if mean.max(axis=1).min() < 1.0 else named


def _sampled(points: Array, seed: int, samples: int) -> Array:
    from thermicon.perception import kernels

    people, icons, axes = points.shape
    half = samples // 2
    noise = np.random.default_rng(np.random.SeedSequence([seed, 1])).standard_normal((people, half, axes))
    counts = np.zeros((people, icons, icons))

    def work(part: slice) -> None:
        kernels.nearest(points[part], noise[part], counts[part])

    over_rows(work, people, noise.size * icons)
    return counts / (2 * half)
