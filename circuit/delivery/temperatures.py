"""Set-points against time for a controller around the rig's own module.

The set-points are the means of the designed display temperature over each period, held until the next, shaped through
the loop that plays them (`shaped.py`). The display is that of the rig's own module following them by that loop, at the
rig's update rate and within its driver's limits.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.icons import Icon

from ..rig.corner import with_gain
from ..rig.rig import Rig
from ..rig.rigfile import RigError
from ..safety.corners import corners_of
from ..safety.ensemble import Ensemble, LaneDrives
from ..safety.fault_limits import FaultLimits
from ..safety.single_faults import Faulty
from ..safety.tally import WATCHED
from ..solver.batch_inputs import Bank, bank_of, run_follow
from ..solver.drive import Drive
from ..solver.inverse import Design, baseline_C, design_ideal, regulated
from ..solver.network import PAST_MOST_COOLING, network_of
from ..solver.simulate import duration_s, simulate_current
from ..solver.steady import holding_current_A, state_under_current, steady_state
from .delivered_drive import ModuleDrive
from .device import Device
from .devicefile import DeviceError
from .samples import Samples, led, rate_of
from .setpoints import check_level
from .shaped import looped, places_of, shaped


def deliver_temperatures(icon: Icon, rig: Rig, device: Device, tail_s: float) -> ModuleDrive:
    """Return a cue as a controller around the rig's module delivers it; DeviceError for what that cannot take."""
    if icon.context.control == "current":
        raise DeviceError(
            f"{device.name} takes temperatures, and {icon.name} prescribes a current; use control display or control "
            f"skin, or a device driven by volts, amperes or duty"
        )
    requested = rig.driver.update_Hz
    end = duration_s(icon, rig) + tail_s
    rate = rate_of(device, requested, end)
    plan = design_ideal(icon, rig, end)
    samples = _sampled(icon, rig, device, plan, end, rate)
    designed = designed_until(led(plan, end, rate), (len(samples.codes) - 1) / rate)
    model = simulate_current(designed, rig, start_C=plan.start_C)
    samples = shaped(rig, samples, model.time_s, model.display_C)
    delivered = follow_samples(looped(rig), samples)
    trace = simulate_current(designed_until(delivered, float(designed.time_s[-1])), rig)
    return ModuleDrive(
        icon=icon, rig=rig, device=device, requested_Hz=requested, rate_Hz=rate, lead_s=1.0 / rate, played=samples,
        designed=designed, delivered=delivered, designed_trace=model, trace=trace, outcome=plan.outcome,
    )  # fmt: skip


def follow_samples(rig: Rig, samples: Samples, *, to_the_limit: bool = False, gain: float = 1.0) -> Drive:
    """The current by which the display follows held set-points and ends at rest; RigError without a steady state.

    `to_the_limit`: a set-point out of reach takes the current to the driver's limit, past the most cooling.
    """
    first = float(samples.command[0])
    rest, state = rest_of_a_loop(rig, first) if to_the_limit else steady_state(rig, "display", first)
    lane, period = np.zeros(1, dtype=np.int64), 1.0 / rig.driver.update_Hz
    bank = past_most_cooling([rig]) if to_the_limit else bank_of(rig)
    setpoint = updates_of(samples, period)
    times: Array = np.arange(len(setpoint) + 1, dtype=np.float64) * period
    if rig.controller is None:
        current = run_follow(bank, lane, lane, period, setpoint[np.newaxis], False, bank.states([state]))[0][0]
    else:
        current = regulated(rig, bank, setpoint, (rest, state), gain)[0]
    return Drive(times, [*current, rest], held=True)


def updates_of(samples: Samples, period_s: float) -> Array:
    """The set-point in force at each update of the driver."""
    return np.asarray(samples.command[places_of(samples, period_s)])


def rest_of_a_loop(rig: Rig, level_C: float) -> tuple[float, Array]:
    """Current in A by which a loop holds a level, or to which it runs, or of the most cooling; and the steady state."""
    with suppress(RigError):
        return steady_state(rig, "display", level_C)
    network, driver = network_of(rig), rig.driver
    most_cooling = holding_current_A(network, "display", level_C)
    limit = driver.current_min_A if most_cooling < driver.current_min_A else driver.current_max_A
    for current in (limit, float(np.clip(most_cooling, driver.current_min_A, driver.current_max_A))):
        with suppress(ArithmeticError):
            return current, state_under_current(network, current)
    raise RigError(f"rig {rig.name}, in one corner: it heats without limit at rest; begin nearer to rest")


def past_most_cooling(rigs: Sequence[Rig]) -> Bank:
    """The rigs for a loop that does not know at which current its module cools most."""
    bank = Bank.of([network_of(rig) for rig in rigs])
    bank.plates[:, PAST_MOST_COOLING] = 1.0
    return bank


def designed_until(drive: Drive, end_s: float) -> Drive:
    """The same drive with its last current held until a time in s."""
    if end_s <= drive.time_s[-1] + 1e-9:
        return drive
    return Drive(np.append(drive.time_s, end_s), np.append(drive.current_A, drive.current_A[-1]), drive.held)


def _sampled(icon: Icon, rig: Rig, device: Device, plan: Design, end_s: float, rate_Hz: float) -> Samples:
    """Means of the designed display over each period, preceded by one period of rest and followed by rest."""
    times, levels = _course(icon, rig, plan)
    for level in (float(levels.min()), float(levels.max())):
        check_level("set-point", level, device.interval("set-point range"), device)
    edges: Array = np.arange(math.ceil(end_s * rate_Hz - 1e-9) + 1, dtype=np.float64) / rate_Hz
    grid = np.union1d(edges, times)
    values = np.interp(grid, times, levels)
    area = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(grid))])
    means = np.diff(np.interp(edges, grid, area)) / np.diff(edges)
    scale = device.scale(0.0)
    codes = np.rint(np.concatenate([levels[:1], means, levels[:1]]) / scale.step).astype(np.int64)
    return Samples(rate_Hz, np.clip(codes, scale.lowest, scale.highest), scale)


def _course(icon: Icon, rig: Rig, plan: Design) -> tuple[Array, Array]:
    """Times in s and the display in °C of a design without any loop: the cue's corners, or what its skin needs."""
    if icon.context.control == "display":
        corners = icon.corners(baseline_C(icon, rig))
        return np.array(corners.time_s), np.array(corners.value)
    model = simulate_current(plan.drive, rig, rate_Hz=rig.driver.update_Hz, start_C=plan.start_C)
    return model.time_s, model.display_C


@dataclass(frozen=True, slots=True, eq=False)
class FollowingModule:
    """The rig's module in the corners of its uncertainty, where it follows set-points by its loop or its driver's best.

    A loop corrects the gain of its current source, but not the limit at which that saturates: `rigs` have the limits as
    they flow. A weaker source is slower, so only the strongest is judged. Where a set-point cannot be reached the loop
    runs to that limit, since it does not know at which current its module cools most.
    """

    ensemble: Ensemble
    rigs: tuple[Rig, ...]

    @staticmethod
    def of(rig: Rig) -> FollowingModule:
        """The rig as given, and its corners with the strongest source."""
        most = rig.uncertainty.gain_relative
        corners = tuple(corner for corner in corners_of(rig) if corner.nominal or corner.gain_relative == most)
        rigs = tuple(with_gain(corner.rig, corner.gain_relative) for corner in corners)
        return FollowingModule(Ensemble.on(rig, corners, None), rigs)

    def drives(self, samples: Samples) -> LaneDrives:
        """The currents by which each corner follows set-points, as commanded."""
        flows = [
            follow_samples(rig, samples, to_the_limit=True, gain=float(gain))
            for rig, gain in zip(self.rigs, self.ensemble.gain, strict=True)
        ]
        return LaneDrives(flows[0].time_s, np.array([flow.current_A for flow in flows]) / self.ensemble.gain[:, None])

    def unpowered_C(self) -> tuple[float, float]:
        """Between which temperatures in °C the display stands without power."""
        off = self.ensemble.at_rest(0.0)
        values, _ = self.ensemble.hold(0.0, off, np.array([0.0, 1.0]))
        display: Array = values[WATCHED.index("display_C"), :, -1]
        return float(display.min()), float(display.max())

    def faulty(self, samples: Samples, ensemble: Ensemble) -> Faulty:
        """Single faults in some corners of what the loop sends to the rig as given."""
        drive, limits = follow_samples(self.rigs[0], samples), ensemble.rig.limits
        rest_A = float(drive.current_A[0])
        return Faulty(ensemble, drive, rest_A, ensemble.at_rest(rest_A), limits, FaultLimits.of(limits))
