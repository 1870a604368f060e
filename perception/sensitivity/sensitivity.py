"""Which uncertain parameters move per cent correct and bits most: what a lab should measure first.

Every parameter is drawn from its whole interval, those of the observer and those of contact, skin and
people. `sobol` gives shares of the variance of a prediction (total indices: with all interactions, so
that they may add to more than 1); `morris` the mean size of the effect of a parameter (SALib).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..identification.population import score
from ..kernels.parallel import in_order
from ..observer.observer import Norm, check_norm
from ..ranking.ranking import with_changes
from ..sensation.parameters import ObserverParameter, observer_at
from .designs import crossed, mean_effects, screened, total_indices
from .simulation_grid import SimulationGrid, simulate_grid

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

METHODS = ("sobol", "morris")
SAMPLES = {"sobol": 64, "morris": 16}
NOISE = 512
FIRST = 0.2
"""What moves a prediction by less than this share of what the largest does is not worth measuring first."""

Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class Effect:
    """How much one parameter moves proportion correct and bits.

    `proportion_correct` and `information_bits` are total Sobol indices or, by Morris, mean sizes of effects over the
    interval (0–1; bits). `..._ends` are the predictions at its low and its high end, all others at their values.
    """

    parameter: ObserverParameter
    proportion_correct: float
    information_bits: float
    proportion_correct_ends: tuple[float, float]
    information_bits_ends: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """Effects, the largest on per cent correct first, of `runs` predictions with the same people and noise.

    `proportion_correct` and `information_bits` are predicted with every parameter at its value.
    """

    method: str
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
        """Names of what to measure first: all that move a prediction by over a fifth of what the largest does."""
        tops = [max((getattr(e, what) for e in self.effects), default=0.0) for what in PREDICTIONS]
        return tuple(
            e.parameter.name
            for e in self.effects
            if any(getattr(e, what) > FIRST * top for what, top in zip(PREDICTIONS, tops, strict=True))
        )

    def rows(self) -> list[dict[str, Any]]:
        """One plain row for each parameter, numbers in the unit of the row or as the column says."""
        index = {"sobol": "total_index", "morris": "mean_effect"}[self.method]
        return [
            {
                "parameter": e.parameter.name,
                "unit": e.parameter.unit,
                "low": e.parameter.low,
                "value": e.parameter.value,
                "high": e.parameter.high,
                f"proportion_correct_{index}": e.proportion_correct,
                f"information_bits_{index}": e.information_bits,
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
        """Draw two bars a parameter, per cent correct and bits; returns the axes."""
        from ..plots.draw_sensitivity import plot_sensitivity

        return plot_sensitivity(self, ax)

    def __repr__(self) -> str:
        said = ", ".join(self.first[:3]) or "nothing"
        return (
            f"Sensitivity({self.method}: {len(self.effects)} parameters on "
            f"{with_changes(self.rig, self.rig_changes)}, {self.runs} runs of {self.people} people, "
            f"{100 * self.proportion_correct:.1f} % correct; measure first {said})"
        )

    def _repr_html_(self) -> str:
        from ..plots.draw import as_svg

        return as_svg(self.plot())


PREDICTIONS = ("proportion_correct", "information_bits")


def sensitivity(
    icons: IconSet,
    rig: Rig,
    *,
    people: int = 24,
    seed: int = 0,
    method: str = "sobol",
    samples: int | None = None,
    norm: str = "max",
    progress: Progress | None = None,
) -> Sensitivity:
    """Which parameters move the prediction for a set most, over their whole intervals.

    `samples` is the number of base samples (sobol: it takes samples × (parameters + 2) runs) or of trajectories
    (morris). Every run asks the same people on the same noise, so the same arguments give the same numbers.
    Raises `ValueError` for fewer than two icons, too few samples or unknown names, `MissingError` without SALib.
    """
    members, chosen = list(icons), check_norm(norm)
    if len(members) < 2:
        raise ValueError("a sensitivity needs at least two icons: one alone is never confused")
    if method not in METHODS:
        raise ValueError(f"there is no method {method!r}: choose one of {', '.join(METHODS)}")
    base = SAMPLES[method] if samples is None else samples
    if base < 2:
        raise ValueError(f"a sensitivity needs at least 2 samples, not {base}")
    if method == "sobol" and base & (base - 1):
        raise ValueError(f"sobol needs a power of 2 of samples, such as {1 << (base - 1).bit_length()}, not {base}")
    stage = simulate_grid(members, rig, people, seed, chosen)
    shares = (
        screened(len(stage.parameters), base, seed)
        if method == "morris"
        else crossed(len(stage.parameters), base, seed)
    )
    ends = _ends(stage)
    asked = np.concatenate([stage.centre[None], ends, shares])
    found = _asked(stage, asked, chosen, seed, progress)
    at_ends = found[1 : 1 + len(ends)].reshape(-1, 2, len(PREDICTIONS))
    moved = found[1 + len(ends) :]
    sizes = mean_effects(shares, moved, seed) if method == "morris" else total_indices(moved, base)
    effects = [
        Effect(parameter, float(size[0]), float(size[1]), _both(end[:, 0]), _both(end[:, 1]))
        for parameter, size, end in zip(stage.parameters, sizes, at_ends, strict=True)
    ]
    return Sensitivity(
        method=method,
        rig=rig.name,
        rig_changes=tuple(rig.changes),
        people=people,
        seed=seed,
        norm=chosen,
        samples=base,
        runs=len(asked),
        proportion_correct=float(found[0, 0]),
        information_bits=float(found[0, 1]),
        effects=tuple(sorted(effects, key=lambda e: (-e.proportion_correct, -e.information_bits, e.parameter.name))),
    )


def _asked(stage: SimulationGrid, asked: Array, norm: Norm, seed: int, progress: Progress | None) -> Array:
    """Proportion correct and bits, means over people, for every row of shares; those that play alike together."""
    alike: dict[tuple[float, float], list[int]] = {}
    for k, shares in enumerate(asked):
        alike.setdefault(stage.played_key(shares), []).append(k)

    def work(rows: Sequence[int]) -> list[tuple[int, float, float]]:
        played, results = stage.played(asked[rows[0]]), []
        for k in rows:
            observer = observer_at(stage.observer_values(asked[k]))
            scores = score(played, stage.crowd_at(asked[k]), observer, norm, seed, NOISE)
            results.append((k, float(scores.proportion_correct.mean()), float(scores.information_bits.mean())))
        return results

    found, done = np.empty((len(asked), len(PREDICTIONS))), 0
    for results in in_order(work, list(alike.values())):
        for k, *both in results:
            found[k], done = both, done + 1
            if progress is not None:
                progress(done, len(asked))
    return found


def _ends(stage: SimulationGrid) -> Array:
    """Rows with one parameter at its low and at its high end, the others at their values."""
    count = len(stage.parameters)
    rows = np.repeat(stage.centre[None], 2 * count, axis=0)
    for k in range(count):
        rows[2 * k, k], rows[2 * k + 1, k] = 0.0, 1.0
    return rows


def _both(ends: Sequence[float] | Array) -> tuple[float, float]:
    return float(ends[0]), float(ends[1])
