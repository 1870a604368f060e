"""Loads of a layout's elements from their delivered drives in every corner of their rigs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.icons.model.statements import Rest

from ..safety.ensemble import Ensemble, LaneDrives
from ..safety.plant import RECOVERED_K
from ..safety.tally import WATCHED
from ..safety.whole import STEP_S, Icons, Load
from ..solver.drive import Drive
from .controlled import BESIDE_K
from .delivered_drive import ModuleDrive
from .prepare import Prepared
from .temperatures import FollowingModule
from .worstcase import ways_of


def loads_of(channels: Sequence[Sequence[Prepared]]) -> Icons:
    """The load of each element in each icon, all of one icon with as many rows; what plays alike is computed once."""
    known: dict[int, Load] = {}
    icons = []
    for icon in zip(*channels, strict=True):
        for one in icon:
            if id(one.verdict) not in known:
                known[id(one.verdict)] = load_of(one)
        loads = [known[id(one.verdict)] for one in icon]
        rows = max(len(load.warm_C) for load in loads)
        icons.append([_until(load, rows) for load in loads])
    return icons


def load_of(one: Prepared) -> Load:
    """The load of one element in one icon."""
    delivery, demands = one.delivery, one.verdict.demands
    cut = demands.cut_off_display_C
    plays = any(not isinstance(statement, Rest) for statement in delivery.icon.statements)
    if not isinstance(delivery, ModuleDrive):
        ways = [
            (way.step_s * np.arange(len(way.display_C), dtype=np.float64), way.display_C) for way in ways_of(delivery)
        ]
        displays = [_binned(times, np.stack([display, -display])) for times, display in ways]
        rows = max(display.shape[1] for display in displays)
        both = np.max([np.pad(display, ((0, 0), (0, rows - display.shape[1])), mode="edge") for display in displays], 0)
        nothing = np.zeros(rows)
        return _load(plays, both, both[:, 0], (nothing, nothing), (0.0, 0.0), (cut.low, cut.high))
    ensemble, drive, bridge_A = _in_corners(delivery)
    times, values = _played(ensemble, drive)
    display_C, hotter_K = values[WATCHED.index("display_C")], values[WATCHED.index("hot_plate_C")]
    hotter_K = hotter_K - display_C
    current_A = _in_force(drive, times) * ensemble.gain[:, np.newaxis]
    if bridge_A is not None:
        current_A = np.sign(current_A) * bridge_A * ensemble.gain[:, np.newaxis]
    seebeck = np.array([corner.rig.module.seebeck_V_per_K for corner in ensemble.corners])[:, np.newaxis]
    ohm = delivery.rig.module.resistance_ohm
    power_W = np.maximum(0.0, current_A * (seebeck * hotter_K + ohm * current_A))
    driver, limits_A = delivery.rig.driver, demands.current_limit_A
    ends_A = limits_A or ((driver.current_min_A, driver.current_max_A) if bridge_A is None else (-bridge_A, bridge_A))
    stuck_A = max(map(abs, ends_A)) * float(ensemble.gain.max())
    stuck_W = stuck_A * (float((seebeck * np.abs(hotter_K)).max()) + ohm * stuck_A)
    beside_K = BESIDE_K if delivery.device.kind.regulated else 0.0
    worst = np.stack(
        [np.abs(current_A).max(axis=0), power_W.max(axis=0), display_C.max(axis=0), (-display_C).max(axis=0)]
    )
    drawn_A, drawn_W, *both = _binned(times, worst)
    nominal = _binned(times, np.stack([display_C[0], -display_C[0]]))
    extremes = np.stack(both) + beside_K
    return _load(plays, nominal, nominal[:, 0], (drawn_A, drawn_W), (stuck_A, stuck_W), (cut.low, cut.high), extremes)


def _load(
    plays: bool,
    nominal: Array,
    rest: Array,
    drawn: tuple[Array, Array],
    stuck: tuple[float, float],
    cut_C: tuple[float, float],
    extremes: Array | None = None,
) -> Load:
    """A load whose display counts, at its `extremes`, while the `nominal` one (2, rows), ±°C, is away from its rest."""
    away = np.where(nominal > rest[:, np.newaxis] + RECOVERED_K, nominal if extremes is None else extremes, -np.inf)
    return Load(plays, drawn[0], drawn[1], away[0], away[1], stuck, cut_C)


def _in_corners(delivery: ModuleDrive) -> tuple[Ensemble, Drive | LaneDrives, float | None]:
    """The corners of a rig, what is played in each, and the current that a bridge switches."""
    rig, device, played = delivery.rig, delivery.device, delivery.played
    if device.kind.regulated:
        module = FollowingModule.of(rig)
        return module.ensemble, module.drives(played), None
    if not device.kind.switches:
        return Ensemble.of(rig), delivery.delivered, None
    means = Drive(played.time_s, played.command * device.bridge_A, held=True)
    return Ensemble.of(rig, device.bridge_A, averaged=True), means, device.bridge_A


def _played(ensemble: Ensemble, drive: Drive | LaneDrives) -> tuple[Array, Array]:
    """Times in s (rows,) and WATCHED (4, lanes, rows) in °C of a play from rest."""
    stretches = [stretch for stretch, _ in ensemble.play(drive, ensemble.at_rest(drive.current_A[..., 0]))]
    times, values = zip(*stretches, strict=True)
    return np.concatenate(times), np.concatenate(values, axis=2)


def _in_force(drive: Drive | LaneDrives, times_s: Array) -> Array:
    """Currents (lanes or 1, rows) in A at times in s, each held until the next."""
    at = np.clip(np.searchsorted(drive.time_s, times_s + 1e-12, side="right") - 1, 0, len(drive.time_s) - 1)
    return np.atleast_2d(drive.current_A[..., at])


def _binned(times_s: Array, values: Array) -> Array:
    """The greatest of values (k, times) in rows of STEP_S."""
    edges = np.arange(int(np.ceil(float(times_s[-1]) / STEP_S - 1e-6)) + 1) * STEP_S
    at = np.minimum(np.searchsorted(times_s, edges - 1e-9), len(times_s) - 1)
    return np.asarray(np.maximum.reduceat(values, at, axis=1))


def _until(load: Load, rows: int) -> Load:
    """The same with so many rows, of which the last goes on."""
    courses = (load.current_A, load.power_W, load.warm_C, load.chill_C)
    drawn_A, drawn_W, warm_C, chill_C = (np.pad(one, (0, rows - len(one)), mode="edge") for one in courses)
    return Load(load.plays, drawn_A, drawn_W, warm_C, chill_C, load.stuck, load.cut_C)
