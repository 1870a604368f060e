"""Answers of an identification experiment: how often each participant called each icon by each name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, own_arrays


@dataclass(frozen=True, slots=True)
class Trials:
    """Answers of some participants to the icons of a set.

    Attributes
    ----------
    icons
        Names of all icons that could be answered, in the order of the set.
    participants
        Labels of the participants.
    counts
        Answers (participants, icons presented, icons answered).
    time_s
        Median time of each participant's correct answers, s; NaN where none was recorded.
    source, digest
        Name of the file, and the first 16 digits of its SHA-256.
    warnings
        What is doubtful about the times in the file, with place and cure.

    Raises
    ------
    ValueError
        For counts of another shape, negative or fractional ones, and for a participant without answers.

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
