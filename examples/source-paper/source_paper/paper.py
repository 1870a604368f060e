"""The source paper's results beside ours: Shani & Lineykin 2021, Figs. 3 to 6, with statements of its discussion.

Functions play the paper's cooling step (6 °C at 3 °C/s, 4 s held, back) on a rig, `emulator_rig()` unless another is
given. The paper's own curves are not reproduced: they are not available in numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from thermicon.base.files.records import RecordTable, load_records
from thermicon.base.numbers.arrays import Array
from thermicon.circuit.rig.rig import Rig
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.simulate import simulate
from thermicon.circuit.solver.steady import state_under_current
from thermicon.circuit.solver.trace import Trace
from thermicon.icons import Icon, load_library

from .depths import Likeness, probe_depths, resembles
from .insulated import Pad

TAIL_S = 4.0
"""Time that a run goes on after the cue, for the skin to come back."""
EMULATOR_A, EMULATOR_V = 2.5, 20.0
"""Limits that do not affect the paper's cue: its first instants need 2.4 A and 15.9 V."""
THERMISTORS = (("1", "display"), ("2", "interface"))
"""The third is under a pad."""


def printed() -> RecordTable:
    """Numbers from the paper's text, each with its place."""
    return load_records(Path(__file__).with_name("source-paper.toml"))


def cooling_step(control: str) -> Icon:
    """Return the paper's cue, prescribed on the `skin` as in the paper or on the `display` as in the older experiment.

    >>> cooling_step("skin").context.control
    'skin'
    """
    return load_library("cooling-step-skin" if control == "skin" else "six-icons")["cooling-step"]


def emulator_rig() -> Rig:
    """Return the rig `shani2021` with its driver's limits lifted: the paper's simulation states none.

    >>> emulator_rig()
    Rig('shani2021', thenar, 9 cm², skin rests at 32.0 °C, blood 37.00 °C, driver -2.5 … 2.5 A)
    """
    return Rig.load("shani2021").with_(**{"driver.current_limit_A": EMULATOR_A, "driver.voltage_limit_V": EMULATOR_V})


def coldest_display_C(rig: Rig) -> float:
    """Temperature in °C to which a rig's display settles on skin with the driver's greatest current held.

    >>> round(coldest_display_C(Rig.load("shani2021")), 1)  # the paper: about 5 °C at the lowest
    4.6
    """
    network = network_of(rig)
    return network.read(state_under_current(network, rig.driver.current_max_A), "display_C")


def distortion(trace: Trace, of_C: Array) -> float:
    """How far a course is from the cue's target, shifted and scaled to fit best: rms in parts of its own step."""
    shape = (trace.target_C - trace.target_C[0]) / np.ptp(trace.target_C)
    columns = np.stack([np.ones_like(shape), shape], axis=1)
    fitted = np.linalg.lstsq(columns, of_C, rcond=None)[0]
    return float(np.sqrt(np.mean((columns @ fitted - of_C) ** 2)) / abs(fitted[1]))


@dataclass(frozen=True, slots=True)
class ControlledCue:
    """The cue twice, as in Figs. 3 and 4: prescribed on the skin, and prescribed on the display."""

    skin: Trace
    display: Trace

    @property
    def distortions(self) -> dict[str, tuple[float, float]]:
        """Distortion of (skin, display) under each control, in parts of the step."""
        traces = {"skin": self.skin, "display": self.display}
        return {
            name: (distortion(trace, trace.skin_C), distortion(trace, trace.display_C))
            for name, trace in traces.items()
        }


def controlled_cue(rig: Rig | None = None) -> ControlledCue:
    """Play the cue under both controls (Figs. 3 and 4)."""
    rig = rig or emulator_rig()
    return ControlledCue(
        simulate(cooling_step("skin"), rig, tail_s=TAIL_S), simulate(cooling_step("display"), rig, tail_s=TAIL_S)
    )


@dataclass(frozen=True, slots=True)
class Thermistors:
    """The three thermistors of Figs. 5 and 6 as probes of one trace, and the depth that the third resembles."""

    trace: Trace
    likeness: Likeness
    depth_C: Array
    lateral_m: float


def thermistors(rig: Rig | None = None, *, lateral_m: float | None = None) -> Thermistors:
    """Play the cue with the paper's three thermistors (Figs. 5 and 6), the third so far from skin in contact."""
    probes: list[dict[str, object]] = [{"name": name, "place": place} for name, place in THERMISTORS]
    rig, cue, pad = (rig or emulator_rig()).with_(probe=probes), cooling_step("skin"), Pad.of(lateral_m)
    likeness = resembles(cue, rig, pad, tail_s=TAIL_S)
    depth_C, trace = probe_depths(cue, rig, [likeness.depth_m], tail_s=TAIL_S)
    trace = replace(trace, probes=(*trace.probes, ("3", pad.reads(trace, rig))))
    return Thermistors(trace, likeness, depth_C[0], pad.lateral_m)


@dataclass(frozen=True, slots=True)
class DermisChange:
    """Largest change in K and fastest fall in K/s at depths in m, and where they equal those in the paper's text."""

    rig_name: str
    depth_m: Array
    change_K: Array
    fastest_K_per_s: Array
    receptor_m: tuple[float, float]

    def depth_of_m(self, change_K: float) -> float:
        """Shallowest depth in m at which the change is no larger."""
        return _crossing(self.depth_m, self.change_K, change_K)

    def depth_of_rate_m(self, rate_K_per_s: float) -> float:
        """Shallowest depth in m below the receptors at which it falls no faster."""
        return _crossing(self.depth_m, self.fastest_K_per_s, rate_K_per_s)

    def at(self, depth_m: float) -> tuple[float, float]:
        """Largest change in K and fastest fall in K/s at a depth in m."""
        return (
            float(np.interp(depth_m, self.depth_m, self.change_K)),
            float(np.interp(depth_m, self.depth_m, self.fastest_K_per_s)),
        )


def _crossing(depth_m: Array, values: Array, level: float) -> float:
    below = np.flatnonzero(values <= level)
    if not below.size or below[0] == 0:
        return float("nan")
    k = int(below[0])
    return float(np.interp(level, [values[k], values[k - 1]], [depth_m[k], depth_m[k - 1]]))


def dermis_change(rig: Rig | None = None) -> DermisChange:
    """Play the cue and look at all depths down to 2 mm: how much, and how fast, the tissue cools there."""
    rig = rig or emulator_rig()
    depths = np.linspace(0.0, min(2.0e-3, rig.skin.thickness_m), 201)
    at_C, trace = probe_depths(cooling_step("skin"), rig, depths, tail_s=TAIL_S)
    change = at_C[:, :1] - at_C.min(axis=1, keepdims=True)
    fall = -np.diff(at_C, axis=1).min(axis=1) / trace.time_s[1]
    return DermisChange(rig.name, depths, change[:, 0], fall, (rig.skin.cold_receptor_m, rig.skin.warm_receptor_m))


@dataclass(frozen=True, slots=True)
class MissByLimit:
    """Largest miss in K of the cue under skin control, for current limits in A; both (limits,)."""

    rig_name: str
    limit_A: Array
    miss_K: Array
    reached: tuple[bool, ...]
    shipped_A: float


LIMITS_A = (0.75, 1.0, 1.25, 1.5, 1.7, 1.85, 2.0, 2.2, 2.5)
"""Current limits from below the rig's own, by the module's 1.85 A, to those of `emulator_rig`."""


def miss_by_limit(limits_A: Sequence[float] = LIMITS_A) -> MissByLimit:
    """Play the cue on the skin with several current limits of the driver; the paper prints none."""
    own_A, rig = Rig.load("shani2021").driver.current_max_A, emulator_rig()
    outcomes = [simulate(cooling_step("skin"), rig.with_(**{"driver.current_limit_A": a})).outcome for a in limits_A]
    misses = [abs(outcome.largest_miss_K) for outcome in outcomes if outcome is not None]
    reached = tuple(outcome.reached for outcome in outcomes if outcome is not None)
    return MissByLimit(rig.name, np.array(limits_A), np.array(misses), reached, own_A)
