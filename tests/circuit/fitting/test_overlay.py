"""Measured beside simulated: the shift is found, rms and largest miss are right, and the figure shows both."""

from __future__ import annotations

import numpy as np
import pytest

from thermicon.circuit import Rig, Trace, simulate
from thermicon.circuit.fitting.laboratory import calibration_icon
from thermicon.circuit.fitting.log import Log, LogError
from thermicon.circuit.fitting.overlay import best_shift_s, overlay


@pytest.fixture(scope="module")
def trace(true_rig: Rig) -> Trace:
    return simulate(calibration_icon(), true_rig, rate_Hz=20.0)


@pytest.mark.parametrize("shift", [-1000.0, 0.37, 12.0])
def test_the_shift_of_a_clock_is_found(shift: float, log: Log, trace: Trace) -> None:
    late = Log.of("late.csv", {"time_s": log.time_s - shift, **dict(log.columns)})
    found = overlay(trace, late)
    assert found.shift_s == pytest.approx(shift, abs=0.01)
    display = next(each for each in found.columns if each.column == "display_C")
    assert display.rms == pytest.approx(
        float(np.std(display.difference) ** 2 + np.mean(display.difference) ** 2) ** 0.5
    )
    assert abs(display.largest) == pytest.approx(float(np.abs(display.difference).max()))
    assert "late.csv" in repr(found)


def test_a_shift_can_be_given_and_must_overlap(log: Log, trace: Trace) -> None:
    assert overlay(trace, log, shift_s=0.5).shift_s == 0.5
    with pytest.raises(LogError, match="no row at a time of the trace, 0 to 60 s, with a shift of 500 s; check time_s"):
        overlay(trace, log, shift_s=500.0)
    setpoints = Log.of("a.csv", {"time_s": log.time_s, "setpoint_C": log.column("display_C")})
    with pytest.raises(LogError, match=r"a.csv: no column in common with the trace of calibration; the log has set"):
        overlay(trace, setpoints)


def test_nothing_that_changes_gives_no_shift() -> None:
    time = np.arange(50.0)
    assert best_shift_s(time, np.ones(50), time, np.sin(time)) == (0.0, 0.0)
    assert best_shift_s(time, np.sin(time), time + 500.0, np.sin(time), most_s=1.0) == (0.0, 0.0)


def test_the_plot_of_a_trace_shows_what_was_measured(log: Log, trace: Trace) -> None:
    plain, both = trace.plot(), trace.plot(measured=log)
    assert len(both.lines) == len(plain.lines) + 1
    legend = both.get_legend()
    assert legend is not None
    texts = [text.get_text() for text in legend.get_texts()]
    assert any(text.startswith("display, measured\nrms 0.") and "largest" in text for text in texts)
    assert both.get_title().startswith("synthetic.csv, shifted by ")
