"""The sensitivity of a prediction to each constant.

The set is predicted with draws of the posterior as a new laboratory would see it, contact and outermost skin layer
included. Constants that take no part in the set on its rig are left out. Constants of one draw belong together, so that
shares of constants that trade off overlap and need not add up to 1; the share of a measurement is what its constants
explain together.

No posterior knows of contact and outermost layer. Both are simulated at three values each; in between, temperatures are
those of the parabolas through them, so that hundreds of draws cost nine simulations.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import product
from typing import Any, Unpack

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.arrays import Array
from thermicon.base.results.drawn import Drawn, Tabled
from thermicon.circuit.rig.rig import AnyRig, Rig
from thermicon.icons import Icon
from thermicon.icons.files.shipped import Icons, set_of

from ..identification.depths import rungs
from ..identification.laboratory_draws import LaboratoryDraws, Uncertain, laboratory_draws, latin
from ..identification.population import ReceptorTemperatures, run_end_s
from ..kernels.parallel import Progress, step_counter
from ..observer.constants import quantity_of
from ..observer.observer import DATA, Observer
from ..observer.observer_model import Crowd, CrowdWords, ObserverModel
from ..observer.people import People, people_records
from .assumptions import explained, explained_together, scores_of
from .ranking import with_changes

RATE_HZ = 12.5
"""As draws are judged for the intervals of a new laboratory."""
NODES = (0.0, 0.5, 1.0)
CONTACT, LAYER = "contact resistance", "thickness of the outermost layer"
DRAWS = 256
FEW = Crowd(people=24)
FEWEST_DRAWS = 64
"""Of fewer draws a share of some per cent is not distinguishable from chance."""
NOTEWORTHY = 0.02
"""Measurements that would take away less of the variance are not named as the first to make."""


def load_measurements(of_pilots: bool = False) -> Mapping[str, tuple[str, ...]]:
    """Measurements of a laboratory, or those that a pilot takes, with the constants, by name, that each determines."""
    rows = tomllib.loads((DATA / "measurements.toml").read_text("utf-8"))["measurement"]
    return {row["text"]: tuple(row["constants"]) for row in rows if not of_pilots or row.get("pilot")}


def base_name(constant: str) -> str:
    """A constant without the form of memory that its value belongs to.

    >>> base_name("memory noise (episodes)")
    'memory noise'
    """
    return constant.split(" (")[0]


@dataclass(frozen=True, slots=True)
class UncertainRig:
    """Contact and layer as intervals, and the simulations between which others are interpolated.

    `grid` holds temperatures in °C, shape (contact · layer, channel, depths, people, icons, n_time), and `like` what
    does not depend on the two. Shares are of each interval, 0–1; the rig as it is has 0.5 of both.
    """

    parameters: tuple[Uncertain, Uncertain]
    grid: Array
    like: ReceptorTemperatures
    outer_layer: Array

    @classmethod
    def simulate(
        cls, icons: Sequence[Icon], rig: Rig, people: People, end_s: float, observers: Sequence[Observer],
        tracking: str | None = None,
    ) -> UncertainRig:  # fmt: skip
        """Simulate every icon for each person at the nodes, with the currents that are designed on the rig as it is."""
        resistance, layer_mm = rig.contact.resistance_m2K_per_W, rig.skin.layers[0].thickness_m * 1e3
        by = 1.0 + rig.uncertainty.contact_resistance_relative
        other = 1.0 + people_records()["outer_layer"].central  # one person's spread
        contact = Uncertain(CONTACT, resistance / by, resistance * by)
        layer = Uncertain(LAYER, layer_mm / other, layer_mm * other)
        ends = np.outer([1.0 / other, other], people.corneum_m(rig))
        depths, grid = rungs(observers, ends), []
        for share, place in product(NODES, NODES):
            keys = {"contact.resistance_m2K_per_W": contact.at(share), "skin.layer.0.thickness_mm": layer.at(place)}
            met = rig.with_(**keys)
            how = depths, end_s, RATE_HZ, tracking
            played = ReceptorTemperatures.at_depths(icons, people, met, *how, designed_on=rig)
            grid.append(np.stack(played.rungs_C))
        return cls((contact, layer), np.stack(grid), played, people.outer_layer)

    def played(self, contact: float, layer: float) -> ReceptorTemperatures:
        """Temperatures of the receptors for a contact and an outermost layer, as shares of their intervals."""
        weights = np.outer(_parabola(contact), _parabola(layer)).reshape(-1)
        cold, warm = (weights @ self.grid.reshape(weights.size, -1)).reshape(self.grid.shape[1:])
        corneum_m = self.outer_layer * (1e-3 * self.parameters[1].at(layer)) * (self.like.corneum_m > 0.0)
        return replace(self.like, rungs_C=(cold, warm), corneum_m=corneum_m)


def _parabola(share: float) -> Array:
    """Weights of the three nodes in the parabola through them."""
    return np.array([2.0 * (share - 0.5) * (share - 1.0), 4.0 * share * (1.0 - share), 2.0 * share * (share - 0.5)])


@dataclass(frozen=True, slots=True)
class Effect:
    """Influence of one constant, whose draws have their 95 % interval from `low` to `high` in its `unit`.

    `proportion_correct` and `information_bits` are the share (0–1) of the variance of each over draws that would go if
    the constant were known, `at_low` and `at_high` the proportion named to be expected at both ends.
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
class Sensitivity(Drawn, Tabled):
    """Effects of constants, and reductions by measurements, on a prediction; the largest first.

    The prediction is the median over draws (0–1, and bits) and the 95 % of them, for a new laboratory; contact and skin
    layer of the rig are uncertain.
    """

    rig: str
    rig_changes: tuple[str, ...]
    people: int
    seed: int
    memory: str
    draws: int
    observer: str
    proportion_correct: float
    information_bits: float
    proportion_correct_interval: tuple[float, float]
    effects: tuple[Effect, ...]
    reductions: tuple[Reduction, ...]

    @property
    def first(self) -> tuple[Reduction, ...]:
        """Measurements that would take away at least 2 % of the variance of the proportion named."""
        return tuple(each for each in self.reductions if each.proportion_correct >= NOTEWORTHY)

    def rows(self) -> list[dict[str, Any]]:
        """One row per constant, the largest effect first."""
        return [asdict(effect) for effect in self.effects]

    def __repr__(self) -> str:
        first = self.first[0].measurement if self.first else "nothing"
        return (
            f"Sensitivity({len(self.effects)} constants on {with_changes(self.rig, self.rig_changes)}, {self.draws} "
            f"draws, {100 * self.proportion_correct:.1f} % named; measure first: {first})"
        )


@checked
def sensitivity(
    icons: Icons,
    rig: AnyRig = None,
    *,
    crowd: Crowd = FEW,
    draws: int | None = None,
    progress: Progress | None = None,
    **words: Unpack[CrowdWords],
) -> Sensitivity:
    """Find the constants that carry the doubt about a set, and the measurement that would reduce it most.

    The set needs at least two icons; the contact of the rig is uncertain as its own table of uncertainty says. `crowd`,
    or words of it, is as in `rank`, but with 24 people, those of every draw; an observer without draws is refused.
    `draws` are those of the posterior, at least 64 (None: 256, or as many as the observer has). `progress` is called
    with (draws done, draws in all).

    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> sensitivity(read_cue("six-icons"), Rig.load("thenar"), draws=3)
    Traceback (most recent call last):
    ...
    thermicon.base.checks.arguments.InputError: sensitivity: a sensitivity needs 64 to 1000 draws of the posterior, ...
    """
    from thermicon.circuit.solver.simulate import duration_s

    icons, crowd = set_of(icons), crowd.but(**words)
    rig, members, model, seed = Rig.of(rig, icons.context.site), list(icons), crowd.model, crowd.seed
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
    people = model.people(crowd.people, seed)
    end = run_end_s((duration_s(icon, rig) for icon in members), RATE_HZ)
    uncertain = UncertainRig.simulate(members, rig, people, end, model.some_draws(draws), crowd.tracking)
    shares = latin(2, draws, seed + 1)
    step, played = step_counter(progress, draws), lambda place: uncertain.played(*shares[place].tolist())
    each = laboratory_draws(played, people, crowd.memory, model, draws=draws, seed=seed, step=step)
    pairs = zip(uncertain.parameters, shares.T.tolist(), strict=True)
    columns = [[parameter.at(share) for share in column] for parameter, column in pairs]
    acting = np.flatnonzero(each.acting())
    names = (*(each.names[k] for k in acting), *(parameter.name for parameter in uncertain.parameters))
    values = np.hstack([each.values[:, acting], np.array(columns).T])
    low, middle, high = np.percentile(each.proportion_correct, [2.5, 50.0, 97.5]).tolist()
    reductions = []
    for measurement, constants in load_measurements().items():
        places = [k for k, name in enumerate(names) if base_name(name) in constants]
        if places:
            scores = (each.proportion_correct, each.information_bits)
            left = (explained_together(values[:, places], what) for what in scores)
            reductions.append(Reduction(measurement, tuple(names[k] for k in places), *left))
    return Sensitivity(
        rig=rig.name,
        rig_changes=tuple(rig.changes),
        people=crowd.people,
        seed=seed,
        memory=crowd.memory,
        draws=draws,
        observer=model.name,
        proportion_correct=middle,
        information_bits=float(np.median(each.information_bits)),
        proportion_correct_interval=(low, high),
        effects=_effects(names, values, each, model),
        reductions=tuple(sorted(reductions, key=lambda r: (-r.proportion_correct, r.measurement))),
    )


def _effects(names: tuple[str, ...], values: Array, each: LaboratoryDraws, model: ObserverModel) -> tuple[Effect, ...]:
    units = {base_name(record.quantity): record.unit for record in model.records} | {CONTACT: "m²·K/W", LAYER: "mm"}
    correct, bits = explained(values, each.proportion_correct), explained(values, each.information_bits)
    found = []
    for place, name in enumerate(names):
        low, high = np.percentile(values[:, place], [2.5, 97.5]).tolist()
        scores = scores_of(values[:, place])
        design = np.stack([np.ones_like(scores), scores, scores**2], axis=1)
        fitted = design @ np.linalg.lstsq(design, each.proportion_correct, rcond=None)[0]
        order = np.argsort(values[:, place], kind="stable")
        ends = fitted[order[[round(0.025 * (len(order) - 1)), round(0.975 * (len(order) - 1))]]].tolist()
        unit = units.get(quantity_of(base_name(name))[1], "")
        found.append(Effect(name, unit, low, high, float(correct[place]), float(bits[place]), *ends))
    return tuple(sorted(found, key=lambda e: (-e.proportion_correct, -e.information_bits, e.constant)))
