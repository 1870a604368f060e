"""Drives or traces: rows, columns, files, pictures, tolerances, refusals."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.builders import messages
from thermicon.base.files.inputs import InputError
from thermicon.circuit import Drive, Rig, Trace, read_drive, simulate, simulate_current
from thermicon.circuit.rig.rigfile import RigError
from thermicon.circuit.solver.draw import plot_current
from thermicon.circuit.solver.drive import DriveError
from thermicon.circuit.solver.trace import judge, write_trace
from thermicon.icons import load_library

THENAR = Rig.load("thenar")
STEP = load_library("six-icons")["cooling-step"]


def test_a_drive_reads_between_its_rows() -> None:
    times = np.array([0.0, 0.5, 1.0, 1.5, 2.0])
    assert Drive([0, 1, 2], [0, 1, 0]).at(times).tolist() == [0, 0.5, 1, 0.5, 0]
    assert Drive([0, 1, 2], [0, 1, 0], held=True).at(times).tolist() == [0, 0, 1, 1, 0]


def test_a_drive_file(tmp_path: Path) -> None:
    path = tmp_path / "drive.csv"
    path.write_text("note,time_s,current_A\nstart,0,0.1\n\nend,4,0.5\n")
    drive = read_drive(path)
    assert (drive.time_s.tolist(), drive.current_A.tolist(), drive.held) == ([0, 4], [0.1, 0.5], False)
    assert read_drive(path, hold=True).held


def test_a_drive_past_the_driver_only_warns() -> None:
    trace = simulate_current(Drive([0, 1, 2, 3], [0, 0, 3, 3]), THENAR)
    asks, needs = trace.beyond
    assert asks == "the drive needs 3 A at 2.00 s; this driver gives -1.5 … 1.5 A (passed from 1.51 s)"
    assert needs.startswith("the drive needs 20.")
    assert needs.endswith("this driver gives at most 15 V (passed from 1.77 s)")
    assert not trace.reachable
    assert trace.reason == f"{asks}; {needs}"
    assert trace.current_A.max() == 3.0
    (just,) = simulate_current(Drive([0, 1, 2], [0, 1.5004, 1.5004]), THENAR).beyond
    assert just.startswith("the drive needs 1.5004 A at"), "more than it gives"


def test_a_run_that_is_not_physical_is_refused() -> None:
    with pytest.raises(
        RigError, match=r"leaves the physical range .* under 1e\+05 A; use less current, or check the rig"
    ):
        simulate_current(Drive([0, 1, 2], [0, 1e5, 1e5], held=True), THENAR)
    with pytest.raises(RigError, match=r"-5 A has no steady state on this rig.*begin the drive with"):
        simulate_current(Drive([0, 1], [-5, 0]), THENAR)


def test_a_jump_falls_on_its_own_instant_whatever_the_rows() -> None:
    drive = Drive([0, 0.1234, 1], [0.1, 0.9, 0.9], held=True)
    fine, coarse = (simulate_current(drive, THENAR, rate_Hz=rate) for rate in (1000, 10))
    assert coarse.display_C == pytest.approx(fine.display_C[::100], abs=2e-5)
    assert coarse.current_A.tolist() == [0.1, 0.1] + [0.9] * 9


@pytest.fixture(scope="module")
def trace() -> Trace:
    return simulate(STEP, THENAR)


def test_columns_and_rows(trace: Trace) -> None:
    frame = trace.to_frame()
    assert len(frame) == 801
    assert frame["time_s"].iloc[-1] == 8.0
    assert set(frame["icon"]) == {"cooling-step"}
    assert trace.heat_flow_skin_W_per_m2[0] == pytest.approx(-78.7, abs=0.1)
    off_the_grid = simulate_current(Drive([0, 0.255], [0.1, 0.1]), THENAR)
    assert off_the_grid.time_s[-2:].tolist() == [0.25, 0.255]


def test_a_tail_at_baseline_and_another_rate(trace: Trace) -> None:
    longer = simulate(STEP, THENAR, rate_Hz=40, tail_s=10)
    assert (len(longer.time_s), longer.time_s[-1]) == (721, 18.0)
    assert longer.display_C[-1] == pytest.approx(32.0, abs=1e-3)
    assert longer.display_C[:321:2] == pytest.approx(trace.display_C[::5], abs=2e-4)


def test_parquet_without_pyarrow_names_the_cure(trace: Trace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(InputError, match=r"a\.parquet.* pyarrow.*pip install .*pyarrow.*\.csv"):
        write_trace(trace, tmp_path / "a.parquet")
    assert not list(tmp_path.iterdir())


def test_plots_return_axes_with_units(trace: Trace) -> None:
    axes = trace.plot()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time (s)", "temperature (°C)")
    assert [text.get_text() for text in axes.get_legend().get_texts()] == [  # type: ignore[union-attr]
        "target (display)", "display", "skin surface", "cold receptors", "warm receptors",
    ]  # fmt: skip
    assert trace.plot(axes) is axes and trace._repr_html_().startswith("<svg")
    assert "(A)" in plot_current(trace).get_ylabel()


@pytest.mark.parametrize(
    ("rate", "tail", "words"), [(0, 0, "a rate of 0 Hz"), (1e9, 0, "rows; the limit is"), (100, -1, "a tail of -1 s")]
)
def test_impossible_rates_and_tails(rate: float, tail: float, words: str) -> None:
    with pytest.raises(RigError, match=words):
        simulate(STEP, THENAR, rate_Hz=rate, tail_s=tail)


def test_reached_has_a_stated_tolerance() -> None:
    target = np.zeros(100)
    brief, long_ = np.zeros(100), np.zeros(100)
    brief[:20], long_[:21] = 0.24, 0.24
    assert judge(target, brief, 0.01, ()).reached
    assert not judge(target, long_, 0.01, ()).reached
    assert judge(target, np.full(100, -0.1), 0.01, ()).reached
    brief[0] = -0.26
    outcome = judge(target, brief, 0.01, (("current limit", 0.0),))
    assert outcome.reason == "misses its target by 0.26 K at 0.01 s, limited by the current limit from 0.00 s"


MESSAGES = messages(__file__)


@pytest.mark.parametrize(("given", "words"), MESSAGES["drive"].items())
def test_an_impossible_drive_is_refused(given: str, words: str) -> None:
    with pytest.raises(DriveError, match=words):
        Drive(*json.loads(given))


@pytest.mark.parametrize(("text", "words"), MESSAGES["drive file"].items())
def test_a_bad_drive_file_says_where(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "drive.csv"
    path.write_text(text)
    with pytest.raises(DriveError, match=words):
        read_drive(path)
