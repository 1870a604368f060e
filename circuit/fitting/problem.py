"""The least-squares problem of a fit.

Fitted along with the keys are the zero of every temperature sensor, the distance of the sensors from the drive within a
row, shift and drift of every further clock and, unless left out, the layers of the skin.

Nobody's skin is that of the rig file: the prior of a factor of its layers is the spread between people. A layer a
times as thick keeps its mesh: it gets 1/a of the conductivity, and a times the density and perfusion, which is the same
to a log. Scales are fitted as logarithms, so that they stay positive.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from thermicon.base.files.records import shipped_records
from thermicon.base.numbers.arrays import Array

from ..rig.rig import Rig
from ..rig.rigfile import RigError
from .forward import Prediction, predict, start_sd_K
from .keys import FitError, FitKey, value_of
from .runs import DISPLAY, Channel, Run
from .whiten import CommonErrors, shared

OFFSET_SD_K = 0.1
"""Standard deviation of a thermistor's zero: interchangeable ones are sold as ±0.1 to ±0.2 K."""

STEP_LOG, STEP_LINEAR = 1e-3, 5e-3
"""Steps of derivatives: 0.1 % of a scale, 5 mK or 5 ms of the others."""

SHIFT_ROOM_S, DRIFT_SD = 5.0, 0.02
"""How far a clock may be from where the correlation puts it, and how fast (standard deviation)."""

ROW_SHARE = 0.5
"""A row's temperature may belong half a row earlier or later than its drive (standard deviation): a logged current is
held from its row on, lasted until it, or is a mean."""

PHASES = 4.0
"""Standard deviations of what one phase makes wrong, within which a fit looks for it."""

IMPOSSIBLE = 1e3
"""Residual, in standard deviations, of a rig that cannot exist: the fit turns back."""


THICKNESS, CONDUCTIVITY, CAPACITY = LAYER_KINDS = ("thickness", "conductivity", "heat capacity")
"""What differs of a layer; the last is per volume."""

FINE_ELEMENTS = 40
"""Elements per layer of the skin that the mesh is compared with: within 0.5 mK of more, where the mesh is off by 2."""

Factors = Mapping[tuple[str, int], float]
"""Logarithms of factors by kind and layer."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """One number of a fit: a key of the rig, a scale as its logarithm, or something fitted along with the keys.

    A kind is key, offset, row, phase, start, shift, drift, one of LAYER_KINDS, whose place is the layer, or, where a
    column is tried to be late, late. The fit begins at `first` and stays between `low` and `high`; `sd` is that of the
    prior about 0, of a key, which has none, a usual change; `step` is that of the derivative.
    """

    kind: str
    run: int
    place: int
    sd: float
    first: float = 0.0
    low: float = -1e3
    high: float = 1e3
    step: float = STEP_LINEAR


@dataclass(slots=True, eq=False)
class FitProblem:
    """A rig, its free keys and the runs; a point is `theta`, a number for each of `unknowns`, the keys first."""

    rig: Rig
    keys: tuple[FitKey, ...]
    runs: tuple[Run, ...]
    offset_sd_K: float
    fixed_skin: bool
    unknowns: tuple[Unknown, ...]
    _kept: dict[bytes, tuple[Prediction, ...]] = field(init=False, default_factory=dict)
    _shared: list[CommonErrors | None] = field(init=False, default_factory=list)

    @staticmethod
    def of(
        rig: Rig,
        keys: tuple[FitKey, ...],
        runs: tuple[Run, ...],
        offset_sd_K: float = OFFSET_SD_K,
        fixed_skin: bool = False,
    ) -> FitProblem:
        """Return the problem of fitting keys of a rig to runs, beginning at the rig's own values."""
        layers = {} if fixed_skin else layer_priors(rig)
        unknowns = (
            *(_key(rig, key, place) for place, key in enumerate(keys)),
            *_along(runs, offset_sd_K),
            *(Unknown(kind, 0, k, sd, low=-1.0, high=1.0, step=STEP_LOG) for (kind, k), sd in layers.items()),
        )
        return FitProblem(rig, keys, runs, offset_sd_K, fixed_skin, unknowns)

    @property
    def first(self) -> Array:
        """Starting point of the fit (unknowns,)."""
        return np.array([item.first for item in self.unknowns])

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Between which numbers the fit stays, each (unknowns,)."""
        return np.array([item.low for item in self.unknowns]), np.array([item.high for item in self.unknowns])

    @property
    def alone(self) -> bool:
        """Whether no run has a known current, so that the display is the drive."""
        return all(run.driven_by == DISPLAY for run in self.runs)

    def again(self, rig: Rig, keys: tuple[FitKey, ...], runs: tuple[Run, ...]) -> FitProblem:
        """Another rig, keys or runs, with the same fitted along."""
        return FitProblem.of(rig, keys, runs, self.offset_sd_K, self.fixed_skin)

    def values(self, theta: Array) -> dict[str, float]:
        """Values of the free keys in the units of the rig file."""
        pairs = zip(self.keys, theta.tolist(), strict=False)
        return {key.key: math.exp(place) if key.log else place for key, place in pairs}

    def factors(self, theta: Array) -> Factors:
        """Logarithms of what the layers of the skin are multiplied by; empty where they are not fitted along."""
        all_ = zip(self.unknowns, theta, strict=True)
        return {(item.kind, item.place): float(value) for item, value in all_ if item.kind in LAYER_KINDS}

    def simulated(self, theta: Array) -> tuple[Prediction, ...]:
        """All runs at a point; raises RigError where the rig cannot exist. Depends on keys and skin alone."""
        moving = [k for k, item in enumerate(self.unknowns) if item.kind in ("key", "phase", "start", *LAYER_KINDS)]
        token = theta[moving].tobytes()
        if token not in self._kept:
            if len(self._kept) > 4 * (len(moving) + 1):
                self._kept.clear()
            rig = self.rig.with_(**self.values(theta), **changed_layers(self.rig, self.factors(theta)))
            self._kept[token] = tuple(
                predict(rig, run, *(self.nuisance(theta, kind, r, 0) for kind in ("phase", "start")))
                for r, run in enumerate(self.runs)
            )
        return self._kept[token]

    def predictions(self, theta: Array) -> tuple[Prediction, ...] | None:
        """All runs at a point; None where the rig cannot exist."""
        try:
            return self.simulated(theta)
        except RigError:
            return None

    def nuisance(self, theta: Array, kind: str, run: int, place: int) -> float:
        """Value of what is fitted along, 0 where it is not."""
        for item, value in zip(self.unknowns, theta, strict=True):
            if (item.kind, item.run, item.place) == (kind, run, place):
                return float(value)
        return 0.0

    def run_time_s(self, theta: Array, run: int, channel: Channel) -> Array:
        """Times of a channel's rows on the clock of its run's drive, from the first row of the drive."""
        time = channel.time_s - self.runs[run].begin_s
        if not channel.clock:
            return time
        shift, drift = (self.nuisance(theta, kind, run, channel.clock) for kind in ("shift", "drift"))
        return np.asarray(time + self.runs[run].shifts[channel.clock - 1] + shift + drift * (time - time[0]))

    def modelled(self, theta: Array, run: int, place: int, rows: Prediction) -> Array:
        """Predicted readings of a channel at its rows: the simulation on its clock, with its sensor's offset."""
        channel = self.runs[run].channels[place]
        row = 0.0 if channel.clock else self.nuisance(theta, "row", run, 0)
        late = self.nuisance(theta, "late", run, place)
        values = rows.at(channel.column, self.run_time_s(theta, run, channel) - late, row)
        return values + self.nuisance(theta, "offset", run, place)

    def inside(self, theta: Array, run: int, channel: Channel) -> Array:
        """Rows (rows,) of a channel that lie within its run."""
        time = self.run_time_s(theta, run, channel)
        return np.asarray((time >= -1e-9) & (time <= self.runs[run].time_s[-1] + 1e-9))

    def channels(self) -> list[tuple[int, int, Channel]]:
        """Every channel with the places of its run and of itself."""
        return [(r, c, channel) for r, run in enumerate(self.runs) for c, channel in enumerate(run.channels)]

    def residuals(self, theta: Array, sigma: Sequence[float]) -> Array:
        """Simulated minus measured, 0 outside of runs, then what is fitted along, in SDs of noise and priors."""
        found, along = self.predictions(theta), self.unknowns[len(self.keys) :]
        if found is None:
            count = sum(len(channel.values) for _, _, channel in self.channels())
            return np.full(count + len(along), IMPOSSIBLE)
        parts = [
            np.where(self.inside(theta, r, channel), self.modelled(theta, r, c, found[r]) - channel.values, 0.0)
            for r, c, channel in self.channels()
        ]
        prior = [value / item.sd for item, value in zip(along, theta[len(self.keys) :], strict=True)]
        return np.concatenate([*self._independent(parts, tuple(sigma)), np.array(prior)])

    def _independent(self, parts: Sequence[Array], sigma: tuple[float, ...]) -> list[Array]:
        """Differences in SDs of their noise, made independent where the drive is unknown between rows."""
        if not self._shared:
            for r, run in enumerate(self.runs):
                times = [self.run_time_s(self.first, r, channel) for channel in run.channels]
                self._shared.append(shared(self.rig, run, times))
        out = list[Array]()
        for alike, run in zip(self._shared, self.runs, strict=True):
            mine = slice(len(out), len(out) + len(run.channels))
            pairs = zip(parts[mine], sigma[mine], strict=True)
            out += [part / sd for part, sd in pairs] if alike is None else alike.independent(parts[mine], sigma[mine])
        return out

    def jacobian(self, theta: Array, sigma: Sequence[float]) -> Array:
        """Derivatives of `residuals`, by differences forward (backward at an upper bound)."""
        base = self.residuals(theta, sigma)
        out = np.empty((len(base), len(theta)))
        for k, item in enumerate(self.unknowns):
            step = -item.step if theta[k] + item.step > item.high else item.step
            moved = theta.copy()
            moved[k] += step
            out[:, k] = (self.residuals(moved, sigma) - base) / step
        return out

    def with_unknown(self, item: Unknown) -> FitProblem:
        """The problem with something more fitted along that changes how a run is read, and not the run."""
        wide = replace(self, unknowns=(*self.unknowns, item))
        wide._kept, wide._shared = self._kept, self._shared
        return wide

    def mesh_error(self, theta: Array, sigma: Sequence[float]) -> Array:
        """Change of `residuals` with a fine mesh of the skin; nothing where the rig states its elements."""
        skin, here = self.rig.skin, self.residuals(theta, sigma)
        if skin.elements is not None:
            return 0.0 * here
        other = replace(self, rig=self.rig.with_(**{"skin.elements": [FINE_ELEMENTS] * len(skin.layers)}))
        other._shared = self._shared
        return other.residuals(theta, sigma) - here


def _key(rig: Rig, key: FitKey, place: int) -> Unknown:
    value = value_of(rig, key.key)
    if value is None:
        raise FitError(f"{key.key}: rig {rig.name} does not give it, so that there is no value to begin from")
    if key.log:
        first, room = math.log(value), math.log(key.room)
        return Unknown("key", 0, place, 0.1, first, first - room, first + room, STEP_LOG)
    low = 0.0 if key.key.endswith("_s") else value - key.room
    return Unknown("key", 0, place, 1.0, value, low, value + key.room)


def _along(runs: Sequence[Run], offset_sd_K: float) -> list[Unknown]:
    """Place within the row, clocks and offsets of every run."""
    extra = []
    for r, run in enumerate(runs):
        if any(not channel.clock for channel in run.channels):
            extra.append(Unknown("row", r, 0, ROW_SHARE * run.step_s, step=1e-3))
        if run.phase is not None:
            extra.append(Unknown("phase", r, 0, 1.0, low=-PHASES, high=PHASES, step=1e-2))
        if run.start_C is not None:
            extra.append(Unknown("start", r, 0, start_sd_K(offset_sd_K)))
        for clock in range(1, len(run.clocks) + 1):
            extra += [
                Unknown("shift", r, clock, SHIFT_ROOM_S, low=-SHIFT_ROOM_S, high=SHIFT_ROOM_S),
                Unknown("drift", r, clock, DRIFT_SD, low=-0.2, high=0.2, step=1e-6),
            ]
        if offset_sd_K > 0:
            sd = offset_sd_K * (np.sqrt(2.0) if run.driven_by == DISPLAY else 1.0)  # its display is off, too
            extra += [Unknown("offset", r, c, sd) for c, channel in enumerate(run.channels) if channel.temperature]
    return extra


def layer_priors(rig: Rig) -> dict[tuple[str, int], float]:
    """Return the standard deviation of the logarithm of every layer's factors."""
    known = {record.quantity: math.log1p(record.central) for record in shipped_records("skin-spread.toml")}
    priors = {(kind, k): known[f"layer {kind} spread"] for k in range(len(rig.skin.layers)) for kind in LAYER_KINDS}
    return {**priors, (THICKNESS, 0): known["outermost layer thickness spread"]}


def changed_layers(rig: Rig, factors: Factors) -> dict[str, float]:
    """Return keys of the rig for its layers times factors, at the thickness that they have; none without factors."""
    changes = {}
    for k, layer in enumerate(rig.skin.layers if factors else ()):
        thicker, better, heavier = (math.exp(factors.get((kind, k), 0.0)) for kind in LAYER_KINDS)
        changes[f"skin.layer.{k}.conductivity_W_per_mK"] = layer.conductivity_W_per_mK * better / thicker
        changes[f"skin.layer.{k}.density_kg_per_m3"] = layer.density_kg_per_m3 * heavier * thicker
        changes[f"skin.layer.{k}.perfusion_per_s"] = layer.perfusion_per_s * thicker
    return changes
