"""Runs of a thermode: the display that follows its set-points.

There is no current to find: the display follows its set-points within its range, ramp rate and lag. A constant lag is a
delay and not a miss, so the outcome is judged without it; the trace includes it. Of many people under one thermode, the
display is the same and the skins are not.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.icons import Icon

from ..rig.rig import Rig
from ..rig.rigfile import RigError, Thermode
from .inverse import baseline_C, steps_at, target_at
from .modes import FELT, SkinModes, modes_of, modes_on, shown
from .network import skin_network_of
from .probes import readings_of, sensed
from .trace import Outcome, Trace, judge, of_rig

FINEST_S = 0.01
"""Longer updates are divided into equal parts of at most this, so that lag and skin are resolved within them."""

SKIN_ROW = FELT.index("skin_C")


def part_of(update_s: float, finest_s: float = FINEST_S) -> float:
    """An update in s, or its largest whole fraction that is not above the finest."""
    return update_s / max(1, math.ceil(update_s / finest_s - 1e-9))


@dataclass(frozen=True, slots=True)
class DisplayDesign:
    """The display of a thermode (rows,) in °C for a cue, at steps of `step_s` from 0 on; judged without its lag."""

    step_s: float
    display_C: Array
    outcome: Outcome


def refuse_current(icon: Icon, who: str) -> None:
    """Raise RigError for a cue that prescribes current, which a thermode does not take."""
    if icon.context.control == "current":
        raise RigError(
            f"{who} is a thermode: it takes temperatures, and {icon.name} prescribes a current; use control display or "
            f"control skin, or a rig and a device with a module"
        )


def design_display(icon: Icon, rig: Rig, end_s: float, finest_s: float = FINEST_S) -> DisplayDesign:
    """Set-points and display of a thermode for a cue; RigError for a current, or a baseline out of range.

    Corners of a display are rounded to the resolution; what a skin needs is not, as it is drawn in segments.
    """
    refuse_current(icon, f"rig {rig.name}")
    assert rig.thermode is not None
    thermode, modes, base = rig.thermode, modes_of(rig), baseline_C(icon, rig)
    update = 1.0 / thermode.update_Hz
    ticks: Array = np.arange(math.ceil(end_s / update - 1e-9) + 1, dtype=np.float64) * update
    step = part_of(update, finest_s)
    times: Array = np.arange((len(ticks) - 1) * round(update / step) + 1, dtype=np.float64) * step
    limits = thermode.lowest_C, thermode.highest_C
    if icon.context.control == "skin":
        start = modes.display_holding_skin_C(base)
        _check_baseline(start, rig, thermode, f" (for {base:g} °C on the skin)")
        setpoints_C = modes.display_for_skin(target_at(icon, base, ticks), update, start, thermode.slew_K_per_s, limits)
    else:
        _check_baseline(base, rig, thermode, "")
        corners = icon.corners(base)
        levels = np.array(corners.value)
        if thermode.resolution_K:
            levels = np.rint(levels / thermode.resolution_K) * thermode.resolution_K
        setpoints_C = np.clip(np.interp(ticks, corners.time_s, levels), *limits)
    setpoints = np.interp(times, ticks, setpoints_C)
    prompt = shown(setpoints, step, 0.0, thermode.slew_K_per_s)
    outcome = judge_display(icon, modes, base, step, prompt, limits, thermode.slew_K_per_s)
    return DisplayDesign(step, shown(setpoints, step, thermode.lag_s, thermode.slew_K_per_s), outcome)


def judge_display(
    icon: Icon, modes: SkinModes, base: float, step_s: float, prompt_C: Array, limits_C: tuple[float, float],
    slew_K_per_s: float,
) -> Outcome:  # fmt: skip
    """The outcome of a display (rows,) without lag, where the cue prescribes it; held back by range or ramp rate."""
    times: Array = np.arange(len(prompt_C), dtype=np.float64) * step_s
    target, reached = target_at(icon, base, times), prompt_C
    if icon.context.control == "skin":
        reached = modes.run(prompt_C, step_s, modes.steady(float(prompt_C[0])))[0][SKIN_ROW]
    limits_met = [
        ("range of the thermode", (prompt_C <= limits_C[0] + 1e-9) | (prompt_C >= limits_C[1] - 1e-9)),
        ("ramp rate of the thermode", np.abs(np.diff(prompt_C, append=prompt_C[-1])) >= slew_K_per_s * step_s - 1e-9),
    ]
    met = tuple((name, float(times[np.argmax(where)])) for name, where in limits_met if where.any())
    met = tuple(sorted(met, key=lambda limit: limit[1]))
    return judge(target[1:], reached[1:], step_s, met, steps_at(icon, base))


def play_display(icon: Icon, rig: Rig, rows: Array, rate_Hz: float) -> Trace:
    """Play a cue on a thermode: its trace at rows."""
    plan = design_display(icon, rig, float(rows[-1]), 1.0 / max(rate_Hz, 1.0 / FINEST_S))
    target = target_at(icon, baseline_C(icon, rig), rows)
    return trace_of_display(
        rig, plan.step_s, plan.display_C, rows, icon=icon.name, control=icon.context.control, target_C=target,
        outcome=plan.outcome,
    )  # fmt: skip


def trace_of_display(
    rig: Rig, step_s: float, display_C: Array, rows: Array, *, icon: str | None, control: str, target_C: Array,
    outcome: Outcome | None,
) -> Trace:  # fmt: skip
    """The trace at rows of a display (steps,), held before at its first level; without current, which is NaN."""
    own_probes = readings_of(rig)
    modes = modes_of(rig) if own_probes is None else modes_on(skin_network_of(rig), readings=own_probes)
    values, _ = modes.run(display_C, step_s, modes.steady(float(display_C[0])))
    times: Array = np.arange(len(display_C), dtype=np.float64) * step_s
    probes = sensed(rig, times, values[len(FELT) :], 1)
    felt = dict(zip(FELT, (_at(rows, times, row) for row in values), strict=False))
    nothing = np.full(len(rows), np.nan)
    return Trace(
        icon=icon,
        driver_limits_A=(math.nan, math.nan),
        control=control,
        outcome=outcome,
        beyond=(),
        time_s=rows,
        current_A=nothing,
        voltage_V=nothing.copy(),
        target_C=target_C,
        hot_plate_C=nothing.copy(),
        probes=tuple((name, _at(rows, times, row)) for name, row in probes),
        **(of_rig(rig) | felt),
    )


def displays_on(
    icons: Sequence[Icon], rigs: Sequence[Rig], nominal: Rig, rows: Array, tracking: str | None, probes: Sequence[str]
) -> Array:
    """Probes (probes, rigs, icons, rows) under one thermode: the nominal rig's display, or with `ideal` each skin's."""
    if nominal.thermode is None or any(rig.thermode != nominal.thermode for rig in rigs):
        raise RigError("rigs of one batch must have the same thermode, or none")
    felt = [place for place, probe in enumerate(probes) if probe in FELT]
    chosen = [FELT.index(probes[place]) for place in felt]
    values = np.full((len(probes), len(rigs), len(icons), len(rows)), np.nan)
    finest = float(np.diff(rows).min(initial=FINEST_S))
    shared = [design_display(icon, nominal, float(rows[-1]), finest) for icon in icons]
    step, displays = shared[0].step_s, np.array([plan.display_C for plan in shared])
    times: Array = np.arange(displays.shape[1], dtype=np.float64) * step
    anew = [k for k, icon in enumerate(icons) if tracking == "ideal" and icon.context.control == "skin"]
    for r, rig in enumerate(rigs):
        for k in anew:
            displays[k] = design_display(icons[k], rig, float(rows[-1]), finest).display_C
        modes = modes_of(rig)
        read = np.swapaxes([modes.run(row, step, modes.steady(float(row[0])), chosen)[0] for row in displays], 0, 1)
        values[felt, r] = [[_at(rows, times, row) for row in lane] for lane in read]
    return values


def _at(rows: Array, times: Array, values: Array) -> Array:
    """Values at rows, which are as a rule the times themselves."""
    if len(rows) <= len(times) and np.abs(times[: len(rows)] - rows).max() < 1e-9:
        return np.ascontiguousarray(values[: len(rows)])
    return np.asarray(np.interp(rows, times, values), dtype=np.float64)


def _check_baseline(display_C: float, rig: Rig, thermode: Thermode, why: str) -> None:
    if not thermode.lowest_C - 1e-9 <= display_C <= thermode.highest_C + 1e-9:
        raise RigError(
            f"rig {rig.name}: a baseline of {display_C:.4g} °C on the display{why} is beyond its {thermode.lowest_C:g} "
            f"… {thermode.highest_C:g} °C; choose another baseline"
        )
