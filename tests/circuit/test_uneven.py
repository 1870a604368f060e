"""Functions over rows of time on uneven rows: updates of 1 ms among long holds, and a clock that begins at 1e5 s."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.circuit.surerig import sure_rig
from thermicon.circuit import Drive, Limits, Rig
from thermicon.circuit.fitting.between import noise_sd, one_phase, unknown_display
from thermicon.circuit.fitting.forward import predict
from thermicon.circuit.fitting.log import Log, LogError
from thermicon.circuit.fitting.overlay import aligned, overlay
from thermicon.circuit.fitting.runs import runs_of
from thermicon.circuit.safety.ensemble import Ensemble
from thermicon.circuit.safety.exposure import cem43_min, henriques
from thermicon.circuit.safety.sessionplay import held_A
from thermicon.circuit.safety.tally import WATCHED, Tally
from thermicon.circuit.safety.verdict import checks_of
from thermicon.circuit.solver.modes import modes_of
from thermicon.circuit.solver.simulate import simulate_current
from thermicon.icons import from_samples

Array = np.ndarray
LATE_S = 1e5
THENAR = Rig.load("thenar").with_(**{"driver.update_Hz": 1000})
EVEN = np.arange(25_001) / 1e3
PULSES = np.concatenate([[0.0], 10.0 + np.arange(9) / 1e3, 20.0 + np.arange(9) / 1e3, [25.0]])
"""Updates of 1 ms, twice eight, among holds of 10 s."""
PULSED = Drive(PULSES, [*[0.08, 1.5] * 4, 0.08, 0.08, *[-1.5, 1.4, -1.5, 0.08] * 2, 0.08, 0.08], held=True)
CORNERS_S, CORNERS_C = [0.0, 10.0, 10.003, 10.006, 20.0, 20.004, 25.0], [40.0, 40.0, 43.1, 43.5, 43.5, 41.0, 41.0]
LOGGED = Drive([0.0, 9.999, 10.006, 15.0, 15.291, 15.297, 25.0], [0.08, 0.6, -0.5, 0.3, 0.9, 0.08, 0.08], held=True)
DENSE = (np.abs(EVEN - 10.0) < 0.5) | (np.abs(EVEN - 15.0) < 0.3)
ROWS = EVEN[DENSE | (np.arange(len(EVEN)) % 400 == 0) | (EVEN == 25.0) | np.isin(EVEN, CORNERS_S)]
"""Rows of a logger that writes what changes in full, and else every 0.4 s."""


def log(time_s: Array, **columns: Array) -> Log:
    return Log.of("rows.csv", {"time_s": time_s, **columns})


def checks(clock_s: Array, shown_C: Array) -> list[float]:
    courses = dict.fromkeys(WATCHED, shown_C[np.newaxis])
    return [check.value for check in checks_of(Limits.shipped(), clock_s, courses)]


def fitted(clock_s: Array, shown_C: Array) -> Array:
    """Display and voltage as a fit predicts them, at rows that both logs have."""
    (run,) = runs_of([log(clock_s, current_A=current(clock_s), display_C=shown_C)], THENAR)
    assert run.begin_s == clock_s[0] and run.unknown is None
    return np.concatenate([predict(THENAR, run).at(column, ROWS) for column in ("display_C", "voltage_V")])


def phase(clock_s: Array, _: Array) -> Array:
    return one_phase(clock_s, current(clock_s), np.interp(clock_s - clock_s[0], [10.0, 10.4], [32.0, 34.0]))


def recorded(clock_s: Array, shown_C: Array) -> Array:
    corners = from_samples(clock_s, shown_C).corners()
    return np.interp(clock_s - clock_s[0], corners.time_s, corners.value)


def current(clock_s: Array) -> Array:
    return LOGGED.at(np.round(clock_s - clock_s[0], 6))


@pytest.mark.parametrize(
    ("result", "uneven_s", "within"),
    [
        (lambda clock_s, shown_C: [cem43_min(clock_s, shown_C)[-1], henriques(clock_s, shown_C)[-1]], CORNERS_S, 1e-9),
        (checks, CORNERS_S, 1e-4),
        (fitted, ROWS, 1e-3),
        (phase, ROWS, 0.02),
        (modes_of(Rig.load("tcs2")).at, ROWS, 1e-6),
        (recorded, ROWS, 0.02),
    ],
)
def test_uneven_rows_and_a_late_clock_give_what_even_rows_give(
    result: Callable[[Array, Array], Array], uneven_s: Array, within: float
) -> None:
    results = []
    for clock_s in (EVEN, EVEN + LATE_S, np.asarray(uneven_s), np.asarray(uneven_s) + LATE_S):
        time_s = clock_s - clock_s[0]
        values = np.asarray(result(clock_s, np.interp(time_s, CORNERS_S, CORNERS_C)))
        results.append(np.interp(ROWS, time_s, values) if len(values) == len(time_s) else values)
    for late in results[1:]:
        assert late == pytest.approx(results[0], abs=within)


@pytest.mark.parametrize("kind", [{}, {"bridge_A": 1.6, "averaged": True}])
def test_short_pulses_among_long_holds_are_judged_where_they_are(kind: dict[str, float]) -> None:
    """Rows are as close as the shortest update; of rows 10 ms apart none would see how fast the skin moves."""
    few = Ensemble.of(sure_rig("thenar"), **kind)  # type: ignore[arg-type]
    tallies = [Tally(Limits.shipped(), few.corners) for _ in range(2)]
    for tally, drive in zip(tallies, (PULSED, Drive(EVEN, PULSED.at(EVEN), held=True)), strict=True):
        for (rows, values), _ in few.play(drive, few.at_rest(0.08)):
            tally.add(rows, values)
    uneven, even = ([check.value for check in tally.checks()] for tally in tallies)
    assert uneven == pytest.approx(even, abs=1e-6)


def test_currents_between_uneven_rows_keep_their_charge() -> None:
    """A drive that is linear between rows, as means over updates of a driver and as codes of a device."""
    drive = Drive([0.0, 10.0, 10.001, 10.002, 20.0], [0.0, 0.1, 0.9, 0.1, 0.5])
    even = Drive(EVEN[:20_001], drive.at(EVEN[:20_001]))
    assert held_A(drive, 2000, 100.0) == pytest.approx(held_A(even, 2000, 100.0), abs=1e-9)
    assert held_A(drive, 2000, 100.0)[1000] == pytest.approx(0.18, abs=1e-3)
    traces = [simulate_current(one, THENAR) for one in (drive, even)]
    shown = [np.interp(EVEN[:20_000:100], trace.time_s, trace.display_C) for trace in traces]
    assert shown[0] == pytest.approx(shown[1], abs=1e-4)


def test_how_long_a_log_lasts_does_not_depend_on_when_it_began() -> None:
    """Four seconds are too short for a fit, and of a thousand those are fitted in which the drive changes."""
    parts, time_s = [], np.arange(20_000) / 20.0
    current, display = np.where(time_s < 900.0, 0.1, 0.2), np.where(time_s < 900.0, 32.0, 31.0)
    for clock_s in (time_s, time_s + LATE_S):
        with pytest.raises(LogError, match="is known for 4 s"):
            runs_of([log(clock_s[:81], current_A=time_s[:81], display_C=time_s[:81])])
        (whole,) = runs_of([log(clock_s[-4000:], current_A=current[-4000:], display_C=display[-4000:])])
        assert len(whole.time_s) == 4000, "of 200 s nothing is left out, though the drive changes late"
        (run,) = runs_of([log(clock_s, current_A=current, display_C=display)])
        begins_s = run.begin_s - clock_s[0], run.channels[0].time_s[0] - clock_s[0]
        parts.append(([*begins_s, run.time_s[-1]], run.notes))
    assert parts[0][0] == pytest.approx(parts[1][0]) and parts[0][1] == parts[1][1]
    assert parts[0][0][0] == pytest.approx(890.0)


def test_noise_is_told_from_slopes_between_rows_that_are_not_evenly_apart() -> None:
    random = np.random.default_rng(1)
    time_s = np.cumsum(random.choice([0.001, 0.4], 4000)) + LATE_S
    climb = 0.5 * (time_s - time_s[0])
    noisy = climb + random.normal(0.0, 0.002, 4000)
    assert noise_sd(time_s, noisy, 0.0) == pytest.approx(0.002, rel=0.1)
    assert unknown_display(time_s, climb)[1:-1].max() < 1e-6, "a straight line does not bend between its rows"


def test_a_log_of_another_clock_is_laid_where_it_belongs() -> None:
    trace = simulate_current(LOGGED, THENAR, rate_Hz=1000)
    current, display = LOGGED.at(ROWS), np.interp(ROWS, trace.time_s, trace.display_C)
    laid = overlay(trace, log(ROWS + LATE_S, current_A=current, display_C=display))
    assert laid.shift_s == pytest.approx(-LATE_S, abs=0.005)
    logs = log(ROWS + LATE_S, current_A=current), log(ROWS + 7.0, display_C=display)
    ((shift_s,),) = [run.shifts for run in aligned(THENAR, runs_of(logs, THENAR))]
    assert shift_s == pytest.approx(LATE_S - 7.0, abs=0.005)
