"""The perceptual map: icons as points of a plane whose distances come as near to the pairwise d′ as a plane allows.

Classical scaling gives a start, SMACOF improves it; a reference map gives the orientation, else a convention.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from thermicon.base.numbers.arrays import Array, own_arrays
from thermicon.base.results.drawn import Drawn

if TYPE_CHECKING:
    from ..ranking.ranking import Ranking

STEPS, TOLERANCE = 500, 1e-9
PERSON_STEPS, PERSON_TOLERANCE = 100, 1e-6
MOST_PEOPLE, MOST_CELLS = 64, 200_000
"""How many people a map is drawn from, and how many d′ of them: fewer people of many icons."""
ALIKE = 1e-6
"""Below this share of the size of a map, lengths count as nothing and axes as equally long."""


@dataclass(frozen=True, slots=True)
class PerceptualMap(Drawn):
    """Icons as points (icons, 2) of a plane, in d′, and how far the plane bends the distances: Kruskal's stress-1.

    `covariance` (icons, 2, 2) is the scatter in d′² over the maps of single `people`; None for one person.
    """

    labels: tuple[str, ...]
    points: Array
    stress: float
    covariance: Array | None = None
    people: int = 1

    def __post_init__(self) -> None:
        own_arrays(self, "points", *(() if self.covariance is None else ("covariance",)))

    def __repr__(self) -> str:
        icons = "1 icon" if len(self.labels) == 1 else f"{len(self.labels)} icons"
        return f"PerceptualMap({icons}, stress {self.stress:.3f}, {self.people} people)"


def perceptual_map(
    d_prime: ArrayLike, labels: Sequence[str], people: ArrayLike | None = None, reference: PerceptualMap | None = None
) -> PerceptualMap:
    """Lay icons out in a plane whose distances are as near as possible to pairwise d′ (icons, icons).

    `people` are d′ (n, icons, icons) of single people, for the ellipses. With a reference the map is turned, mirrored
    and shifted onto it as well as the icons of the same name allow (two or more), and never stretched.

    >>> found = perceptual_map([[0, 3, 4], [3, 0, 5], [4, 5, 0]], ["a", "b", "c"])
    >>> round(found.stress, 6), float(np.linalg.norm(found.points[1] - found.points[2]).round(3))
    (0.0, 5.0)
    """
    wanted, icons = np.asarray(d_prime, dtype=np.float64), len(labels)
    points = settled(smacof(wanted, classical(wanted)))
    if reference is not None:
        place = {name: k for k, name in enumerate(reference.labels)}
        known = [k for k, name in enumerate(labels) if name in place]
        if len(known) > 1:
            target = reference.points[[place[labels[k]] for k in known]]
            points = laid_onto(points, points[known], target)
    covariance, count = None, 1
    if people is not None and len(held := np.asarray(people, dtype=np.float64)) > 1:
        own = smacof(held, np.broadcast_to(points, (len(held), icons, 2)), PERSON_STEPS, PERSON_TOLERANCE)
        laid = np.stack([laid_onto(one, one, points) for one in own])
        off = laid - laid.mean(axis=0)
        covariance, count = np.einsum("pia,pib->iab", off, off) / (len(held) - 1), len(held)
    return PerceptualMap(tuple(labels), points, float(stress(wanted, points)), covariance, count)


def map_of(ranking: Ranking, reference: PerceptualMap | None = None) -> PerceptualMap:
    """Lay out the icons of a ranking by their median d′, with the spread over its first people, onto a reference."""
    few = max(2, min(MOST_PEOPLE, MOST_CELLS // len(ranking.icons) ** 2))
    return perceptual_map(ranking.d_prime, ranking.labels, ranking.felt.d_prime[:few], reference)


def classical(distances: Array) -> Array:
    """Points (icons, 2) by classical scaling: the two largest axes of the centred squares."""
    icons = distances.shape[-1]
    centre = np.eye(icons) - 1.0 / icons
    values, vectors = np.linalg.eigh(-0.5 * centre @ (distances**2) @ centre)
    points = np.zeros((icons, 2))
    largest = vectors[:, ::-1][:, :2] * np.sqrt(np.maximum(values[::-1][:2], 0.0))
    points[:, : largest.shape[1]] = largest
    return points


def smacof(distances: Array, start: Array, steps: int = STEPS, tolerance: float = TOLERANCE) -> Array:
    """Points (..., icons, 2) improved by majorisation from a start, until no stress falls by more than `tolerance`."""
    points = np.array(start, dtype=np.float64)
    icons, diagonal = points.shape[-2], np.arange(points.shape[-2])
    before = stress(distances, points)
    for _ in range(steps):
        found = between(points)
        pull = -np.divide(distances, found, out=np.zeros_like(found), where=found > 0)
        pull[..., diagonal, diagonal] = -pull.sum(axis=-1)
        points = pull @ points / icons
        now = stress(distances, points)
        if np.all(before - now <= tolerance):
            break
        before = now
    return points


def stress(distances: Array, points: Array) -> Array:
    """Kruskal's stress-1 of maps (..., icons, 2): root of the summed squared errors over the summed squared d′."""
    size = (distances**2).sum(axis=(-2, -1))
    bent = ((between(points) - distances) ** 2).sum(axis=(-2, -1))
    return np.asarray(np.sqrt(np.divide(bent, size, out=np.zeros_like(bent), where=size > 0)))


def between(points: Array) -> Array:
    """Distances (..., icons, icons) between points (..., icons, 2)."""
    return np.asarray(np.linalg.norm(points[..., :, None, :] - points[..., None, :, :], axis=-1))


def laid_onto(points: Array, some: Array, target: Array) -> Array:
    """Points (n, 2) turned, mirrored and shifted as brings `some` (k, 2) nearest to `target` (k, 2): Procrustes."""
    off, to = some.mean(axis=0), target.mean(axis=0)
    left, _, right = np.linalg.svd((some - off).T @ (target - to))
    return np.asarray((points - off) @ (left @ right) + to)


def settled(points: Array) -> Array:
    """The map about its centre, its longer axis across, its first icon off the centre to the left and above.

    Of a map as wide as it is high that icon lies on the axis across.
    """
    centred = points - points.mean(axis=0)
    size = float(np.abs(centred).max())
    if size == 0.0:
        return np.zeros_like(points)
    _, length, axes = np.linalg.svd(centred, full_matrices=False)
    if length.size > 1 and length[0] - length[1] > ALIKE * length[0]:
        turned = centred @ axes.T
    else:
        first = centred[int((np.hypot(*centred.T) > ALIKE * size).argmax())]
        cosine, sine = first / np.hypot(*first)
        turned = centred @ np.array([[cosine, -sine], [sine, cosine]])
    for axis, side in ((0, -1.0), (1, 1.0)):
        off = turned[:, axis]
        first_off = off[int((np.abs(off) > ALIKE * size).argmax())]
        turned[:, axis] *= side if first_off > 0 else -side
    return np.asarray(turned)
