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
LIMITS = Limits.shipped()
EVEN = np.arange(25_001) / 1e3
PULSES = np.concatenate([[0.0], 10.0 + np.arange(9) / 1e3, 20.0 + np.arange(9) / 1e3, [25.0]])
"""Updates of 1 ms, twice eight, among holds of 10 s."""
CORNERS_S, CORNERS_C = [0.0, 10.0, 10.003, 10.006, 20.0, 20.004, 25.0], [40.0, 40.0, 43.1, 43.5, 43.5, 41.0, 41.0]


def pulsed() -> Drive:
    current = np.full(len(PULSES), 0.08)
    current[1:9:2], current[10:18:2], current[11:18:4] = 1.5, -1.5, 1.4
    return Drive(PULSES, current, held=True)


def course(time_s: Array) -> Array:
    return np.interp(time_s, CORNERS_S, CORNERS_C)


def exposures(time_s: Array, begin_s: float) -> Array:
    return np.array([measure(time_s + begin_s, course(time_s))[-1] for measure in (cem43_min, henriques)])


def checks(time_s: Array, begin_s: float) -> Array:
    found = checks_of(LIMITS, time_s + begin_s, {name: course(time_s)[np.newaxis] for name in WATCHED})
    return np.array([check.value for check in found])


def fitted(time_s: Array, begin_s: float) -> Array:
    """Display and voltage as a fit predicts them, at rows that both logs have."""
    log = Log.of("a.csv", {"time_s": time_s + begin_s, "current_A": LOGGED.at(time_s), "display_C": course(time_s)})
    (run,) = runs_of([log], THENAR)
    assert run.begin_s == begin_s and run.unknown is None
    return np.concatenate([predict(THENAR, run).at(column, ROWS) for column in ("display_C", "voltage_V")])


def phase(time_s: Array, begin_s: float) -> Array:
    shown = np.interp(time_s, [0.0, 10.0, 10.4, 25.0], [32.0, 32.0, 34.0, 34.0])
    return np.interp(ROWS, time_s, one_phase(time_s + begin_s, LOGGED.at(time_s), shown))


def recorded(time_s: Array, begin_s: float) -> Array:
    corners = from_samples(time_s + begin_s, course(time_s)).corners()
    return np.interp(ROWS, corners.time_s, corners.value)


def modes(time_s: Array, begin_s: float) -> Array:
    return np.interp(ROWS, time_s, modes_of(Rig.load("tcs2")).at(time_s + begin_s, course(time_s)))


LOGGED = Drive([0.0, 9.999, 10.006, 15.0, 15.05, 25.0], [0.08, 0.6, -0.5, 0.3, 0.08, 0.08], held=True)
DENSE = (np.abs(EVEN - 10.0) < 0.5) | (np.abs(EVEN - 15.0) < 0.3)
ROWS = EVEN[DENSE | (np.arange(len(EVEN)) % 400 == 0) | (EVEN == 25.0) | np.isin(EVEN, CORNERS_S)]
"""Rows of a logger that writes what changes in full, and else every 0.4 s."""


@pytest.mark.parametrize(
    ("result", "uneven_s", "within"),
    [
        (exposures, CORNERS_S, 1e-9),
        (checks, CORNERS_S, 1e-4),
        (fitted, ROWS, 1e-3),
        (phase, ROWS, 0.02),
        (modes, ROWS, 1e-6),
        (recorded, ROWS, 0.02),
    ],
)
def test_uneven_rows_and_a_late_clock_give_what_even_rows_give(
    result: Callable[[Array, float], Array], uneven_s: Array, within: float
) -> None:
    expected = result(EVEN, 0.0)
    for time_s, begin_s in ((np.asarray(uneven_s), 0.0), (np.asarray(uneven_s), LATE_S), (EVEN, LATE_S)):
        assert result(time_s, begin_s) == pytest.approx(expected, abs=within), (len(time_s), begin_s)


@pytest.mark.parametrize("kind", [{}, {"bridge_A": 1.6, "averaged": True}])
def test_short_pulses_among_long_holds_are_judged_where_they_are(kind: dict[str, float]) -> None:
    """Rows are as close as the shortest update; of rows 10 ms apart none would see how fast the skin moves."""
    few = Ensemble.of(sure_rig("thenar"), **kind)  # type: ignore[arg-type]
    found = []
    for drive in (pulsed(), Drive(EVEN, pulsed().at(EVEN), held=True)):
        tally = Tally(LIMITS, few.corners)
        for (rows, values), _ in few.play(drive, few.at_rest(0.08)):
            tally.add(rows, values)
        found.append([check.value for check in tally.checks()])
    assert found[0] == pytest.approx(found[1], abs=1e-6)


def test_currents_between_uneven_rows_keep_their_charge() -> None:
    """A drive that is linear between rows, as means over updates of a driver and as codes of a device."""
    drive = Drive([0.0, 10.0, 10.001, 10.002, 20.0], [0.0, 0.1, 0.9, 0.1, 0.5])
    even_s = np.arange(20_001) / 1e3
    even = Drive(even_s, drive.at(even_s))
    assert held_A(drive, 2000, 100.0) == pytest.approx(held_A(even, 2000, 100.0), abs=1e-9)
    assert held_A(drive, 2000, 100.0)[1000] == pytest.approx(0.18, abs=1e-3)
    rows = np.arange(0.0, 20.0, 0.1)
    shown = [
        np.interp(rows, trace.time_s, trace.display_C) for trace in (simulate_current(d, THENAR) for d in (drive, even))
    ]
    assert shown[0] == pytest.approx(shown[1], abs=1e-4)


def test_how_long_a_log_lasts_does_not_depend_on_when_it_began() -> None:
    """Four seconds are too short for a fit, and of a thousand those are fitted in which the drive changes."""
    parts, time_s = [], np.arange(20_000) / 20.0
    columns = {"current_A": np.where(time_s < 900.0, 0.1, 0.2), "display_C": np.where(time_s < 900.0, 32.0, 31.0)}
    for begin_s in (0.0, LATE_S):
        short = {"time_s": time_s[:81] + begin_s, "current_A": time_s[:81], "display_C": time_s[:81]}
        with pytest.raises(LogError, match="is known for 4 s"):
            runs_of([Log.of("short.csv", short)])
        late = {name: values[-4000:] for name, values in columns.items()}
        (whole,) = runs_of([Log.of("whole.csv", {"time_s": time_s[-4000:] + begin_s, **late})])
        assert len(whole.time_s) == 4000, "of 200 s nothing is left out, though the drive changes late"
        (run,) = runs_of([Log.of("long.csv", {"time_s": time_s + begin_s, **columns})])
        parts.append((run.begin_s - begin_s, run.time_s[-1], run.channels[0].time_s[0] - begin_s, *run.notes))
    assert parts[0][:3] == pytest.approx(parts[1][:3])
    assert parts[0][0] == pytest.approx(890.0) and parts[0][3:] == parts[1][3:]


def test_noise_is_told_from_slopes_between_rows_that_are_not_evenly_apart() -> None:
    random = np.random.default_rng(1)
    time_s = np.cumsum(random.choice([0.001, 0.4], 4000)) + LATE_S
    climb = 0.5 * (time_s - time_s[0])
    noisy = climb + random.normal(0.0, 0.002, 4000)
    assert noise_sd(time_s, noisy, 0.0) == pytest.approx(0.002, rel=0.1)
    assert unknown_display(time_s, climb)[1:-1].max() < 1e-6, "a straight line does not bend between its rows"


def test_a_log_of_another_clock_is_laid_where_it_belongs() -> None:
    drive = Drive(LOGGED.time_s, LOGGED.current_A, held=True)
    trace = simulate_current(drive, THENAR, rate_Hz=1000)
    columns = {"current_A": drive.at(ROWS), "display_C": np.interp(ROWS, trace.time_s, trace.display_C)}
    found = overlay(trace, Log.of("rows.csv", {"time_s": ROWS + LATE_S, **columns}))
    assert found.shift_s == pytest.approx(-LATE_S, abs=0.005)
    run = Log.of("drive.csv", {"time_s": ROWS + LATE_S, "current_A": columns["current_A"]})
    meter = Log.of("meter.csv", {"time_s": ROWS + 7.0, "display_C": columns["display_C"]})
    ((shift_s,),) = [run.shifts for run in aligned(THENAR, runs_of([run, meter], THENAR))]
    assert shift_s == pytest.approx(LATE_S - 7.0, abs=0.005)
