"""``thermicon improve``: what scripts read, what people read, and what is refused."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from thermicon.icons import parse

Cli = Callable[..., Any]
FEW = ("--people", 12, "--intervals", 0)
CHOSEN = ["icons", "objective", "value", "optimal", "bound", "at_own_range"]
EDIT = ["icon", "old", "new", "cost", "added_s", "d_prime", "recounted_share"]


@pytest.fixture(scope="module")
def families(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("search") / "families.cue"
    path.write_text(
        "cue 1\nset both { site thenar; control display; baseline 32 °C }\n"
        "icon dip(depth in 2..6 step 2 °C) { cool by depth at 3 °C/s; return at 3 °C/s }\n"
        "icon rise(height in 2..4 step 1 °C) { warm by height at 2 °C/s; return at 2 °C/s }\n",
        encoding="utf-8",
    )
    return path


@pytest.fixture
def ranked(cli: Cli, tmp_path: Path) -> Callable[..., dict[str, Any]]:
    def run(*more: object) -> dict[str, Any]:
        out = tmp_path / "rank.json"
        said = cli("improve", "six-icons", *FEW, *more, "-o", out)
        assert said.exit_code == 0, said.stderr
        found: dict[str, Any] = json.loads(out.read_text(encoding="utf-8"))
        return {**found, "stdout": said.stdout}

    return run


def test_a_choice_is_told_of_its_own_disagreements_and_of_a_goal_for_more(
    cli: Cli, ranked: Callable[..., dict[str, Any]]
) -> None:
    found = ranked("--choose", 3)
    chosen = set(found["chosen"]["icons"])
    others = [each["text"] for each in found["set"]["rules_disagree"] if not {each.get("a"), each.get("b")} <= chosen]
    assert others
    words = " ".join(found["stdout"].split())
    assert not any(text in words for text in others)
    said = cli("improve", "six-icons", *FEW, "--choose", 3, "--goal", "count 4")
    assert (said.exit_code, "it asks for 4 icons or more, and 3 are to be chosen" in said.stderr) == (1, True)


@pytest.mark.parametrize("objective", ["worst", "correct", "bits", "bits-per-s"])
def test_the_json_says_what_was_chosen(ranked: Callable[..., dict[str, Any]], objective: str) -> None:
    found = ranked("--choose", 3, "--objective", objective, "--must", "double-dip")
    chosen = found["chosen"]
    assert [key for key in chosen if key in CHOSEN] == CHOSEN
    assert len(chosen["icons"]) == 3
    assert "double-dip" in chosen["icons"]
    assert chosen["objective"] == objective
    assert chosen["optimal"] is True
    assert chosen["value"] == chosen["bound"]
    if objective == "worst":
        pairs = [p["d_prime"] for p in found["pairs"] if {p["a"], p["b"]} <= set(chosen["icons"])]
        assert chosen["value"] == min(pairs)
    assert "Best 3 of 6, by " in found["stdout"]
    assert "within the range of all 6: " in found["stdout"]
    assert "as a set of their own: " in found["stdout"]


def test_without_families_and_questions_every_close_pair_gets_an_edit(ranked: Callable[..., dict[str, Any]]) -> None:
    every = ranked()
    assert every["chosen"] is None
    edits = {(p["a"], p["b"]): p["edit"] for p in every["pairs"] if p["edit"] or p["no_edit"]}
    assert {(p["a"], p["b"]) for p in every["pairs"] if p["d_prime"] < 2.563} <= set(edits)
    edit = edits[tuple(every["set"]["worst_pair"])]
    assert list(edit) == EDIT
    assert f"heapest edit: in {edit['icon']}," in every["stdout"]


def test_limits_are_kept(ranked: Callable[..., dict[str, Any]]) -> None:
    chosen = ranked("--choose", 3, "--goal", "time <= 24 s, energy <= 22 J")["chosen"]
    assert chosen["total_s"] <= 24
    assert chosen["total_J"] <= 22


@pytest.mark.parametrize(
    ("options", "code", "told"),
    [
        (("--choose", 7), 1, "7 icons cannot be chosen: there are only 6 icons"),
        (("--choose", 3, "--must", "double-dop"), 1, "did you mean double-dip?"),
        (("--choose", 3, "--goal", "time <= 5 s"), 1, "stay within a total of 5 s"),
        (("--choose", 1), 2, "1 is outside 2 to 64"),
        (("--choose", 3, "--objective", "best"), 2, "'best' is not one of worst, correct, bits, bits-per-s"),
        (("--objective", "bits"), 2, "needs --choose K"),
        (("--must", "double-dip"), 2, "needs --choose K"),
        (("--choose", 3, "--up-to", 4), 2, "'--up-to': is a question of its own"),
        (("--edits", "--evaluations", 40), 2, "'--edits': edits icons as they are"),
        (("--choose", 3, "-o", "a.cue"), 1, "what this finds is written as .json, not .cue"),
    ],
)
def test_bad_choices(cli: Cli, options: tuple[object, ...], code: int, told: str) -> None:
    said = cli("improve", "six-icons", *FEW, *options)
    assert said.exit_code == code
    assert told in " ".join(said.stderr.replace("│", " ").split())


@pytest.mark.slow
def test_search_writes_a_set_that_can_be_ranked(cli: Cli, families: Path, tmp_path: Path) -> None:
    out = tmp_path / "found.cue"
    asked = ("improve", families, "--choose", 3, "--evaluations", 40, "--people", 6, "--seed", 4)
    said = cli(*asked, "-o", out)
    assert said.exit_code == 0, said.stderr
    assert f"wrote {out}" in said.stderr
    found = parse(out.read_text(encoding="utf-8"))
    assert len(found) == 3
    assert all("seed 4" in icon.metadata.tags for icon in found)
    told = " ".join(said.stdout.split())
    assert "before after" in told
    assert "predictions of a model, not measurements, and the set was optimised for that same model" in told
    assert cli(*asked, "-o", "-").stdout == out.read_text(encoding="utf-8")
    assert cli("check", out).exit_code == 0


@pytest.mark.parametrize(
    ("options", "code", "told"),
    [
        (("six-icons", "--evaluations", 40), 1, "nothing to search: the file has no family"),
        (("search-space", "--evaluations", 2), 2, "2 is outside 10 to 1000000"),
        (("search-space", "--objective", "all"), 2, "'all' is not one of worst, correct, bits, bits-per-s"),
        (("search-space", "-o", "found.txt"), 1, "what this finds is written as .cue, not .txt"),
        (("search-space", "--norm", "mean"), 2, "'mean' is not one of episodes, naming"),
    ],
)
def test_bad_searches(cli: Cli, options: tuple[object, ...], code: int, told: str) -> None:
    said = cli("improve", *options)
    assert said.exit_code == code
    assert told in " ".join(said.stderr.replace("│", " ").split())


@pytest.mark.slow
def test_search_says_what_a_goal_lacks_and_what_would_help(
    cli: Cli, families: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from thermicon.perception.selection import reach

    monkeypatch.setattr(reach, "EVALUATIONS", 10)
    monkeypatch.setattr(reach, "PEOPLE", 4)
    monkeypatch.setattr(reach, "FACTORS", reach.FACTORS[:1])
    options = ("--evaluations", 20, "--people", 6, "--intervals", 8)
    said = cli("improve", families, *options, "--goal", "correct >= 99.9 % for 95 % of people, time <= 60 s")
    assert said.exit_code == 0, said.stderr
    words = " ".join(said.stdout.split())
    assert "a new laboratory (95 %)" in words
    assert re.search(r"goal: correct for 95 % of people \d+\.\d % \d+\.\d %", words)
    assert "✗ correct >= 99.9 % for 95 % of people: " in words
    assert "✓ time <= 60 s: " in words
    assert "Not reached by this search" in words
    assert "contact.area_cm2=18" in words
    assert "what they maximised was proportion correct, in the last climb correct for 95 % of people" in words
    assert "held at the end" in words
    said = cli("improve", families, *options, "--goal", "count 2, time <= 60 s")
    assert "Goal: met" in said.stdout
    assert "Not reached" not in said.stdout
    said = cli("improve", families, *options[:4], "--intervals", 0, "--goal", "correct >= 9 % for 95 % of people")
    assert (said.exit_code, "needs draws of the posterior" in " ".join(said.stderr.split())) == (1, True)


@pytest.mark.parametrize(
    ("options", "code", "told"),
    [
        (
            ("--choose", 2, "--evaluations", 40, "--goal", "count 3"),
            1,
            "it asks for 3 icons or more, and 2 are to be chosen",
        ),
        (("--goal", "speed >= 5"), 1, "there is no quantity 'speed'"),
        (("--intervals", 1), 2, "1 draw has no interval"),
        (("--goal", "time <= 0.1 s"), 1, "the 2 with the least time take"),
    ],
)
def test_bad_limits_of_a_search(cli: Cli, families: Path, options: tuple[object, ...], code: int, told: str) -> None:
    said = cli("improve", families, *options)
    assert said.exit_code == code
    assert told in " ".join(said.stderr.replace("│", " ").split())


def test_a_row_for_each_number_of_icons(cli: Cli, tmp_path: Path) -> None:
    out, picture = tmp_path / "out.csv", tmp_path / "out.png"
    said = cli("improve", "six-icons", "--people", 4, "--up-to", 4, "--intervals", 4, "-o", out, "-o", picture)
    assert said.exit_code == 0, said.stderr
    frame = pd.read_csv(out)
    assert list(frame["icons"]) == [2, 3, 4]
    words = " ".join(said.stdout.split())
    assert "icons correct 95 % of people d′ bits time energy" in words
    assert "The 4: " + ", ".join(frame["names"][2].split()) in words
    assert picture.stat().st_size > 10_000


def test_a_goal_is_judged_at_every_number(cli: Cli) -> None:
    asked = ("--people", 4, "--intervals", 4, "--up-to", 3, "--goal", "correct >= 1 % for 95 % of people, time <= 17 s")
    words = " ".join(cli("improve", "six-icons", *asked).stdout.split())
    assert "time energy goal" in words
    assert "Goal: met by the best 2, the largest choice here ✓ correct >= 1 % for 95 % of people: " in words
    assert "✓ time <= 17 s: " in words
    assert "is about people and the uncertainty of the model together (4 draws), as in a goal" in words
    plain = " ".join(cli("improve", "six-icons", *asked[:2], "--intervals", 0, "--up-to", 2).stdout.split())
    assert "about people alone, at the nominal constants: milder than in a goal" in plain
    none = " ".join(cli("improve", "six-icons", *asked[:6], "--goal", "correct >= 99.9 %").stdout.split())
    assert "Goal: met by none of these choices; the best 2: ✗ correct >= 99.9 %: " in none
    assert "missed by" in none
    assert "In the way: " in none


@pytest.mark.parametrize(
    ("options", "code", "told"),
    [
        (("--up-to", 1), 2, "1 is outside 2 to 64"),
        (("--intervals", 1), 2, "1 draw has no interval"),
        (("--goal", "corect >= 9 %"), 1, "there is no quantity 'corect'"),
        (("--up-to", 4, "-o", "out.txt"), 1, "what this finds is written as .csv or .parquet or .png"),
    ],
)
def test_bad_tables(cli: Cli, options: tuple[object, ...], code: int, told: str) -> None:
    said = cli("improve", "six-icons", *options)
    assert said.exit_code == code
    assert told in " ".join(said.stderr.replace("│", " ").split())


def test_a_goal_is_reported_and_a_bad_one_stops_before_work(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "goal.json"
    said = cli("improve", two, "--people", 4, "--intervals", 8, "--goal", "correct >= 10 %, time <= 1 s", "-o", out)
    assert said.exit_code == 0, said.stderr
    assert "Goal: NOT met" in said.stdout
    assert "✓ correct >= 10 %: " in said.stdout
    assert "✗ time <= 1 s: " in said.stdout
    held = json.loads(out.read_text(encoding="utf-8"))["goal"]
    assert [part["met"] for part in held["parts"]] == [True, False]
    said = cli("improve", two, "--goal", "correct > 90")
    assert (said.exit_code, said.stdout) == (1, "")
    assert "correct lies in 0 to 100 %: write it as 90 %" in said.stderr
    said = cli("improve", two, "--people", 4, "--intervals", 0, "--goal", "correct >= 9 % for 95 % of people")
    assert said.exit_code == 1
    assert "needs draws of the posterior" in said.stderr
