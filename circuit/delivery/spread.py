"""The uncertainty of an open loop: how far display and step may deviate where the module was not measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from thermicon.icons.number_text import signed

from ..arrays import Array
from ..safety.corners import corners_of
from ..solver.batch_inputs import Bank, cut, run_forward
from ..solver.network import network_of
from ..solver.pwm import steady_of
from ..solver.simulate import rows_until
from ..solver.steady import state_under_current
from .delivered_drive import DeliveredDrive
from .samples import Samples

ROWS_HZ = 10.0
"""Rows per second in which extremes are searched; the steps of the simulation are finer."""

ADVICE = "where a controller measures the display, play set-points: --device closed-loop-controller --to setpoint-csv"


@dataclass(frozen=True, slots=True)
class OpenLoopSpread:
    """Over the corners of a rig's uncertainty: the display at rest in °C, and its largest change in K, low and high."""

    baseline_C: tuple[float, float]
    step_K: tuple[float, float]

    def __str__(self) -> str:
        step = " … ".join(signed(value, "+.1f") for value in self.step_K)
        low, high = self.baseline_C
        return (
            f"open loop: with a module that was not measured the display may rest at {low:.1f} … {high:.1f} °C and "
            f"move by {step} K; {ADVICE}"
        )

    def to_dict(self) -> dict[str, list[float]]:
        """In the form of a sidecar."""
        return {"baseline_C": list(self.baseline_C), "step_K": list(self.step_K)}


def open_loop_spread(delivery: DeliveredDrive) -> OpenLoopSpread | None:
    """Return the spread of a drive over the corners of the rig's uncertainty; None where a loop follows set-points.

    A corner without a steady state, or one that diverges, is left to the gate.

    >>> from thermicon.circuit.delivery.device import Device
    >>> from thermicon.circuit.delivery.deliver import deliver
    >>> from thermicon.circuit.rig.rig import Rig
    >>> from thermicon.icons import load_library
    >>> icon, rig = load_library("six-icons")["cooling-step"], Rig.load("thenar")
    >>> spread = open_loop_spread(deliver(icon, rig, Device.load("dac-16")))
    >>> spread is not None and spread.baseline_C[0] < 32.0 < spread.baseline_C[1]
    True
    """
    played, device = delivery.played, delivery.device
    if device.driven_by in ("set-points", "temperatures") or not isinstance(played, Samples):
        return None
    drive, lanes, starts, gains = delivery.delivered, [], [], []
    for corner in corners_of(delivery.rig):
        try:
            if device.driven_by == "duty":
                start = steady_of(corner.rig, float(played.command[0]), device.bridge_A * (1.0 + corner.gain_relative))
            else:
                start = state_under_current(
                    network_of(corner.rig), float(drive.current_A[0]) * (1.0 + corner.gain_relative)
                )
        except ArithmeticError:
            continue
        lanes.append(network_of(corner.rig))
        starts.append(start)
        gains.append(1.0 + corner.gain_relative)
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
