"""Many cues on many rigs in one go: what each virtual person's skin goes through."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thermicon.circuit.bank import Bank, cut, run_follow, run_forward
from thermicon.circuit.inverse import baseline_C, design, periods, target_at
from thermicon.circuit.network import network_of
from thermicon.circuit.rig import Rig
from thermicon.circuit.rigfile import RigError
from thermicon.circuit.simulate import rows_until, simulate
from thermicon.circuit.skin import Array
from thermicon.circuit.steady import hold, steady_state
from thermicon.icons import Icon

TRACKINGS = ("replay", "display", "ideal")
"""What each rig is played: the nominal current open loop, the nominal display trajectory, or its own solution."""

USUAL = ("skin_C", "cold_receptor_C", "warm_receptor_C")


@dataclass(frozen=True, slots=True)
class Batch:
    """Traces of many cues on many rigs: `time_s` (rows,), `values` (probes, rigs, icons, rows)."""

    time_s: Array
    probes: tuple[str, ...]
    values: Array

    def __getitem__(self, probe: str) -> Array:
        """Values of one probe, (rigs, icons, rows)."""
        return np.asarray(self.values[self.probes.index(probe)])

    @property
    def cold_C(self) -> Array:
        """Temperature at cold-receptor depth in °C, (rigs, icons, rows)."""
        return self["cold_receptor_C"]

    @property
    def warm_C(self) -> Array:
        """Temperature at warm-receptor depth in °C, (rigs, icons, rows)."""
        return self["warm_receptor_C"]


def usual_tracking(icon: Icon) -> str:
    """Tracking that suits what a cue prescribes: `display` for display control, else `replay`."""
    return "display" if icon.frame.control == "display" else "replay"


def simulate_many(
    icons: Sequence[Icon],
    rigs: Sequence[Rig],
    *,
    nominal: Rig,
    end_s: float,
    rate_Hz: float = 100.0,
    tracking: str | None = None,
    probes: Sequence[str] = USUAL,
) -> Batch:
    """Play every cue on every rig until `end_s`; the result does not depend on the number of cores.

    `tracking` is one of TRACKINGS, or None for what suits each cue: `replay` plays the current designed on `nominal`
    open loop, `display` tracks the display temperature designed on `nominal` within each driver's limits, `ideal`
    solves anew for each rig. Raises RigError when a rig cannot hold a baseline.
    """
    if tracking is not None and tracking not in TRACKINGS:
        raise RigError(f"tracking {tracking!r} is not known; it is one of {', '.join(TRACKINGS)}")
    rows = rows_until(end_s, rate_Hz)
    bank = Bank.of([network_of(rig) for rig in rigs])
    values = np.empty((len(probes), len(rigs), len(icons), len(rows)))
    every = np.arange(len(rigs), dtype=np.int64)
    same_rate = len({rig.driver.update_Hz for rig in (*rigs, nominal)}) == 1
    if not same_rate:
        raise RigError("rigs of one batch must share driver.update_Hz")
    for place, icon in enumerate(icons):
        way = tracking or usual_tracking(icon)
        drives, states = _drives(icon, rigs, nominal, bank, way if icon.frame.control != "current" else "replay", end_s)
        one = np.zeros(len(rigs), dtype=np.int64)
        cue_of = one if len(drives.current_A) == 1 else every
        intervals = cut(rows, drives.time_s, drives.current_A, drives.held)
        values[:, :, place] = run_forward(bank, every, cue_of, intervals, bank.states(states), probes)
    values.setflags(write=False)
    return Batch(rows, tuple(probes), values)


@dataclass(frozen=True, slots=True)
class _Drives:
    """Currents of one cue: one row for all rigs, or one row each, (1 or rigs, times)."""

    time_s: Array
    current_A: Array
    held: bool


def _drives(
    icon: Icon, rigs: Sequence[Rig], nominal: Rig, bank: Bank, way: str, end_s: float
) -> tuple[_Drives, list[Array]]:
    if way == "replay":
        plan = design(icon, nominal, end_s)
        drive, states = plan.drive, [steady_state(network_of(rig), plan.rest_A) for rig in rigs]
        return _Drives(drive.time_s, drive.current_A[np.newaxis], drive.held), states
    control, base = icon.frame.control, baseline_C(icon, nominal)
    ends = periods(nominal, end_s)
    if way == "display" and control == "skin":
        display = simulate(icon, nominal, rate_Hz=nominal.driver.update_Hz, tail_s=end_s).display_C
        target, base, control = display[1 : len(ends) + 1], float(display[0]), "display"
    else:
        target = target_at(icon, base, ends)
    states = [hold(rig, control, base)[1] for rig in rigs]
    lanes = np.arange(len(rigs), dtype=np.int64)
    period = 1.0 / nominal.driver.update_Hz
    currents, _, _ = run_follow(
        bank, lanes, np.zeros_like(lanes), period, target[np.newaxis], control == "skin", bank.states(states)
    )
    times = np.concatenate([[0.0], ends])
    return _Drives(times, np.concatenate([currents, currents[:, -1:]], axis=1), True), states
