"""The source paper's records beside computed values, with its notebook."""

from pathlib import Path

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

from source_paper import studydraw
from source_paper.depths import resembles
from source_paper.dermis_course import dermis_course
from source_paper.insulated import Pad
from source_paper.paper import (
    coldest_display_C,
    controlled_cue,
    dermis_change,
    emulator_rig,
    miss_by_limit,
    printed,
    thermistors,
)
from source_paper.paper_differences import paper_differences, paper_table
from tests.peltier import heat_absorbed_W
from thermicon.circuit import Drive, Rig, simulate_current
from thermicon.circuit.solver.network import network_of
from thermicon.circuit.solver.steady import state_under_current
from thermicon.icons import load_library


def test_whichever_is_controlled_is_the_clean_step() -> None:
    for rig in (emulator_rig(), Rig.load("thenar")):
        wrong = controlled_cue(rig).distortions
        assert wrong["skin"][0] < 0.03 < 0.07 < wrong["skin"][1]
        assert wrong["display"][1] < 1e-4 < 0.07 < wrong["display"][0]


def test_each_miss_is_stated() -> None:
    free, cue = controlled_cue(), controlled_cue(Rig.load("shani2021"))
    titles = [studydraw.plot_controlled(trace).get_title(loc="left") for trace in (cue.skin, free.display)]
    assert titles[0].startswith("skin control; misses its target by 2.12 K at 2.00 s, limited by the current\nlimit")
    assert titles[1] == "display control; reached"


def test_the_limit_is_that_of_the_lowest_temperature_that_the_paper_states() -> None:
    claim, rig = printed().one("lowest contact temperature"), Rig.load("shani2021")
    held = rig.driver.current_max_A
    settled = simulate_current(Drive([0.0, 900.0], [held, held]), rig, rate_Hz=1.0).display_C[-1]
    assert claim.low <= settled <= claim.high
    assert settled == pytest.approx(coldest_display_C(rig), abs=1e-3)
    # the plates' energy balance with pencil: what the module absorbs comes through contact, epidermis and dermis
    net = network_of(rig)
    state = state_under_current(net, held)
    cold, hot = (net.read(state, name) for name in ("display_C", "hot_plate_C"))
    brought = (37.0 - cold) * 9e-4 / (5.4e-4 + 0.081e-3 / 0.24 + 2e-3 / 0.45)
    assert heat_absorbed_W(rig.module, held, cold, hot) == pytest.approx(brought, rel=1e-6)
    for other in (held - 0.1, held + 0.1):  # neither a tenth of an ampere less nor more is about 5 °C
        there = coldest_display_C(rig.with_(**{"driver.current_limit_A": other}))
        assert not claim.low <= there <= claim.high
    assert held == pytest.approx(10.0 * rig.driver.transconductance_A_per_V)
    assert rig.driver.transconductance_A_per_V == printed().one("driver gain").central


def test_the_miss_falls_with_the_current_limit() -> None:
    found = miss_by_limit()
    assert found.shipped_A == 1.0
    assert (np.diff(found.miss_K) < 1e-6).all()
    at = dict(zip(found.limit_A.tolist(), found.miss_K.tolist(), strict=True))
    assert at[1.5] == pytest.approx(0.73, abs=0.01)
    assert at[printed().one("module current").central] < 0.3
    assert found.reached == tuple(limit >= 2.0 for limit in found.limit_A)
    legend = studydraw.plot_miss(found).get_legend()
    said = [text.get_text() for text in legend.get_texts()]
    assert said == ["reached", "missed", "this rig's 1 A", "the module's own 1.85 A"]


def test_a_drive_that_only_cools_misses_the_return_by_about_4_K() -> None:
    (point,) = (point for point in paper_differences() if point.topic == "directions of current")
    assert "with currents of 0 A and more the skin misses by 4." in point.ours


def test_the_papers_dermis_numbers_belong_to_one_depth() -> None:
    seen = dermis_change()
    change = seen.depth_of_m(printed().one("dermis change").central)
    rate = seen.depth_of_rate_m(printed().one("dermis rate").central)
    assert change == pytest.approx(1.5e-3, abs=0.1e-3)
    assert rate == pytest.approx(change, abs=0.1e-3)
    assert seen.at(0.15e-3)[0] > 4.0
    assert np.isnan(seen.depth_of_m(100.0))
    assert studydraw.plot_dermis(seen).get_xlabel() == "depth (mm)"


def test_the_third_thermistor_depends_on_a_distance_nobody_printed() -> None:
    swings = [np.ptp(thermistors(lateral_m=lateral).trace.probe("3")) for lateral in (1e-3, 2e-3, 5e-3)]
    assert (np.diff(swings) < 0).all()
    found = thermistors()
    one, two = found.trace.probe("1"), found.trace.probe("2")
    assert np.array_equal(one, found.trace.display_C)
    assert two == pytest.approx((found.trace.skin_C + one) / 2, abs=1e-9)
    assert studydraw.plot_thermistors(found).get_ylabel() == "change (K)"


def test_the_account_is_made_of_sentences_with_numbers() -> None:
    points = paper_differences()
    assert [point.topic for point in points if point.agrees] == ["shape under control"]
    for point in points:
        assert "nan" not in repr(point)
        assert any(letter.isdigit() for letter in point.ours), point
        assert all(text.endswith(".") for text in (point.paper, point.ours, point.why)), point


def test_the_last_depth_changes_as_much_as_the_paper_says() -> None:
    course = dermis_course()
    largest = np.abs(course.change_K).max(axis=1)
    assert largest[-1] == pytest.approx(1.0, rel=0.05) and course.depth_m[-1] == pytest.approx(1.5e-3, rel=0.1)
    assert (np.diff(largest) < 0).all() and np.ptp(course.insulated_K) < largest[-1]
    assert len(studydraw.plot_dermis_course(course).get_lines()) == 5


def test_the_table_has_every_claim_with_its_verdict() -> None:
    table, points = paper_table(), paper_differences()
    assert list(table["claim"]) == [point.topic for point in points]
    assert list(table["verdict"] == "agrees") == [point.agrees for point in points]
    assert table["ours"].str[0].str.upper().equals(table["ours"].str[0])


STEP = load_library("six-icons")["cooling-step"]
THENAR = Rig.load("thenar")


def test_closely_joined_skin_resembles_its_own_depth() -> None:
    for depth_mm in (0.4, 1.1, 3.0):
        like = resembles(STEP, THENAR, Pad.of(0.02e-3, depth_mm * 1e-3), tail_s=10)
        assert like.depth_m == pytest.approx(depth_mm * 1e-3, rel=0.02)
        assert like.residual_K < 0.02


NOTEBOOK = Path(__file__).resolve().parent / "the_papers_figures.ipynb"


def test_it_is_thin_and_has_no_outputs() -> None:
    cells = nbformat.read(NOTEBOOK, as_version=4).cells
    code = [cell for cell in cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code)
    assert all(len(cell.source.splitlines()) <= 7 for cell in code)
    assert "def " not in "".join(cell.source for cell in code)


@pytest.mark.slow
def test_every_cell_runs_and_shows_something() -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    resources = {"metadata": {"path": str(NOTEBOOK.parent)}}
    NotebookClient(notebook, timeout=60, kernel_name="python3", resources=resources).execute()
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    kinds = [{kind for output in cell.outputs for kind in output.get("data", {"text": 1})} for cell in code]
    assert kinds[0] == set()
    assert [("image/png" in kind) for kind in kinds[1:]] == [*[True] * 7, False, False]
    assert "text/html" in kinds[8]
    table = code[9].outputs[0]["data"]["text/html"]
    assert all(words in table for words in ("change at the receptors", "mm from skin", "claim", "why", "differs"))
    assert len(nbformat.writes(notebook)) < 300_000
