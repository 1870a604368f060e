"""The fit as numbers: free keys and what is fitted along with them, residuals of all channels, and their derivatives.

Along with the keys go the zero of every temperature sensor, how far the sensors are from the drive within a row, shift
and drift of every further clock, unless left out the layers of the skin, and, on request, the state at the first row.
Scales are fitted as logarithms, so that they stay positive and intervals are relative.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..arrays import Array
from ..rig.rig import Rig
from ..rig.rigfile import RigError
from .forward import Prediction, Start, predict
from .keys import FitError, FitKey, value_of
from .runs import Channel, Run
from .skin_layers import LAYER_KINDS, Factors, changed_layers, finely_divided, layer_priors

OFFSET_SD_K = 0.1
"""Standard deviation of a thermistor's zero: interchangeable ones are sold as ±0.1 to ±0.2 K."""

STEP_LOG, STEP_LINEAR = 1e-3, 5e-3
"""Steps of derivatives: 0.1 % of a scale, 5 mK or 5 ms of the others."""

START_SD = (0.5, 2.0, 2.0, 2.0, 2.0)
SHIFT_SD_S, DRIFT_SD = 30.0, 0.02
"""How far a start may be from steady (current in A, display, hot plate, near and deep skin in K), and
clocks from each other, where the fit decides: standard deviations."""

STEADY, STEADY_BEFORE, FREE_START = 0, 1, len(START_SD)
"""How many of these are fitted: none where a run begins steady under its first row's drive, the current alone where it
was steady under another, all where it was not steady."""

ROW_SHARE = 0.5
"""A row's temperature may belong half a row earlier or later than its drive (standard deviation): a logged current is
held from its row on, lasted until it, or is a mean."""

IMPOSSIBLE = 1e3
"""Residual, in standard deviations, of a rig that cannot exist: the fit turns back."""


@dataclass(frozen=True, slots=True)
class Nuisance:
    """Something fitted along with the keys: its `kind`, run, place and prior SD.

    A kind is offset, row, shift, drift, start, one of LAYER_KINDS, whose place is the layer, or, where a column is
    tried to be late, late.
    """

    kind: str
    run: int
    place: int
    sd: float


@dataclass(slots=True, eq=False)
class Problem:
    """A rig, its free keys and the runs; a point is `theta`: the keys (scales as logarithms), then the nuisances."""

    rig: Rig
    keys: tuple[FitKey, ...]
    runs: tuple[Run, ...]
    start_count: int
    offset_sd_K: float
    fixed_skin: bool
    first: Array
    low: Array
    high: Array
    nuisances: tuple[Nuisance, ...]
    _kept: dict[bytes, tuple[Prediction, ...] | None] = field(default_factory=dict)

    @staticmethod
    def of(
        rig: Rig,
        keys: tuple[FitKey, ...],
        runs: tuple[Run, ...],
        start_count: int = STEADY,
        offset_sd_K: float = OFFSET_SD_K,
        fixed_skin: bool = False,
    ) -> Problem:
        """Return the problem of fitting keys of a rig to runs, beginning at the rig's own values."""
        values = np.array([_begin(rig, key) for key in keys])
        log = np.array([key.log for key in keys])
        room = np.array([math.log(key.room) if key.log else key.room for key in keys])
        low = values - room
        low[~log & np.array([key.key.endswith("_s") for key in keys])] = 0.0
        layers = {} if fixed_skin else layer_priors(rig)
        skin = [Nuisance(kind, 0, k, sd) for (kind, k), sd in layers.items()]
        extra = (*_nuisances(runs, start_count, offset_sd_K), *skin)
        limit = np.array([0.2 if item.kind == "drift" else 1.0 if item.kind in LAYER_KINDS else 1e3 for item in extra])
        return Problem(
            rig, keys, runs, start_count, offset_sd_K, fixed_skin, np.concatenate([values, np.zeros(len(extra))]),
            np.concatenate([low, -limit]), np.concatenate([values + room, limit]), extra,
        )  # fmt: skip

    def again(self, rig: Rig, keys: tuple[FitKey, ...], runs: tuple[Run, ...]) -> Problem:
        """Another rig, keys or runs, with the same fitted along."""
        return Problem.of(rig, keys, runs, self.start_count, self.offset_sd_K, self.fixed_skin)

    def values(self, theta: Array) -> dict[str, float]:
        """Values of the free keys in the units of the rig file."""
        return {
            key.key: float(math.exp(place)) if key.log else float(place)
            for key, place in zip(self.keys, theta, strict=False)
        }

    def rig_at(self, theta: Array) -> Rig:
        """The rig at a point; raises RigError where no rig file may have these values."""
        return self.rig.with_(**self.values(theta), **changed_layers(self.rig, self.factors(theta)))

    def factors(self, theta: Array) -> Factors:
        """Logarithms of what the layers of the skin are multiplied by; empty where they are not fitted along."""
        extra = zip(self.nuisances, theta[len(self.keys) :], strict=True)
        return {(item.kind, item.place): float(value) for item, value in extra if item.kind in LAYER_KINDS}

    def predictions(self, theta: Array) -> tuple[Prediction, ...] | None:
        """All runs at a point; None where the rig cannot exist. Depends on keys, skin and starts alone."""
        count = len(self.keys)
        moving = [k for k, item in enumerate(self.nuisances, count) if item.kind in ("start", *LAYER_KINDS)]
        token = np.concatenate([theta[:count], theta[moving]]).tobytes()
        if token not in self._kept:
            if len(self._kept) > 4 * (count + len(moving) + 1):
                self._kept.clear()
            self._kept[token] = self._simulate(theta)
        return self._kept[token]

    def _simulate(self, theta: Array) -> tuple[Prediction, ...] | None:
        try:
            rig = self.rig_at(theta)
            return tuple(predict(rig, run, self.start(theta, k)) for k, run in enumerate(self.runs))
        except RigError:
            return None

    def nuisance(self, theta: Array, kind: str, run: int, place: int) -> float:
        """Value of what is fitted along, 0 where it is not."""
        for item, value in zip(self.nuisances, theta[len(self.keys) :], strict=True):
            if (item.kind, item.run, item.place) == (kind, run, place):
                return float(value)
        return 0.0

    def start(self, theta: Array, run: int) -> Start | None:
        """How far a run's start is from steady in K; None where it is taken as steady."""
        if not self.start_count:
            return None
        current, display, hot, near, deep = (self.nuisance(theta, "start", run, k) for k in range(len(START_SD)))
        return current, display, hot, near, deep

    def run_time_s(self, theta: Array, run: int, channel: Channel) -> Array:
        """Times of a channel's rows on the clock of its run's drive, from the first row of the drive."""
        time = channel.time_s - self.runs[run].begin_s
        if not channel.clock:
            return time
        shift, drift = (self.nuisance(theta, kind, run, channel.clock) for kind in ("shift", "drift"))
        return np.asarray(time + shift + drift * (time - time[0]))

    def modelled(self, theta: Array, run: int, place: int, rows: Prediction) -> Array:
        """What a channel should read at its rows: the simulation on its clock, with its sensor's offset."""
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
        """Simulated minus measured in standard deviations, all channels, then the nuisances in those of their priors.

        Rows outside their run are 0.
        """
        found = self.predictions(theta)
        if found is None:
            count = sum(len(channel.values) for _, _, channel in self.channels())
            return np.full(count + len(self.nuisances), IMPOSSIBLE)
        parts = [
            np.where(self.inside(theta, r, channel), (self.modelled(theta, r, c, found[r]) - channel.values) / sd, 0.0)
            for (r, c, channel), sd in zip(self.channels(), sigma, strict=True)
        ]
        prior = [value / item.sd for item, value in zip(self.nuisances, theta[len(self.keys) :], strict=True)]
        return np.concatenate([*parts, np.array(prior)])

    def jacobian(self, theta: Array, sigma: Sequence[float]) -> Array:
        """Derivatives of `residuals`, by differences forward (backward at an upper bound)."""
        base = self.residuals(theta, sigma)
        out = np.empty((len(base), len(theta)))
        for k in range(len(theta)):
            step = self.step(k)
            if theta[k] + step > self.high[k]:
                step = -step
            moved = theta.copy()
            moved[k] += step
            out[:, k] = (self.residuals(moved, sigma) - base) / step
        return out

    def with_nuisance(self, item: Nuisance, room: float) -> Problem:
        """The problem with something more fitted along, within ±`room` of 0."""
        ends = (np.append(values, value) for values, value in ((self.first, 0.0), (self.low, -room), (self.high, room)))
        first, low, high = ends
        return replace(self, nuisances=(*self.nuisances, item), first=first, low=low, high=high, _kept={})

    def mesh_error(self, theta: Array, sigma: Sequence[float]) -> Array:
        """What a fine mesh of the skin would change in `residuals`."""
        fine = finely_divided(self.rig)
        if fine is None:
            return np.zeros(sum(len(channel.values) for _, _, channel in self.channels()) + len(self.nuisances))
        return replace(self, rig=fine, _kept={}).residuals(theta, sigma) - self.residuals(theta, sigma)

    def step(self, place: int) -> float:
        """Step of the derivative by a parameter."""
        if place < len(self.keys):
            return STEP_LOG if self.keys[place].log else STEP_LINEAR
        return {"drift": 1e-6, "row": 1e-3, **dict.fromkeys(LAYER_KINDS, STEP_LOG)}.get(
            self.nuisances[place - len(self.keys)].kind, STEP_LINEAR
        )


def _begin(rig: Rig, key: FitKey) -> float:
    value = value_of(rig, key.key)
    if value is None:
        raise FitError(f"{key.key}: rig {rig.name} does not give it, so that there is no value to begin from")
    return math.log(value) if key.log else value


def _nuisances(runs: Sequence[Run], start_count: int, offset_sd_K: float) -> list[Nuisance]:
    extra = []
    for r, run in enumerate(runs):
        if start_count and run.driven_by not in ("setpoint_C", "display_C"):
            extra += [Nuisance("start", r, place, sd) for place, sd in enumerate(START_SD[:start_count])]
        if any(not channel.clock for channel in run.channels):
            extra.append(Nuisance("row", r, 0, ROW_SHARE * float(np.median(np.diff(run.time_s)))))
        for clock in range(1, len(run.clocks) + 1):
            extra += [Nuisance("shift", r, clock, SHIFT_SD_S), Nuisance("drift", r, clock, DRIFT_SD)]
        if offset_sd_K > 0:
            extra += [
                Nuisance("offset", r, c, offset_sd_K) for c, channel in enumerate(run.channels) if channel.temperature
            ]
    return extra
