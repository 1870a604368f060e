"""Drives and their files."""

from pathlib import Path

import numpy as np
import pytest

from thermicon.circuit import Drive, Rig, read_drive, simulate_current
from thermicon.circuit.rig.rigfile import RigError


def test_a_drive_reads_between_its_rows() -> None:
    times = np.array([0.0, 0.5, 1.0, 1.5, 2.0])
    assert Drive([0, 1, 2], [0, 1, 0]).at(times).tolist() == [0, 0.5, 1, 0.5, 0]
    assert Drive([0, 1, 2], [0, 1, 0], held=True).at(times).tolist() == [0, 0, 1, 1, 0]


def test_a_drive_file(tmp_path: Path) -> None:
    path = tmp_path / "drive.csv"
    path.write_text("note,time_s,current_A\nstart,0,0.1\n\nend,4,0.5\n")
    assert repr(read_drive(path)) == "Drive(2 rows, 4 s, 0.1 … 0.5 A, linear)"
    assert read_drive(path, hold=True).held


def test_a_drive_past_the_driver_only_warns() -> None:
    trace = simulate_current(Drive([0, 1, 2, 3], [0, 0, 3, 3]), Rig.load("thenar"))
    asks, needs = trace.beyond
    assert asks == "the drive needs 3 A at 2.00 s; this driver gives -1.5 … 1.5 A (passed from 1.51 s)"
    assert needs.startswith("the drive needs 20.")
    assert needs.endswith("this driver gives at most 15 V (passed from 1.77 s)")
    assert not trace.reachable
    assert trace.reason == f"{asks}; {needs}"
    assert trace.current_A.max() == 3.0


def test_a_drive_just_past_the_driver_reads_as_more_than_it_gives() -> None:
    trace = simulate_current(Drive([0, 1, 2], [0, 1.5004, 1.5004]), Rig.load("thenar"))
    assert trace.beyond[0].startswith("the drive needs 1.5004 A at")


def test_a_run_that_is_not_physical_is_refused() -> None:
    with pytest.raises(
        RigError, match=r"leaves the physical range .* under 1e\+05 A; use less current, or check the rig"
    ):
        simulate_current(Drive([0, 1, 2], [0, 1e5, 1e5], held=True), Rig.load("thenar"))


def test_a_first_current_without_a_steady_state_is_refused() -> None:
    with pytest.raises(RigError, match=r"-5 A has no steady state on this rig.*begin the drive with"):
        simulate_current(Drive([0, 1], [-5, 0]), Rig.load("thenar"))


def test_a_jump_falls_on_its_own_instant_whatever_the_rows() -> None:
    rig = Rig.load("thenar")
    drive = Drive([0, 0.1234, 1], [0.1, 0.9, 0.9], held=True)
    fine, coarse = (simulate_current(drive, rig, rate_Hz=rate) for rate in (1000, 10))
    assert coarse.display_C == pytest.approx(fine.display_C[::100], abs=2e-5)
    assert coarse.current_A.tolist() == [0.1, 0.1] + [0.9] * 9
