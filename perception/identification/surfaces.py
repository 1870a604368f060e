"""Icons that are felt on several separate surfaces of skin.

Each surface is felt and remembered for itself; nothing is assumed about place, which is certain. With tracks a and b of
two icons on surface s,

    d′² = Σ_s d′²(a_s, b_s),   p = 1 − Π_s (1 − p_s),   cost of a name in a trial = Σ_s cost_s.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermicon.base.numbers.arrays import Array

from ..kernels.parallel import over_rows
from ..observer.observer import Observer
from ..sensation.detection import Detection
from .confusion import NOISES, Confusion, with_lapses
from .episodes import Episodes, intensity_noise
from .tracks import Tracks

Played = NDArray[np.int64]
"""Place (surfaces, icons) of the track that each surface plays in each icon."""

ROUNDING = 1e-12
"""A track that everybody reports with a smaller probability is not felt, as a rest is not."""


def joined(parts: Sequence[Episodes]) -> Episodes:
    """Episodes of tracks on several rigs, one rig after the other."""
    if len(parts) == 1:
        return parts[0]
    most = max(part.features.shape[2] for part in parts)
    room = [np.pad(part.features, ((0, 0), (0, 0), (0, most - part.features.shape[2]), (0, 0))) for part in parts]
    return Episodes(np.concatenate(room, axis=1), np.concatenate([part.counts for part in parts], axis=1))


def added(d_prime: Array, played: Played) -> Array:
    """d′ (people, icons, icons) of icons from those of tracks (people, tracks, tracks): squares add over surfaces."""
    squares, total = d_prime**2, np.zeros((len(d_prime), played.shape[1], played.shape[1]))
    for tracks in played:
        total += squares[:, tracks[:, None], tracks]
    return np.asarray(np.sqrt(total))


def detected_by_any(parts: Sequence[Detection], played: Played) -> Detection:
    """Detection (people, icons) by any surface, from that (people, tracks) of tracks on one rig after the other.

    Of two reports the earlier counts; in one step of the times, either is the earlier one half of the time.
    """
    probability, cold = (
        np.concatenate([getattr(part, name) for part in parts], axis=1) for name in ("probability", "cold_share")
    )
    missed, felt = 1.0 - probability, np.any(probability > ROUNDING, axis=0)
    alone = [tracks[felt[tracks]] if felt[tracks].any() else tracks[:1] for tracks in played.T]
    each = [probability[:, own[0]] if own.size == 1 else 1.0 - missed[:, own].prod(axis=1) for own in alone]
    whole = np.stack(each, axis=1)
    if any(part.reported is None for part in parts):
        return Detection(whole, np.zeros_like(whole), None, parts[0].dt_s)
    courses = np.concatenate([part.courses for part in parts], axis=1)
    steps = np.diff(courses, axis=2, prepend=0.0)
    later = 1.0 - courses + 0.5 * steps
    rate = np.divide(steps, later, out=np.zeros_like(steps), where=later > 0.0)
    shares, reported = [], []
    for own in alone:
        if own.size == 1:
            shares.append(cold[:, own[0]])
            reported.append(courses[:, own[0]])
            continue
        firsts = np.einsum("ptn,pn->pt", rate[:, own], later[:, own].prod(axis=1))
        sums = firsts.sum(axis=1)
        shares.append(np.divide((firsts * cold[:, own]).sum(axis=1), sums, out=np.zeros_like(sums), where=sums > 0.0))
        reported.append(1.0 - (1.0 - courses[:, own]).prod(axis=1))
    return Detection(whole, np.stack(shares, axis=1), np.stack(reported, axis=1), parts[0].dt_s)


def name_apart(
    felt: Episodes,
    tracks: Tracks,
    observer: Observer,
    *,
    memory: Array,
    lapse: ArrayLike,
    seed: int,
    samples: int,
    first: int = 0,
) -> Confusion:
    """Confusions (people, icons, icons) of icons that are named episode by episode on all surfaces together.

    The first surface by rank has the noise of `name_directly`. Names that cost the same share a trial.
    """
    from ..kernels import alignment

    assert tracks.played is not None
    played, people, icons = tracks.played, len(felt), len(tracks.names)
    rated = felt.scaled("naming", observer)
    intensity, timing = intensity_noise("naming", observer, memory), observer.timing_noise * memory
    counts = np.zeros((people, icons, icons))

    def work(part: slice) -> None:
        for person in range(part.start, part.stop):
            most = rated.counts[person][played].max(axis=1)
            noise = np.zeros((len(played), most.max(), icons, samples, NOISES))
            for surface, (rank, episodes) in enumerate(zip(tracks.ranks, most.tolist(), strict=True)):
                key = (seed, 8, rank) if rank else (seed, 8)
                rng = np.random.default_rng(np.random.SeedSequence(key, spawn_key=(first + person,)))
                rng.standard_normal(out=noise[surface, :episodes])
            alignment.name_apart(
                rated.features[person], rated.counts[person], played, intensity[person], timing[person],
                observer.missing_cost, noise, counts[person],
            )  # fmt: skip

    over_rows(work, people, people * played.size * icons * samples)
    return with_lapses(counts / samples, lapse, samples)
