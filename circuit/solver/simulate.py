"""Simulation of the circuit: a cue or a drive on a rig gives a Trace."""

from collections.abc import Sequence
from dataclasses import replace
from typing import overload

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.arrays import Array
from thermicon.base.words.number_text import significant
from thermicon.icons import Icon, SpatialIcon
from thermicon.icons.model.statements import Rest, Statement

from ..rig.layout import AnyLayout, Layout
from ..rig.module import ZERO_C_IN_K
from ..rig.rig import AnyRig, Rig
from ..rig.rigfile import RigError
from .batch_inputs import bank_of, cut, run_forward
from .displayed import play_display, refuse_current
from .drive import Drive
from .inverse import baseline_C, design, design_many, target_at
from .network import RECORDED, network_of
from .played import LayoutTrace
from .probes import between, divided, readings_of, sensed
from .steady import state_under_current, steady_state
from .trace import Outcome, Trace, of_rig

MOST_ROWS = 10_000_000
"""Rows of a trace at most: a gigabyte of its thirteen columns."""
HOTTEST_C = 1000.0
"""Above this, solder melts and a number must be wrong."""


def rows_until(end_s: float, rate_Hz: float) -> Array:
    """Times in s of the rows of a run: multiples of 1/rate, and the end.

    >>> rows_until(0.25, 10)
    array([0.  , 0.1 , 0.2 , 0.25])
    """
    if not (0 < rate_Hz < np.inf):
        raise RigError(f"a rate of {rate_Hz:g} Hz is not possible; it must be above 0")
    if end_s * rate_Hz > MOST_ROWS:
        raise RigError(
            f"{end_s:g} s at {rate_Hz:g} Hz are {end_s * rate_Hz:.0f} rows; the limit is {MOST_ROWS}: lower the rate"
        )
    rows = np.arange(int(end_s * rate_Hz + 1e-9) + 1) / rate_Hz
    return rows if end_s - rows[-1] < 1e-9 else np.append(rows, end_s)


@overload
def simulate(icon: Icon, rig: AnyLayout = None, *, rate_Hz: float = 100.0, tail_s: float = 0.0) -> Trace: ...
@overload
def simulate(icon: SpatialIcon, rig: AnyLayout, *, rate_Hz: float = 100.0, tail_s: float = 0.0) -> LayoutTrace: ...
@checked
def simulate(
    icon: Icon | SpatialIcon, rig: AnyLayout = None, *, rate_Hz: float = 100.0, tail_s: float = 0.0
) -> Trace | LayoutTrace:
    """Simulate a cue on a rig: find the current that produces it, then run the circuit with that current.

    A thermode needs no current: its display follows the cue within its own limits, and the skin follows the display.

    Parameters
    ----------
    icon
        The cue.
    rig
        The rig, or the name or file of one; None: the shipped rig of the icons' site, else thenar. For a cue on several
        elements a layout that has them, or its name or file.
    rate_Hz
        Rows of the trace per second.
    tail_s
        Time in s that the trace continues after the cue's last corner.

    Returns
    -------
    Trace
        Its `outcome` reports whether the rig reached the target. On several elements a LayoutTrace, a trace for each.

    Raises
    ------
    RigError
        Where no current holds the baseline, a run is not physical or too long, or a layout lacks an element.

    Examples
    --------
    >>> from thermicon.icons import load_library
    >>> step = load_library("six-icons")["cooling-step"]
    >>> simulate(step, Rig.load("thenar"))
    Trace('cooling-step' on thenar, 801 rows, 8 s, skin 26.92 … 32.04 °C, -0.48 … 1.11 A)

    """
    if not (0 <= tail_s < np.inf):
        raise RigError(f"a tail of {tail_s:g} s is not possible; it must be 0 or more")
    layout = Layout.of(rig, icon.context.site)
    if isinstance(icon, SpatialIcon):
        return _on_elements(icon, layout, rate_Hz, icon.duration_s + tail_s)
    rig = layout.alone
    end = duration_s(icon, rig) + tail_s
    rows = rows_until(end, rate_Hz)
    if rig.thermode is not None:
        return play_display(icon, rig, rows, rate_Hz)
    plan, target = design(icon, rig, end), _target(icon, rig, rows)
    return _run(rig, plan.drive, plan.start_C, rows, icon.name, target, icon.context.control, plan.outcome)


def _on_elements(icon: SpatialIcon, layout: Layout, rate_Hz: float, end_s: float) -> LayoutTrace:
    """Play each element's track on its rig until a common end; the rest of the elements rest."""
    layout.check_elements(icon.context.elements)
    still = Icon(icon.name, (Rest(icon.duration_s),), replace(icon.context, elements=()))
    pairs = [(icon.tracks.get(element.name, still), element.rig) for element in layout.elements]
    runs: dict[tuple[tuple[Statement, ...], Rig], Trace] = {}
    for track, rig in pairs:  # elements that are and play alike are computed once
        if (track.statements, rig) not in runs:
            tail = max(0.0, end_s - duration_s(track, rig))
            runs[track.statements, rig] = simulate(track, rig, rate_Hz=rate_Hz, tail_s=tail)
    found = [runs[track.statements, rig] for track, rig in pairs]
    return LayoutTrace(icon.name, tuple(zip((element.name for element in layout.elements), found, strict=True)))


def duration_s(icon: Icon, rig: Rig) -> float:
    """Time in s from a cue's start to its last corner; under current control it depends on the rig's holding current.

    >>> from thermicon.icons import load_library
    >>> duration_s(load_library("six-icons")["cooling-step"], Rig.load("thenar"))
    8.0
    """
    if icon.context.control == "current":
        if rig.thermode is not None:
            refuse_current(icon, f"rig {rig.name}")
        return float(icon.corners(steady_state(rig, "display", baseline_C(icon, rig))[0]).duration_s)
    return float(icon.corners(baseline_C(icon, rig)).duration_s)


def simulate_all(icons: Sequence[Icon], rig: Rig, *, end_s: float, rate_Hz: float = 100.0) -> tuple[Trace, ...]:
    """Traces of every cue of a set on one rig until a common end, as `simulate` gives them, in parallel."""
    module = rig.thermode is None and rig.controller is None
    alike = not rig.probes and module and all(icon.context.control != "current" for icon in icons)
    if not alike:
        tails = [end_s - duration_s(icon, rig) for icon in icons]
        return tuple(simulate(cue, rig, rate_Hz=rate_Hz, tail_s=tail) for cue, tail in zip(icons, tails, strict=True))
    plans, rows, bank = design_many(icons, rig, end_s), rows_until(end_s, rate_Hz), bank_of(rig)
    lanes = np.arange(len(icons), dtype=np.int64)
    intervals = cut(rows, plans[0].drive.time_s, np.array([plan.drive.current_A for plan in plans]), held=True)
    states = bank.states([plan.start_C for plan in plans])
    recorded = run_forward(bank, np.zeros_like(lanes), lanes, intervals, states)
    return tuple(
        _trace(rig, plan.drive, rows, icon.name, _target(icon, rig, rows), icon.context.control, plan.outcome,
               recorded[:, lane], ())
        for lane, (icon, plan) in enumerate(zip(icons, plans, strict=True))
    )  # fmt: skip


def _target(icon: Icon, rig: Rig, rows: Array) -> Array:
    if icon.context.control == "current":
        return np.full(len(rows), np.nan)
    return target_at(icon, baseline_C(icon, rig), rows)


@checked
def simulate_current(
    drive: Drive, rig: AnyRig = "thenar", *, rate_Hz: float = 100.0, start_C: Array | None = None
) -> Trace:
    """Simulate a given drive on a rig, from the steady state of its first current to its last row.

    Parameters
    ----------
    drive
        The current; beyond the driver's limits it is still played, and the trace reports it.
    rig
        A rig with a module, or the name or file of one.
    rate_Hz
        Rows of the trace per second.
    start_C
        Another state (nodes,) in °C to start from.

    Returns
    -------
    Trace
        A run without a target.

    Raises
    ------
    RigError
        Where the first current has no steady state, or the run is not physical.

    Examples
    --------
    >>> simulate_current(Drive([0, 1, 4], [0.08, 0.5, 0.5]), Rig.load("thenar"))
    Trace('drive' on thenar, 401 rows, 4 s, skin ... °C, 0.08 … 0.50 A)
    """
    rig, first = Rig.of(rig), float(drive.current_A[0])
    try:
        state = state_under_current(network_of(rig), first) if start_C is None else start_C
    except ArithmeticError as problem:
        raise RigError(f"rig {rig.name}: {problem}; begin the drive with a smaller current") from None
    rows = rows_until(float(drive.time_s[-1]), rate_Hz)
    return _run(rig, drive, state, rows, None, np.full(len(rows), np.nan), "drive", None)


def _run(
    rig: Rig, drive: Drive, state: Array, rows: Array, icon: str | None, target: Array, control: str,
    outcome: Outcome | None,
) -> Trace:  # fmt: skip
    bank, lane = bank_of(rig), np.zeros(1, dtype=np.int64)
    parts = between(rows, rig)
    fine = divided(rows, parts)
    intervals = cut(fine, drive.time_s, drive.current_A[np.newaxis], drive.held)
    recorded = run_forward(bank, lane, lane, intervals, bank.states([state]), extra=readings_of(rig))[:, 0]
    probes, others = recorded[: len(RECORDED), ::parts], recorded[len(RECORDED) :]
    return _trace(rig, drive, rows, icon, target, control, outcome, probes, sensed(rig, fine, others, parts))


def _trace(
    rig: Rig, drive: Drive, rows: Array, icon: str | None, target: Array, control: str, outcome: Outcome | None,
    probes: Array, own_probes: tuple[tuple[str, Array], ...],
) -> Trace:  # fmt: skip
    """The trace of RECORDED quantities (probes, rows); RigError where they are not physical."""
    temperatures = probes[: RECORDED.index("heat_flow_skin_W_per_m2")]
    if not (temperatures.min() > -ZERO_C_IN_K and temperatures.max() < HOTTEST_C):  # so it is for NaN
        possible = (temperatures > -ZERO_C_IN_K) & (temperatures < HOTTEST_C)
        at = int(np.argmin(possible.all(axis=0)))
        where = RECORDED[int(np.argmin(possible[:, at]))]
        raise RigError(
            f"rig {rig.name}: {where} leaves the physical range ({-ZERO_C_IN_K} … {HOTTEST_C:g} °C) at "
            f"{rows[at]:.2f} s, under {drive.at(rows)[at]:.4g} A; use less current, or check the rig"
        )
    current = drive.at(rows)
    values = dict(zip(RECORDED, (np.ascontiguousarray(probe) for probe in probes), strict=True))
    seebeck_V = rig.module.seebeck_V_per_K * (values["hot_plate_C"] - values["display_C"])
    voltage = seebeck_V + current * rig.module.resistance_ohm
    return Trace(
        icon=icon,
        driver_limits_A=(rig.driver.current_min_A, rig.driver.current_max_A),
        control=control,
        outcome=outcome,
        beyond=_beyond(rig, rows, current, voltage) if outcome is None else (),
        time_s=rows,
        current_A=current,
        voltage_V=voltage,
        target_C=target,
        probes=own_probes,
        **(of_rig(rig) | values),
    )


def _beyond(rig: Rig, rows: Array, current: Array, voltage: Array) -> tuple[str, ...]:
    driver, sentences = rig.driver, []
    low, high, volts = driver.current_min_A, driver.current_max_A, driver.voltage_limit_V
    for values, least, most, close, unit, gives in (
        (current, low, high, 1e-9, "A", f"{low:g} … {high:g} A"),
        (voltage, -volts, volts, 1e-6, "V", f"at most {volts:g} V"),
    ):
        excess = np.maximum(values - most, least - values)
        if excess.max() > close:
            worst, since = int(np.argmax(excess)), float(rows[int(np.argmax(excess > close))])
            needed = significant(float(values[worst]), most if values[worst] > 0 else least)[0]
            sentences.append(
                f"the drive needs {needed} {unit} at {rows[worst]:.2f} s; this driver gives {gives} (passed from "
                f"{since:.2f} s)"
            )
    return tuple(sentences)
