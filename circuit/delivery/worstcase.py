"""The safety gate for a delivered cue.

A thermode shows its own set-points at its own tick: they are judged as they stand, with its lag and without.
"""

from dataclasses import dataclass

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..safety.corners import corners_of
from ..safety.display import DisplayCourse
from ..solver.batch_inputs import Bank, cut, run_forward
from ..solver.network import network_of
from ..solver.simulate import rows_until
from ..solver.steady import state_under_current
from .deliver import start_of
from .delivered_drive import DeliveredDrive, ModuleDrive, ThermodeDrive
from .setpoints import display_of, lag_of

AT_ONCE, LAGGED = "followed at once", "followed with its lag"

SETTLED_LAGS = 12.0
"""After this many lags a display is within 1e-5 of its last step."""


def ways_of(delivery: DeliveredDrive) -> tuple[DisplayCourse, ...]:
    """The display of a thermode in each way in which it may follow its set-points, at its own tick."""
    assert isinstance(delivery, ThermodeDrive)
    played, device = delivery.played, delivery.device
    ways = [DisplayCourse(AT_ONCE, *display_of(played, device, lagged=False))]
    if lag_of(device) > 0:
        settling = SETTLED_LAGS * lag_of(device)
        step, display = display_of(played, device, lagged=True, end_s=float(played.time_s[-1]) + settling)
        display = np.append(display[:-1], played.level_C[-1])
        ways.append(DisplayCourse(LAGGED, step, display, step * (len(display) - 1) - float(played.time_s[-1])))
    return tuple(ways)


ROWS_HZ = 10.0
"""Rows per second in which extremes are searched; the steps of the simulation are finer."""


@dataclass(frozen=True, slots=True)
class OpenLoopSpread:
    """Over the corners of a rig's uncertainty: the display at rest in °C, and its largest change in K, low and high."""

    baseline_C: tuple[float, float]
    step_K: tuple[float, float]


def open_loop_spread(delivery: DeliveredDrive) -> OpenLoopSpread | None:
    """The spread of a drive over a rig's corners, but for those that diverge; None where a loop follows set-points."""
    device = delivery.device
    if device.kind.regulated or not isinstance(delivery, ModuleDrive):
        return None
    drive, lanes, starts, gains = delivery.delivered, [], [], []
    for corner in corners_of(delivery.rig):
        gain, network = 1.0 + corner.gain_relative, network_of(corner.rig)
        try:
            start = start_of(device, corner.rig, delivery.played, gain)
            starts.append(state_under_current(network, float(drive.current_A[0]) * gain) if start is None else start)
        except ArithmeticError:
            continue
        lanes.append(network)
        gains.append(gain)
    bank, every = Bank.of(lanes), np.arange(len(lanes), dtype=np.int64)
    rows = rows_until(float(drive.time_s[-1]), ROWS_HZ)
    intervals = cut(rows, drive.time_s, np.array(gains)[:, np.newaxis] * drive.current_A, drive.held)
    display = run_forward(bank, every, every, intervals, bank.states(starts), ("display_C",))[0]
    display = display[np.isfinite(display).all(axis=1)]
    change = display - display[:, :1]
    largest: Array = np.take_along_axis(change, np.abs(change).argmax(axis=1)[:, np.newaxis], axis=1)[:, 0]
    return OpenLoopSpread(
        (float(display[:, 0].min()), float(display[:, 0].max())), (float(largest.min()), float(largest.max()))
    )
