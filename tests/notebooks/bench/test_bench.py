"""The benchmark: times are of what they say, peers solve the same circuit, and the page has every number."""

import re
import time
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from thermicon.circuit import Rig, simulate_current
from thermicon.notebooks.bench import command
from thermicon.notebooks.bench.machine import machine_facts
from thermicon.notebooks.bench.measure import Timing, command_timed, timed
from thermicon.notebooks.bench.page import duration, growth_figure, page
from thermicon.notebooks.bench.peers import CORNERS, END_S, scipy_run
from thermicon.notebooks.bench.result import BenchResult, Curve, Entry, Section
from thermicon.notebooks.bench.roofline import roofline_section
from thermicon.notebooks.cli.main import app
from thermicon.notebooks.pages.blocks import as_markdown

THREE = Timing((0.1, 0.3, 0.2), (0.1, 0.15, 0.12))
CURVE = Curve("One cue over nodes", "nodes", (10, 20), (THREE, THREE.over(2)))
RESULT = BenchResult(
    (("processor", "a test"),), (Section("One cue", "About it.", (Entry("ours", THREE, 12.34, "theirs"),)),), (CURVE,)
)


def test_a_timing_has_medians_and_shares() -> None:
    assert (THREE.median_s, THREE.processor_s) == (0.2, 0.12)
    assert THREE.over(2).seconds == (0.05, 0.15, 0.1)
    with pytest.raises(ValueError, match="an elapsed and a processor time of each run"):
        Timing((), ())


def test_what_the_machine_allows_is_less_than_what_is_measured() -> None:
    call, batch = Timing((1e-3,), (1e-3,)), Timing((4e-4,), (4e-4,))
    section = roofline_section(call, batch, nodes=51, steps=3000)
    waits, least_call, _, passes, least_lane, _ = (entry.timing.processor_s for entry in section.entries)
    assert least_call == pytest.approx(51 * 3000 * waits)
    assert least_lane == pytest.approx(2 * 51 * 3000 * passes)
    assert 1e-10 < waits < 2e-8, "four cycles of a processor"
    assert passes < 1e-8
    assert section.entries[2].times == pytest.approx(1e-3 / least_call)


def test_a_function_is_warm_before_it_is_timed_and_not_run_beyond_its_budget() -> None:
    runs: list[int] = []
    assert len(timed(lambda: (runs.append(1), time.sleep(0.06)), most=4).seconds) == 4
    assert len(runs) == 6
    quick = timed(lambda: runs.append(1), most=2)
    assert len(runs) > 6 + 2 * 1000
    assert quick.median_s < 1e-4
    assert len(timed(lambda: sum(range(200_000)), most=100, budget_s=1e-9).seconds) == 1


@pytest.mark.slow
def test_processor_time_includes_that_of_a_command() -> None:
    took = command_timed(["--version"], 1)
    assert took.processor_s > 0.01
    with pytest.raises(RuntimeError, match=r"thermicon check .* ended with 1: .*no-such-file"):
        command_timed(["check", "no-such-file.cue"], 1)


def test_scipy_solves_the_same_circuit() -> None:
    rig = Rig.load("thenar")
    theirs, ours = scipy_run(rig), simulate_current(CORNERS, rig)
    assert theirs.shape[1] == len(ours.time_s) == round(END_S * 100) + 1
    assert np.abs(theirs[1] - ours.display_C).max() < 0.05
    assert np.abs(theirs[0] - ours.hot_plate_C).max() < 0.05


def test_growth_is_the_exponent_of_the_last_two_sizes() -> None:
    assert CURVE.growth == pytest.approx(-1.0)


@pytest.mark.parametrize(("seconds", "text"), [(2.5, "2.50 s"), (0.0456, "45.6 ms"), (2.5e-7, "250 ns")])
def test_durations_have_a_unit_that_suits_them(seconds: float, text: str) -> None:
    assert duration(seconds) == text


def test_the_page_has_machine_figures_and_curves() -> None:
    text = as_markdown(page(RESULT))
    assert "| processor | a test |" in text
    assert "| ours | 200 ms | 100 ms to 300 ms | 3 | 120 ms | 12 | theirs |" in text
    assert "exponent -1.00" in text
    assert "| One cue over nodes | 20 nodes | 100 ms | 60.0 ms |" in text
    assert sum(ax.get_visible() for ax in growth_figure(RESULT.curves).axes) == 1


def test_the_command_prints_tables_or_writes_a_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[bool] = []

    def measured(short: bool) -> BenchResult:
        asked.append(short)
        return RESULT

    monkeypatch.setattr(command, "measured", measured)
    printed = CliRunner().invoke(app, ["bench"])
    assert printed.exit_code == 0
    assert re.search(r"ours +200 ms", printed.output)
    written = CliRunner().invoke(app, ["bench", "--full", "-o", str(tmp_path / "page")])
    assert written.exit_code == 0
    assert asked == [True, False]
    folder = tmp_path / "page"
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    assert names == ["figures/growth.png", "speed.html", "speed.md"]
    assert "data:image/png" in (folder / "speed.html").read_text(encoding="utf-8")


def test_a_file_in_place_of_the_folder_is_refused_before_anything_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(command, "measured", None)  # would fail if it were called
    file = tmp_path / "page"
    file.write_text("mine", encoding="utf-8")
    refused = CliRunner().invoke(app, ["bench", "-o", str(file)])
    assert refused.exit_code == 1
    assert "is a file; give a folder" in refused.output
    assert file.read_text(encoding="utf-8") == "mine"


def test_the_machine_is_described() -> None:
    facts = dict(machine_facts())
    assert {"processor", "numpy", "numba", "ngspice"} <= set(facts)
    assert re.search(r"\d+ cores$", facts["processor"])
