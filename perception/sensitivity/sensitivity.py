"""Which uncertain parameters influence proportion correct and bits most: what a laboratory should measure first.

Every parameter of the observer, the contact, the skin and the people is drawn from its whole interval. Its influence is
its total Sobol index: its share of the variance of a prediction, interactions included, so that the shares may add up
to more than 1 (Saltelli's design, `scipy.stats.sobol_indices`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..arrays import Array
from ..identification.population import score
from ..kernels.parallel import in_order
from ..observer.channels import USUAL_NORM
from ..observer.observer import Norm, check_norm
from ..ranking.ranking import with_changes
from ..sensation.parameters import ObserverParameter, latin, observer_at
from .simulation_grid import SimulationGrid, simulate_grid

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

SAMPLES = 64
PRESENTATIONS = 512
"""Presentations of each icon to each person in a run."""
WORTH_MEASURING = 0.2
"""A parameter with less than this share of the largest index need not be measured first."""
PREDICTIONS = ("proportion_correct", "information_bits")

Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class Effect:
    """Influence of one parameter on the proportion correct and on the bits.

    `proportion_correct` and `information_bits` are total Sobol indices. The fields `..._ends` are the predictions at
    the low and at the high end of the interval, with all other parameters at their values.
    """

    parameter: ObserverParameter
    proportion_correct: float
    information_bits: float
    proportion_correct_ends: tuple[float, float]
    information_bits_ends: tuple[float, float]

    def __repr__(self) -> str:
        low, high = self.proportion_correct_ends
        return (
            f"Effect({self.parameter.name}: {100 * self.proportion_correct:.0f} % of the variance of the proportion "
            f"correct, which is {100 * low:.0f} % at the low end and {100 * high:.0f} % at the high end)"
        )


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """Effects of the parameters on a prediction, ordered by their influence on the proportion correct.

    Attributes
    ----------
    rig, rig_changes
        Name of the rig, and its changed keys.
    people, seed
        Number of virtual people, the same in every run, and the seed.
    norm
        How a difference over time is counted.
    samples, runs
        Number of base samples and of predictions.
    proportion_correct, information_bits
        The prediction with every parameter at its value: 0–1, and bits.
    effects
        Effect of each parameter.

    See Also
    --------
    sensitivity : Runs the study.
    """

    rig: str
    rig_changes: tuple[str, ...]
    people: int
    seed: int
    norm: str
    samples: int
    runs: int
    proportion_correct: float
    information_bits: float
    effects: tuple[Effect, ...]

    @property
    def first(self) -> tuple[str, ...]:
        """Names of the parameters to measure first: those with more than a fifth of the largest index."""
        tops = [max((getattr(e, what) for e in self.effects), default=0.0) for what in PREDICTIONS]
        return tuple(
            e.parameter.name
            for e in self.effects
            if any(getattr(e, what) > WORTH_MEASURING * top for what, top in zip(PREDICTIONS, tops, strict=True))
        )

    def rows(self) -> list[dict[str, Any]]:
        """One plain row for each parameter; low, value and high are in the unit of the row."""
        return [
            {
                "parameter": e.parameter.name,
                "unit": e.parameter.unit,
                "low": e.parameter.low,
                "value": e.parameter.value,
                "high": e.parameter.high,
                "proportion_correct_total_index": e.proportion_correct,
                "information_bits_total_index": e.information_bits,
                "proportion_correct_at_low": e.proportion_correct_ends[0],
                "proportion_correct_at_high": e.proportion_correct_ends[1],
                "information_bits_at_low": e.information_bits_ends[0],
                "information_bits_at_high": e.information_bits_ends[1],
                "use": e.parameter.use,
                "source": e.parameter.source,
            }
            for e in self.effects
        ]

    def to_frame(self) -> pd.DataFrame:
        """The rows as a table."""
        import pandas as pd

        return pd.DataFrame(self.rows())

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw two bars for each parameter, proportion correct and bits; return the axes."""
        from ..plots.draw_sensitivity import plot_sensitivity

        return plot_sensitivity(self, ax)

    def __repr__(self) -> str:
        first = ", ".join(self.first[:3]) or "nothing"
        return (
            f"Sensitivity({len(self.effects)} parameters on "
            f"{with_changes(self.rig, self.rig_changes)}, {self.runs} runs of {self.people} people, "
            f"{100 * self.proportion_correct:.1f} % correct; measure first {first})"
        )

    def _repr_html_(self) -> str:
        from ..plots.draw import as_svg

        return as_svg(self.plot())


def sensitivity(
    icons: IconSet,
    rig: Rig,
    *,
    people: int = 24,
    seed: int = 0,
    samples: int = SAMPLES,
    norm: str = USUAL_NORM,
    progress: Progress | None = None,
) -> Sensitivity:
    """Find the parameters that influence the prediction for a set most, over their whole intervals.

    Parameters
    ----------
    icons
        The set, at least two icons.
    rig
        The rig that plays it.
    people
        Virtual people; every run has the same people and the same noise.
    seed
        Seed of people, noise and design: the same arguments give the same numbers.
    samples
        Base samples, a power of 2; the study takes samples × (parameters + 2) runs, and two for each parameter.
    norm
        How a difference over time is counted: `max`, `rms` or `integral`.
    progress
        Called with (runs done, runs in all).

    Returns
    -------
    Sensitivity
        Effects of the parameters, the most influential first.

    Raises
    ------
    ValueError
        For fewer than two icons, a number of samples that is not a power of 2 from 2 on, and an unknown norm.

    See Also
    --------
    rank : Predicts with every parameter at its value.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> six = read_cue("six-icons")
    >>> sensitivity([six["cooling-step"]], Rig.load("thenar"))
    Traceback (most recent call last):
    ...
    ValueError: ...
    """
    members, chosen = list(icons), check_norm(norm)
    if len(members) < 2:
        raise ValueError("a sensitivity needs at least two icons: one alone is never confused")
    if samples < 2:
        raise ValueError(f"a sensitivity needs at least 2 samples, not {samples}")
    if samples & (samples - 1):
        raise ValueError(
            f"sobol needs a power of 2 of samples, such as {1 << (samples - 1).bit_length()}, not {samples}"
        )
    grid = simulate_grid(members, rig, people, seed, chosen)
    count = len(grid.parameters)
    shares = np.concatenate([grid.centre[None], _ends(grid), saltelli_design(count, samples, seed)])
    predicted = _predictions(grid, shares, chosen, seed, progress)
    ends = predicted[1 : 1 + 2 * count].reshape(count, 2, len(PREDICTIONS))
    indices = total_indices(predicted[1 + 2 * count :], samples)
    effects = [
        Effect(parameter, float(index[0]), float(index[1]), _both(end[:, 0]), _both(end[:, 1]))
        for parameter, index, end in zip(grid.parameters, indices, ends, strict=True)
    ]
    return Sensitivity(
        rig=rig.name,
        rig_changes=tuple(rig.changes),
        people=people,
        seed=seed,
        norm=chosen,
        samples=samples,
        runs=len(shares),
        proportion_correct=float(predicted[0, 0]),
        information_bits=float(predicted[0, 1]),
        effects=tuple(sorted(effects, key=lambda e: (-e.proportion_correct, -e.information_bits, e.parameter.name))),
    )


def saltelli_design(count: int, base: int, seed: int) -> Array:
    """Shares (base × (count + 2), count): A, B, and for every parameter A with the column of that parameter from B."""
    both = latin(2 * count, base, seed)
    a, b = both[:, :count], both[:, count:]
    mixed = np.repeat(a[None], count, axis=0)
    for k in range(count):
        mixed[k, :, k] = b[:, k]
    return np.concatenate([a, b, *mixed])


def total_indices(predicted: Array, base: int) -> Array:
    """Total Sobol indices (parameters, predictions) of a Saltelli design; 0 where a prediction does not vary."""
    from scipy.stats import sobol_indices

    parts = predicted.reshape(-1, base, predicted.shape[-1])
    indices = np.zeros((len(parts) - 2, predicted.shape[-1]))
    for k in range(predicted.shape[-1]):
        a, b, mixed = parts[0, :, k], parts[1, :, k], parts[2:, :, k]
        if np.ptp(np.concatenate([a, b])) > 0.0:
            values: dict[Literal["f_A", "f_B", "f_AB"], Array] = {
                "f_A": a[None],
                "f_B": b[None],
                "f_AB": mixed[:, None],
            }
            indices[:, k] = np.ravel(sobol_indices(func=values, n=base).total_order)
    return indices


def _predictions(grid: SimulationGrid, shares: Array, norm: Norm, seed: int, progress: Progress | None) -> Array:
    """Proportion correct and bits, means over people, for every row of shares; rows that play alike share a run."""
    groups: dict[tuple[float, float], list[int]] = {}
    for k, row in enumerate(shares):
        groups.setdefault(grid.played_key(row), []).append(k)

    def predict(rows: Sequence[int]) -> list[tuple[int, float, float]]:
        played, results = grid.played(shares[rows[0]]), []
        for k in rows:
            observer = observer_at(grid.observer_values(shares[k]))
            scores = score(played, grid.crowd_at(shares[k]), observer, norm, seed, PRESENTATIONS)
            results.append((k, float(scores.proportion_correct.mean()), float(scores.information_bits.mean())))
        return results

    predicted, done = np.empty((len(shares), len(PREDICTIONS))), 0
    for results in in_order(predict, list(groups.values())):
        for k, *both in results:
            predicted[k], done = both, done + 1
            if progress is not None:
                progress(done, len(shares))
    return predicted


def _ends(grid: SimulationGrid) -> Array:
    """Rows with one parameter at its low and at its high end, the others at their values."""
    count = len(grid.parameters)
    rows = np.repeat(grid.centre[None], 2 * count, axis=0)
    for k in range(count):
        rows[2 * k, k], rows[2 * k + 1, k] = 0.0, 1.0
    return rows


def _both(ends: Sequence[float] | Array) -> tuple[float, float]:
    return float(ends[0]), float(ends[1])
