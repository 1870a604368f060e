"""Which constants carry the doubt about a set on a rig, and which measurement would reduce it most.

The set is predicted with draws of the posterior as a new laboratory would see it, contact and outermost skin layer
included. Constants that take no part in the set on its rig are left out. Constants of one draw belong together, so that
shares of constants that trade off overlap and need not add up to 1; the share of a measurement is what its constants
explain together.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..drawn import Drawn
from ..identification.doubt import explained, explained_together, scores_of
from ..identification.laboratory_draws import LaboratoryDraws, laboratory_draws
from ..identification.run_end import run_end_s
from ..observer.channels import USUAL_NORM
from ..observer.observer import check_norm
from ..observer.observer_model import ObserverModel
from ..progress import Progress, step_counter
from ..sensation.parameters import latin
from .measurements import MEASUREMENTS, base_name
from .ranking import with_changes
from .rig_doubt import RATE_HZ, UncertainRig

if TYPE_CHECKING:
    import pandas as pd

    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

DRAWS = 256
FEWEST_DRAWS = 64
"""Of fewer draws a share of some per cent is not distinguishable from chance."""
NOTEWORTHY = 0.02
"""Measurements that would take away less of the variance are not named as the first to make."""


@dataclass(frozen=True, slots=True)
class Effect:
    """Influence of one constant on the prediction.

    Attributes
    ----------
    constant
        Its name.
    unit
        Its unit, where it is known.
    low, high
        Ends of the 95 % interval of the draws.
    proportion_correct, information_bits
        Share (0–1) of the variance of each over draws that would go if the constant were known.
    at_low, at_high
        Proportion correct to be expected at both ends of the interval.
    """

    constant: str
    unit: str
    low: float
    high: float
    proportion_correct: float
    information_bits: float
    at_low: float
    at_high: float


@dataclass(frozen=True, slots=True)
class Reduction:
    """A measurement, the constants it would determine, and the share (0–1) of the variance that would go with them."""

    measurement: str
    constants: tuple[str, ...]
    proportion_correct: float
    information_bits: float


@dataclass(frozen=True, slots=True)
class Sensitivity(Drawn):
    """Effects of constants, and reductions by measurements, on a prediction; the largest first.

    Attributes
    ----------
    rig, rig_changes
        Name of the rig, and its changed keys.
    people, seed, norm, draws, observer
        How the draws were judged: people of a draw, seed, norm, number of draws, file of the observer.
    proportion_correct, information_bits
        Medians over the draws: 0–1, and bits.
    proportion_correct_interval
        95 % of the draws, for a new laboratory; contact and skin layer of the rig are uncertain.
    effects
        Effect of each constant.
    reductions
        What each measurement would take away.

    See Also
    --------
    sensitivity : Makes it.
    """

    rig: str
    rig_changes: tuple[str, ...]
    people: int
    seed: int
    norm: str
    draws: int
    observer: str
    proportion_correct: float
    information_bits: float
    proportion_correct_interval: tuple[float, float]
    effects: tuple[Effect, ...]
    reductions: tuple[Reduction, ...]

    @property
    def first(self) -> tuple[Reduction, ...]:
        """Measurements that would take away at least 2 % of the variance of the proportion correct."""
        return tuple(each for each in self.reductions if each.proportion_correct >= NOTEWORTHY)

    def rows(self) -> list[dict[str, Any]]:
        """One plain row for each constant."""
        return [
            {
                "constant": each.constant,
                "unit": each.unit,
                "low": each.low,
                "high": each.high,
                "proportion_correct_share": each.proportion_correct,
                "information_bits_share": each.information_bits,
                "proportion_correct_at_low": each.at_low,
                "proportion_correct_at_high": each.at_high,
            }
            for each in self.effects
        ]

    def to_frame(self) -> pd.DataFrame:
        """The rows as a table."""
        import pandas as pd

        return pd.DataFrame(self.rows())

    def __repr__(self) -> str:
        first = self.first[0].measurement if self.first else "nothing"
        return (
            f"Sensitivity({len(self.effects)} constants on {with_changes(self.rig, self.rig_changes)}, {self.draws} "
            f"draws, {100 * self.proportion_correct:.1f} % correct; measure first: {first})"
        )


def sensitivity(
    icons: IconSet,
    rig: Rig,
    *,
    people: int = 24,
    seed: int = 0,
    draws: int | None = None,
    norm: str = USUAL_NORM,
    observer: ObserverModel | Path | str | None = None,
    progress: Progress | None = None,
) -> Sensitivity:
    """Find the constants that carry the doubt about a set, and the measurement that would reduce it most.

    Parameters
    ----------
    icons
        The set, at least two icons.
    rig
        The rig that plays it; its contact is uncertain as its own table of uncertainty says.
    people
        Virtual people of every draw.
    seed
        Seed of people, noise and draws: the same arguments give the same numbers.
    draws
        Draws of the posterior, at least 64 (None: 256, or as many as the observer has).
    norm
        What is remembered, as in `rank`.
    observer
        An observer or its file, as in `rank`; it needs draws.
    progress
        Called with (draws done, draws in all).

    Returns
    -------
    Sensitivity
        Constants and measurements, the most influential first.

    Raises
    ------
    ValueError
        For fewer than two icons, too few or too many draws, an observer without draws, and an unknown norm.

    See Also
    --------
    rank : Names the constants with the largest shares from the draws of its own interval.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> sensitivity(read_cue("six-icons"), Rig.load("thenar"), draws=3)
    Traceback (most recent call last):
    ...
    ValueError: a sensitivity needs 64 to 1000 draws of the posterior, not 3
    """
    from thermicon.circuit.solver.simulate import duration_s

    members, chosen, model = list(icons), check_norm(norm), ObserverModel.of(observer)
    if len(members) < 2:
        raise ValueError("a sensitivity needs at least two icons: one alone is never confused")
    if model.posterior is None:
        raise ValueError(f"{model.name} has no posterior draws, from which a sensitivity is read")
    if len(model.posterior) < FEWEST_DRAWS:
        raise ValueError(
            f"a sensitivity needs {FEWEST_DRAWS} draws of the posterior; {model.name} has {len(model.posterior)}"
        )
    draws = model.most_draws(DRAWS) if draws is None else draws
    if not FEWEST_DRAWS <= draws <= len(model.posterior):
        raise ValueError(
            f"a sensitivity needs {FEWEST_DRAWS} to {len(model.posterior)} draws of the posterior, not {draws}"
        )
    crowd = model.people(people, seed)
    end = run_end_s((duration_s(icon, rig) for icon in members), RATE_HZ)
    uncertain = UncertainRig.simulate(members, rig, crowd, end)
    shares = latin(2, draws, seed + 1)
    each = laboratory_draws(
        lambda place: uncertain.played(*shares[place].tolist()),
        crowd,
        chosen,
        model,
        draws=draws,
        seed=seed,
        step=step_counter(progress, draws),
    )
    columns = [
        [parameter.at(float(share)) for share in column]
        for parameter, column in zip(uncertain.parameters, shares.T, strict=True)
    ]
    acting = np.flatnonzero(each.acts)
    names = (*(each.names[k] for k in acting), *(parameter.name for parameter in uncertain.parameters))
    values = np.hstack([each.values[:, acting], np.array(columns).T])
    low, middle, high = np.percentile(each.proportion_correct, [2.5, 50.0, 97.5]).tolist()
    return Sensitivity(
        rig=rig.name,
        rig_changes=tuple(rig.changes),
        people=people,
        seed=seed,
        norm=chosen,
        draws=draws,
        observer=model.name,
        proportion_correct=middle,
        information_bits=float(np.median(each.information_bits)),
        proportion_correct_interval=(low, high),
        effects=_effects(names, values, each, model),
        reductions=_reductions(names, values, each),
    )


def _effects(names: tuple[str, ...], values: Array, each: LaboratoryDraws, model: ObserverModel) -> tuple[Effect, ...]:
    units = {base_name(record.quantity): record.unit for record in model.records}
    correct, bits = explained(values, each.proportion_correct), explained(values, each.information_bits)
    found = []
    for place, name in enumerate(names):
        low, high = np.percentile(values[:, place], [2.5, 97.5]).tolist()
        scores = scores_of(values[:, place])
        design = np.stack([np.ones_like(scores), scores, scores**2], axis=1)
        fitted = design @ np.linalg.lstsq(design, each.proportion_correct, rcond=None)[0]
        order = np.argsort(values[:, place], kind="stable")
        ends = fitted[order[[round(0.025 * (len(order) - 1)), round(0.975 * (len(order) - 1))]]].tolist()
        unit = units.get(base_name(name).removeprefix("cold ").removeprefix("warm "), "")
        found.append(Effect(name, unit, low, high, float(correct[place]), float(bits[place]), *ends))
    return tuple(sorted(found, key=lambda e: (-e.proportion_correct, -e.information_bits, e.constant)))


def _reductions(names: tuple[str, ...], values: Array, each: LaboratoryDraws) -> tuple[Reduction, ...]:
    found = []
    for measurement in MEASUREMENTS:
        places = [k for k, name in enumerate(names) if base_name(name) in measurement.constants]
        if places:
            shares = (
                explained_together(values[:, places], what) for what in (each.proportion_correct, each.information_bits)
            )
            found.append(Reduction(measurement.text, tuple(names[k] for k in places), *shares))
    return tuple(sorted(found, key=lambda r: (-r.proportion_correct, r.measurement)))
