"""A session as one drive: the currents of its icons in sequence, with the holding current in the gaps."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from thermicon.icons import Icon

from ..arrays import Array
from ..rig.load import refuse_load
from ..rig.rig import Rig
from ..solver.batch_inputs import bank_of, run_follow, run_regulate
from ..solver.drive import Drive
from ..solver.inverse import Design, baseline_C, design, gains_of, target_at
from ..solver.landing import refuse_landing
from ..solver.simulate import duration_s, simulate
from .sessionplan import SessionError, SessionPlan, check_length

TRACKINGS = ("replay", "display")
"""The current of each icon open loop, as exported drives are played; or its display temperature, as a thermode does."""

SLOWEST_HZ = 100.0
"""Fewest rows per second: over more than 10 ms, a mean rate would hide how steep the skin's temperature was."""

MOST_ROWS = 1_500_000
"""Rows of a session, which take about 0.5 GB while they are computed."""


@dataclass(frozen=True, slots=True)
class SessionDrive:
    """The drive of a session, begun from `start_C` (state, °C) that `rest_A` has held; plays (k,) start and end in s.

    `rate_Hz` is a multiple of the driver's update rate, so that no change of the current lies between two rows.
    """

    drive: Drive
    rest_A: float
    start_C: Array
    starts_s: tuple[float, ...]
    ends_s: tuple[float, ...]
    rate_Hz: float


def drive_of(plan: SessionPlan, icons: Mapping[str, Icon], rig: Rig, tracking: str = "replay") -> SessionDrive:
    """Return the one drive of a session; `icons` has every name of the plan.

    Every icon starts at the first update of the driver at or after the end of its gap. The current of each is designed
    from rest, and its own resting current flows until the next one starts; with `display` the driver follows each
    icon's display temperature and holds the display at the icon's baseline in the gaps.

    Raises SessionError for a session that is too long and for what cannot be tracked, RigError for a baseline that
    cannot be held.
    """
    if tracking not in TRACKINGS:
        raise SessionError(f"tracking {tracking!r} is not known; it is one of {', '.join(TRACKINGS)}")
    refuse_load(rig, "safety for people")
    refuse_landing(rig, "a session is played to a hand that rests on the display")
    lasting = {name: duration_s(icons[name], rig) for name in plan.names}
    total = check_length([lasting[name] for name in plan.order], plan.gap_s)
    update = rig.driver.update_Hz
    rate = update * max(1, math.ceil(SLOWEST_HZ / update - 1e-9))
    if total * rate > MOST_ROWS:
        raise SessionError(
            f"{total:.0f} s at the driver's {update:g} Hz are {total * rate:.0f} rows; the limit is {MOST_ROWS:,}: "
            f"play fewer icons at once, or lower driver.update_Hz"
        )
    starts, counts, begin = [], [], 0.0
    for name in plan.order:
        start = math.ceil(begin * update - 1e-6)
        starts.append(start)
        counts.append(max(1, math.ceil(lasting[name] * update - 1e-9)))
        begin = start / update + lasting[name] + plan.gap_s
    follow = _replayed if tracking == "replay" else _tracked
    drive, first = follow(plan.order, icons, lasting, rig, starts, counts)
    ends = tuple(start / update + lasting[name] for name, start in zip(plan.order, starts, strict=True))
    return SessionDrive(drive, first.rest_A, first.start_C, tuple(start / update for start in starts), ends, rate)


def _replayed(
    order: Sequence[str],
    icons: Mapping[str, Icon],
    lasting: Mapping[str, float],
    rig: Rig,
    starts: Sequence[int],
    counts: Sequence[int],
) -> tuple[Drive, Design]:
    plans = {name: design(icons[name], rig, lasting[name]) for name in dict.fromkeys(order)}
    currents = {
        name: held_A(plan.drive, counts[order.index(name)], rig.driver.update_Hz) for name, plan in plans.items()
    }
    places, values = [], []
    following = [*starts[1:], starts[-1] + counts[-1] + 1]
    for name, start, count, after in zip(order, starts, counts, following, strict=True):
        last = min(count, after - start)  # an icon that ends within an update gives way to the next one
        places.append(start + np.arange(last))
        values.append(currents[name][:last])
        if start + last < after:
            places.append(np.array([start + last]))
            values.append(np.array([plans[name].rest_A]))
    drive = Drive(np.concatenate(places) / rig.driver.update_Hz, np.concatenate(values), held=True)
    return drive, plans[order[0]]


def _tracked(
    order: Sequence[str],
    icons: Mapping[str, Icon],
    lasting: Mapping[str, float],
    rig: Rig,
    starts: Sequence[int],
    counts: Sequence[int],
) -> tuple[Drive, Design]:
    """The driver's own currents for set-points at the end of every update of the whole session."""
    update = rig.driver.update_Hz
    displays = {
        name: _setpoints(icons[name], rig, counts[order.index(name)], lasting[name]) for name in dict.fromkeys(order)
    }
    ends = starts[-1] + counts[-1]
    target = np.full(ends, displays[order[0]][0])
    for name, start, count in zip(order, starts, counts, strict=True):
        base, levels = displays[name]
        target[start : start + count] = levels
        target[start + count :] = base
    first = design(icons[order[0]], rig, lasting[order[0]])
    bank, lane = bank_of(rig), np.zeros(1, dtype=np.int64)
    states, period = bank.states([first.start_C]), 1.0 / update
    if rig.controller is None:
        current = run_follow(bank, lane, lane, period, target[np.newaxis], False, states)[0]
    else:
        setpoint = np.concatenate([[displays[order[0]][0]], target[:-1]])[np.newaxis]
        gains = np.array([gains_of(rig)])
        current = run_regulate(bank, lane, lane, period, setpoint, gains, np.array([first.rest_A]), states)[0]
    drive = Drive(np.arange(ends + 1) / update, np.append(current[0], first.rest_A), held=True)
    return drive, first


def _setpoints(icon: Icon, rig: Rig, count: int, lasts_s: float) -> tuple[float, Array]:
    """Display temperature in °C at rest, and at the end of every update of an icon."""
    control, base = icon.context.control, baseline_C(icon, rig)
    if control == "current":
        raise SessionError(
            f"{icon.name} prescribes the current, so there is no display temperature to track; use tracking replay"
        )
    update = rig.driver.update_Hz
    if control == "display":
        return base, target_at(icon, base, np.arange(1, count + 1) / update)
    display = simulate(icon, rig, rate_Hz=update, tail_s=count / update - lasts_s).display_C
    return float(display[0]), display[1 : count + 1]


def held_A(drive: Drive, count: int, update_Hz: float) -> Array:
    """Currents in A held over `count` updates: a drive's own, or the means of one that is linear between its rows.

    >>> held_A(Drive([0, 1], [0.0, 1.0]), 4, 4.0).tolist()
    [0.125, 0.375, 0.625, 0.875]
    """
    if drive.held:
        return drive.current_A[:count]
    edges = np.arange(count + 1) / update_Hz
    times = np.union1d(drive.time_s, edges)
    currents = np.interp(times, drive.time_s, drive.current_A)
    charge = np.concatenate([[0.0], np.cumsum(0.5 * (currents[1:] + currents[:-1]) * np.diff(times))])
    return np.asarray(np.diff(np.interp(edges, times, charge)) * update_Hz)
