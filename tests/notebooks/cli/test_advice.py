"""What a report proposes was tried: the goal's number after it is what a ranking then says."""

import json
import re
import shlex
from pathlib import Path

import pytest

from thermicon.notebooks.report.choices import MOST_WAYS

from ..conftest import Cli

FEW = ("--people", "16", "--intervals", "8")
CLOSE = (
    "cue 1\nset s { site thenar; control display; baseline 32 °C }\n"
    "icon a { cool by 4 °C at 3 °C/s; hold for 3 s; return at 3 °C/s }\n"
    "icon b { cool by 5 °C at 2 °C/s; hold for 3 s; return at 3 °C/s }\n"
    "icon c { warm by 4 °C at 2 °C/s; hold for 3 s; return at 3 °C/s }\n"
)
WANTED = "felt-and-named >= {} % for 90 % of people"


@pytest.fixture
def close(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    Path("s.cue").write_text(CLOSE, encoding="utf-8")
    return "s.cue"


def said_next(text: str) -> list[str]:
    found = re.search(r"Next: ((?:.+\n)+?)(?:\n|$)", text + "\n")
    assert found is not None, text
    return shlex.split(" ".join(found[1].split()))[1:]


def numbers(text: str) -> list[tuple[float, float, str]]:
    """Before, after and verdict of every way that was tried."""
    lines = re.findall(r"Tried: .*?([\d.]+) % → (?:about )?([\d.]+) %, which (meets|misses)", " ".join(text.split()))
    return [(float(before), float(after), verdict) for before, after, verdict in lines]


@pytest.mark.parametrize(("least", "way", "tried"), [(80, "--edits", 2), (88.5, "--choose", 3)])
def test_next_takes_the_cheapest_way_that_meets_the_goal_with_the_number_that_was_said(
    cli: Cli, close: str, least: float, way: str, tried: int
) -> None:
    goal = ("--goal", WANTED.format(least))
    said = cli.good("rank", close, *FEW, *goal).stdout
    ways = numbers(said)
    assert [verdict for _, _, verdict in ways] == ["misses"] * (tried - 1) + ["meets"]
    assert f"people: {ways[0][0]} %, missed by" in said
    words = said_next(said)
    assert words[0] == "improve" and way in words and "-o" in words
    found = cli.good(*words)
    assert "Goal: NOT met" in found.stdout if way == "--edits" else "Goal: met" in found.stdout
    written = words[words.index("-o") + 1]
    assert said_next(found.stdout)[:2] == ["export", written]
    ranked = " ".join(cli.good("rank", written, *FEW, *goal).stdout.split())
    assert "Goal: met" in ranked and f"people: {ways[-1][1]} %" in ranked


def test_where_nothing_that_was_tried_meets_the_goal_the_report_says_so(cli: Cli, close: str) -> None:
    said = cli.good("rank", close, *FEW, "--goal", WANTED.format(99.9), "--json", "all.json").stdout
    ways, words = numbers(said), " ".join(said.split())
    assert [verdict for _, _, verdict in ways] == ["misses"] * MOST_WAYS
    tried = [each["way"] for each in json.loads(Path("all.json").read_text("utf-8"))["goal"]["tried"]]
    for kind in ("in ", "the best 2, ", "a contact of 18 cm²"):
        assert any(way.startswith(kind) for way in tried)
    assert f"farther from the goal: {len(tried) - MOST_WAYS} other way" in words
    assert "Nothing that was tried meets the goal." in words and "would help" not in words


def test_edits_are_written_with_their_effect_and_without_the_ranking_again(cli: Cli, close: str) -> None:
    found = cli.good("improve", close, *FEW, "-o", "edited.cue").stdout
    assert "most confused with" not in found
    effect = re.search(r"felt and named (\d+) % → (\d+) %", " ".join(found.split()))
    assert effect is not None and int(effect[2]) > int(effect[1])
    assert f"{effect[2]} % felt and named" in " ".join(cli.good("rank", "edited.cue", *FEW).stdout.split())
    assert said_next(found)[:2] == ["export", "edited.cue"]


def test_a_single_icon_has_nothing_to_edit_and_is_exported_as_it_is(cli: Cli, close: str) -> None:
    Path("one.cue").write_text("\n".join(CLOSE.splitlines()[:3]), encoding="utf-8")
    found = cli.good("improve", "one.cue", *FEW).stdout
    assert "There is no pair to edit." in found
    assert said_next(found)[:2] == ["export", "one.cue"]


def test_fewer_icons_keep_those_that_must_stay(cli: Cli, close: str) -> None:
    said = cli.good("improve", close, *FEW, "--choose", "3", "--must", "a", "--goal", WANTED.format(80)).stdout
    words = said_next(said)
    assert words[words.index("--choose") + 1] == "2" and words[words.index("--must") + 1] == "a"
    assert "Goal: met" in cli.good(*words).stdout


def test_edits_that_do_not_meet_the_goal_are_not_written(cli: Cli, close: str) -> None:
    said = cli("improve", close, *FEW, "--edits", "--goal", WANTED.format(88.5), "-o", "edited.cue")
    assert said.exit_code and not Path("edited.cue").exists()
    assert "no edit that was tried meets the goal, and no set was written" in said.stderr
    assert "--choose" in said_next(said.stdout)
