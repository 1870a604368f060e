"""Direct naming: every trial is a sequence of felt episodes with noise, and gets the name that it costs least to give.

Noise belongs to what was felt, so that a presented icon can lose an episode in memory but never gains one; confusions
are then asymmetric without a constant for it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..kernels.parallel import over_rows
from ..observer.observer import Observer
from .confusion import Confusion, normalised, sampling_error, shared_among_identical
from .episodes import Episodes, episode_distances, intensity_noise

SAMPLES = 400
"""Trials of an icon for a person: a cell of one person has a standard error of at most 0.025."""
NOISES = 4
"""Features that carry noise: intensity, rate, length, pause."""


def name_directly(
    felt: Episodes,
    observer: Observer,
    *,
    memory: ArrayLike = 1.0,
    louder: ArrayLike = 1.0,
    lapse: ArrayLike = 0.02,
    bias: ArrayLike = 0.0,
    seed: int = 0,
    samples: int = SAMPLES,
    first: int = 0,
) -> Confusion:
    """Confusions (people, icons, icons) of icons that are named episode by episode.

    Parameters
    ----------
    felt
        Episodes of every person and icon.
    observer
        The observer whose memory it is.
    memory, lapse
        Multiples of memory noise, and shares of guessed trials: one for each person, or for all.
    louder
        Multiples (people, icons) of the noise of an icon, for what the icon before leaves behind.
    bias
        Log likelihoods (icons,) or (people, icons) that favour names.
    seed, samples, first
        Noise is drawn from the seed and the person's number, which counts from `first`; trials of an icon.

    """
    from ..kernels import alignment

    people, icons = felt.counts.shape
    own = np.broadcast_to(np.asarray(memory, dtype=np.float64), (people,))
    scale = np.ascontiguousarray(np.broadcast_to(np.asarray(louder, dtype=np.float64), (people, icons)))
    favour = np.ascontiguousarray(np.broadcast_to(np.asarray(bias, dtype=np.float64), (people, icons)))
    lapses = np.broadcast_to(np.asarray(lapse, dtype=np.float64), (people,))[:, None, None]
    rated = felt.scaled("naming", observer)
    intensity, timing = intensity_noise("naming", observer, own), observer.memory.timing * own
    counts = np.zeros((people, icons, icons))

    def work(part: slice) -> None:
        for person in range(part.start, part.stop):
            rng = np.random.default_rng(np.random.SeedSequence([seed, 8], spawn_key=(first + person,)))
            # The place in an icon comes first, so that noise does not depend on how many episodes others feel.
            noise = rng.standard_normal((int(rated.counts[person].max(initial=0)), icons, samples, NOISES))
            alignment.name(
                rated.features[person], rated.counts[person], intensity[person], timing[person], scale[person],
                observer.memory.missing, favour[person], noise, counts[person],
            )  # fmt: skip

    over_rows(work, people, people * icons * icons * samples)
    apart = episode_distances(felt, felt, observer, "naming", own)
    named = shared_among_identical(counts / samples, apart, favour)
    probability: Array = normalised((1.0 - lapses) * named + lapses / icons)
    error = sampling_error(probability.mean(axis=0), samples * people) if icons > 1 else 0.0
    person_error = sampling_error(probability, samples) if icons > 1 else 0.0
    return Confusion(probability, np.zeros(people), error, person_error)
