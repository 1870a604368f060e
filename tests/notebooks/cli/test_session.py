"""A session by ``thermicon simulate``."""

import json
from pathlib import Path

import pytest

from tests.notebooks.conftest import Cli
from thermicon.circuit import Rig, SessionPlan, play_session
from thermicon.icons import read_cue
from thermicon.notebooks.figures.session_figure import session_figure

HOT = """cue 1
set hot { site thenar; control display; baseline 32 °C }
icon hot { warm by 9.5 °C at 3 °C/s; hold for 20 s; return at 3 °C/s }
"""

KEYS = (
    *("thermicon", "content_hash", "verdict", "reason", "findings", "what_it_is_not", "scenarios", "rig", "tracking"),
    *("seed", "gap_s", "duration_s", "rate_Hz", "dose_cem43_min", "dose_cem43_worst_min", "dose_cem43_limit_min"),
    *("henriques", "henriques_worst", "henriques_limit", "baseline_drift_K", "recovery_s", "energy_J", "rest_A"),
    *(f"{place}_{side}_C" for place in ("skin", "display", "hot_plate") for side in ("min", "max")),
    *(f"{place}_receptor_{side}_C" for place in ("cold", "warm") for side in ("min", "max")),
    *("checks", "uncertainty", "limits", "plays"),
    *("rig_changes", "rig_text"),
)


@pytest.fixture
def order(tmp_path: Path) -> Path:
    path = tmp_path / "order.txt"
    path.write_text("cool-step, warm-step # a pair\ncool-step\n", encoding="utf-8")
    return path


def test_an_order_is_played_and_reported(cli: Cli, two: Path, order: Path) -> None:
    said = cli.good("simulate", two, "--order", order)
    lines = said.stdout.splitlines()
    assert lines[0] == "3 plays in 42 s on thenar, 10 s between plays"
    assert lines[1].startswith("safety green in 195 scenarios")
    for words in ("  dose       0 min CEM43", "the limit of a session is 1", "  baseline   −0.", "within 0.1 K again "):
        assert words in said.stdout
    table = [line.split() for line in lines if "-step" in line]
    assert [(row[0], row[1], row[2], row[-1]) for row in table] == [
        ("1", "cool-step", "0", "green"),
        ("2", "warm-step", "18", "green"),
        ("3", "cool-step", "34", "green"),
    ]
    assert "not a medical or ethical clearance" in said.stderr


def test_the_json_has_the_keys_of_the_contract_and_its_order_can_be_played_again(
    cli: Cli, two: Path, tmp_path: Path
) -> None:
    out, order, again = tmp_path / "a.json", tmp_path / "order.txt", tmp_path / "b.json"
    for path in (out, order):
        cli.good("simulate", two, "--random", 3, "--gap", 4, "--seed", 5, "-o", path)
    found = json.loads(out.read_text(encoding="utf-8"))
    assert set(found) == set(KEYS)
    assert (found["verdict"], found["findings"], found["reason"]) == ("green", [], None)
    assert (found["seed"], found["gap_s"], found["tracking"], found["rig"]) == (5, 4.0, "replay", "thenar")
    plan = SessionPlan.shuffled(["cool-step", "warm-step"], 3, seed=5, gap_s=4.0)
    session = play_session(read_cue(two), plan, Rig.load("thenar"))
    assert [play["icon"] for play in found["plays"]] == list(plan.order)
    assert [play["start_s"] for play in found["plays"]] == [play.start_s for play in session.plays]
    assert found["baseline_drift_K"] == session.baseline_drift_K == max(session.to_frame()["drift_K"], key=abs)
    assert found["energy_J"] == pytest.approx(sum(play["energy_J"] for play in found["plays"]))
    assert {"icon", "start_s", "verdict"} <= set(found["plays"][0])
    assert found["rig_text"] == Rig.load("thenar").document
    cli.good("simulate", two, "--order", order, "--gap", 4, "-o", again)
    other = json.loads(again.read_text(encoding="utf-8"))
    assert other == {**found, "seed": None}


def test_an_unsafe_session_is_a_report_and_leaves_with_0(cli: Cli, tmp_path: Path) -> None:
    cue, order, out = tmp_path / "hot.cue", tmp_path / "order.txt", tmp_path / "out.json"
    cue.write_text(HOT, encoding="utf-8")
    order.write_text("hot\n" * 4, encoding="utf-8")
    said = cli.good("simulate", cue, "--order", order, "--gap", 2, "-o", out)
    assert "safety red" in said.stdout
    assert "NOT SAFE: skin surface reaches" in said.stdout
    found = json.loads(out.read_text(encoding="utf-8"))
    assert found["verdict"] == "red"
    assert found["reason"] == found["findings"][0]["text"]
    assert found["findings"][0]["severity"] == "hard"
    assert (found["plays"][0]["verdict"], found["plays"][-1]["verdict"]) == ("amber", "red")


def test_the_figure_shows_plays_and_limits(two: Path) -> None:
    session = play_session(read_cue(two), SessionPlan(("cool-step", "warm-step")), Rig.load("thenar"))
    figure = session_figure(session)
    changes, temperatures = figure.axes
    labels = {text.get_text() for ax in figure.axes for text in ax.get_legend().get_texts()}
    assert {"cooling in a play", "warming", "skin", "display", "cold receptor", "soft limit of skin, 40 °C"} <= labels
    assert [text.get_text() for text in changes.child_axes[0].get_xticklabels()] == ["cool-step", "warm-step"]
    assert temperatures.get_ylabel() == "temperature (°C)"
    assert len(changes.patches) >= 4
