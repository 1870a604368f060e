"""``thermicon rank``: the JSON that scripts read and the table that people read."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from thermicon.circuit import Rig
from thermicon.icons import load_library
from thermicon.icons.number_text import percent_span
from thermicon.notebooks.cli import ranking
from thermicon.notebooks.report.rank_report import Step, next_step

Cli = Callable[..., Any]
TOP = {
    *("thermicon", "rig", "rig_changes", "seed", "people", "tracking", "by", "norm", "content_hash"),
    *("icons", "pairs", "confusion", "set", "chosen"),
}
ICON = {
    *("name", "detected_probability", "onset_s", "channel", "peak_change_K", "attack_K_per_s", "delay_s"),
    *("proportion_correct", "reachable", "safe", "reason", "cautions", "rules", "rules_score", "outside_data"),
}
PAIR = {"a", "b", "d_prime", "confused_probability", "why", "rules", "edit", "distinguishable_by_rules"}
SET = {
    *(
        "proportion_correct",
        "proportion_correct_interval",
        "information_bits",
        "information_bits_interval",
        "bits_per_s",
    ),
    *("information_bits_plugin", "trials", "worst_pair", "rules_disagree", "norm_sensitivity"),
    *("proportion_correct_interval_new_laboratory", "information_bits_interval_new_laboratory", "rules_score", "rules"),
}


@pytest.fixture
def ranked(cli: Cli, two: Path, tmp_path: Path) -> dict[str, Any]:
    out = tmp_path / "rank.json"
    said = cli("rank", two, "--people", 20, "--seed", 3, "--json", out)
    assert said.exit_code == 0, said.stderr
    text = out.read_text(encoding="utf-8")
    assert "NaN" not in text
    assert "Infinity" not in text
    found: dict[str, Any] = json.loads(text)
    return found


def test_the_json_has_the_promised_keys(ranked: dict[str, Any]) -> None:
    assert set(ranked) >= TOP
    assert (ranked["rig"], ranked["seed"], ranked["people"], ranked["norm"]) == ("thenar", 3, 20, "episodes")
    assert ranked["tracking"] == "display"  # what control display asks for
    for icon in ranked["icons"]:
        assert set(icon) >= ICON
        assert set(icon["peak_change_K"]) == {"cold_receptor", "warm_receptor"}
    for pair in ranked["pairs"]:
        assert set(pair) >= PAIR
    assert set(ranked["set"]) >= SET


@pytest.mark.slow
def test_rows_of_the_confusions_sum_to_one(ranked: dict[str, Any]) -> None:
    assert ranked["confusion"]["labels"] == ["cool-step", "warm-step"]
    for row in ranked["confusion"]["probability"]:
        assert sum(row) == pytest.approx(1.0, abs=1e-9)
        assert all(0 <= share <= 1 for share in row)


def test_the_table_reads_well_in_a_pipe(process: Cli, two: Path) -> None:
    said = process("rank", two, "--people", 20, "--details")
    assert said.exit_code == 0, said.stderr
    assert "\x1b" not in said.stdout
    lines = [line for line in said.stdout.splitlines() if not line.startswith("Next: ")]  # whole, to be copied
    assert max(map(len, lines)) <= 80
    for word in ("detected", "onset", "channel", "most confused with", "bits/s", "Worst pair: ", "48-trial experiment"):
        assert word in said.stdout
    assert "not measurements" in " ".join(said.stdout.split())


def test_what_is_asked_first_stands_in_twenty_lines(process: Cli) -> None:
    said = process("rank", "wave-confusions", "--people", 4, "--intervals", 0).stdout.splitlines()
    assert len(said) <= 20
    assert [line.split()[0] for line in said[2:6]] == [said[2].split()[0], said[3].split()[0], said[4].split()[0], "d′"]
    assert any(line.startswith("Next: thermicon improve wave-confusions --people 4 --intervals 0 ") for line in said)
    assert any(line.startswith("and ") and line.endswith(" more") for line in said)


@pytest.mark.parametrize(
    ("d_primes", "detected", "playable", "families", "step"),
    [
        ((3.0, 3.0, 3.0), 0.9, 3, False, Step("export", ("--to", "csv", "-o", "drives"))),
        ((1.0, 3.0, 3.0), 0.9, 3, False, Step("improve", ("--choose", "2"))),
        ((1.0, 3.0, 3.0), 0.9, 3, True, Step("improve")),
        ((1.0, 1.0, 1.0), 0.9, 3, False, Step("improve", ("--edits",))),
        ((1.0, 3.0, 3.0), 0.5, 3, False, Step("rank", ("--set", "contact.area_cm2=18"))),
        ((3.0, 3.0, 3.0), 0.9, 2, False, Step("improve", ("--choose", "2"))),
        ((3.0, 3.0, 3.0), 0.9, 0, False, Step("simulate")),
    ],
)
def test_the_next_command_is_chosen_by_what_was_found(
    d_primes: tuple[float, ...], detected: float, playable: int, families: bool, step: Step
) -> None:
    icons = [
        SimpleNamespace(name=name, playable=place < playable, detected_probability=detected)
        for place, name in enumerate("abc")
    ]
    names = (("a", "b"), ("a", "c"), ("b", "c"))
    pairs = [SimpleNamespace(a=a, b=b, d_prime=d) for (a, b), d in zip(names, d_primes, strict=True)]
    job = SimpleNamespace(icons=tuple(load_library("six-icons")), rig=Rig.load("thenar"))
    ranking: Any = SimpleNamespace(icons=icons, pairs=pairs, job=job)
    assert next_step(ranking, families) == step


def test_files_are_joined_into_one_set(cli: Cli, two: Path, tmp_path: Path) -> None:
    more = tmp_path / "more.cue"
    more.write_text(
        "cue 1\nset more { control skin; baseline 33 °C }\nicon slow { warm by 2 °C at 0.5 °C/s; return at 1 °C/s }\n",
        encoding="utf-8",
    )
    said = cli("rank", two, more, "--people", 5, "--intervals", 0, "--json", "-")
    assert said.exit_code == 0, said.stderr
    assert json.loads(said.stdout)["confusion"]["labels"] == ["cool-step", "warm-step", "slow"]
    assert said.stderr == (
        "warning: baselines differ: 32 °C in two.cue, 33 °C in more.cue; between them the skin must adapt again, "
        "which the model leaves out\n"
    )
    table = cli("rank", two, more, "--people", 5, "--intervals", 0).stdout
    assert table.startswith("Two for a test; more.cue\n")
    first, *_ = cli("rank", more, "--people", 5, "--intervals", 0).stdout.splitlines()
    assert "detected" in first, "a file without a title has none"


@pytest.mark.slow
def test_a_what_if_is_told_in_table_and_json(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "rank.json"
    options = ("--people", 2, "--norm", "naming", "--set", "driver.current_limit_A=0.3", "--json", out)
    said = cli("rank", two, *options, "--details")
    assert said.exit_code == 0, said.stderr
    assert json.loads(out.read_text(encoding="utf-8"))["rig_changes"] == ["driver.current_limit_A=0.3"]
    words = " ".join(said.stdout.split())
    assert "Predicted for 2 virtual people on the thenar rig with driver.current_limit_A=0.3 (seed 0, " in words
    assert "display tracking, naming norm). These are predictions of a model, not measurements." in words
    assert "cool-step is not reached: misses its target by " in words
    assert "; it is reached with its " in words
    assert f"wrote {out}" in said.stderr
    brief = cli("rank", two, *options[:2]).stdout
    assert brief.endswith("\n\nPredicted, not measured: 2 virtual people on the thenar rig. More: --details\n")


@pytest.mark.slow
def test_one_person_has_no_spread(cli: Cli, two: Path) -> None:
    said = cli("rank", two, "--people", 1, "--task", "trials=1", "--details")
    assert "95 % of people" not in said.stdout
    assert "% correct\n" in said.stdout
    assert " bits\n" in said.stdout
    assert "a 1-trial experiment would report" in said.stdout
    assert "95 % of people" in cli("rank", two, "--people", 2, "--details").stdout


def test_a_set_that_asks_too_much_says_all_that_is_wrong(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "hard.cue"
    path.write_text(
        "cue 1\nset s { control current }\n"
        "icon burn { to -3 A at 20 A/s; hold for 20 s; return at 20 A/s }\n"
        "icon jolt { to 1.6 A at 0.4 A/s; to 0.1 A at 0.4 A/s }\n",
        encoding="utf-8",
    )
    options = ("rank", path, "--people", 1, "--intervals", 0)
    words = " ".join(cli(*options, "--details").stdout.split())
    assert "burn is NOT SAFE and not reached: " in words
    assert "jolt is not reached: the drive needs 1.6 A" in words
    lines = cli(*options).stdout.splitlines()
    assert len(lines) <= 20
    assert "burn is NOT SAFE and not reached: " in " ".join(lines)
    assert any(line.endswith(" more notes: thermicon rank --details") for line in lines)
    assert f"Next: thermicon simulate {path}" in lines


@pytest.mark.slow
def test_soft_limits_are_one_line(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "cold.cue"
    cue = "{ cool by 12 °C at 2 °C/s; hold for 9 s; return at 2 °C/s }"
    path.write_text(f"cue 1\nset s {{ control display }}\nicon a {cue}\nicon b {cue}\n", encoding="utf-8")
    words = " ".join(cli("rank", path, "--people", 1, "--intervals", 0, "--details").stdout.split())
    assert "Caution: a, b exceed a soft safety limit: of a, skin surface reaches " in words
    assert words.count("skin surface") == 1
    assert "NOT SAFE" not in words


def test_rules_and_model_disagree_in_the_open(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "near.cue"
    cues = [
        f"icon i{k} {{ cool by {3 + 0.2 * k:.1f} °C at 3 °C/s; hold for 2 s; return at 3 °C/s }}\n" for k in range(5)
    ]
    path.write_text("cue 1\nset s { control display }\n" + "".join(cues), encoding="utf-8")
    out = tmp_path / "rank.json"
    words = " ".join(cli("rank", path, "--people", 2, "--intervals", 0, "--json", out, "--details").stdout.split())
    found = json.loads(out.read_text(encoding="utf-8"))["set"]["rules_disagree"]
    assert len(found) > 5
    assert words.index("Worst pair") < words.index("Rules of thumb and model disagree (rules compare two icons ")
    assert "while naming one needs memory" in words
    assert words.count("below the 2.563 criterion") == 5
    assert f"- and {len(found) - 5} more; --json lists all" in words


@pytest.mark.slow
def test_one_icon_has_nothing_to_be_confused_with(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "one.cue"
    path.write_text("cue 1\nicon only { warm by 2 °C at 1 °C/s; return at 1 °C/s }\n", encoding="utf-8")
    said = cli("rank", path, "--people", 5, "--intervals", 0)
    assert said.exit_code == 0, said.stderr
    assert "Worst pair" not in said.stdout
    assert " bits" not in said.stdout
    folder = tmp_path / "figures"
    said = cli("rank", path, "--people", 5, "--intervals", 0, "--figure", folder)
    assert said.stderr == f"wrote ranking.png, distance.png, confusion.png and 1 overview into {folder}\n"


def test_what_parameters_leave_open_is_told(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "rank.json"
    said = cli("rank", two, "--people", 8, "--intervals", 8, "--json", out, "--details")
    assert said.exit_code == 0, said.stderr
    found = json.loads(out.read_text(encoding="utf-8"))["set"]
    (low, high), (least, most) = (
        found[f"{k}_interval_new_laboratory"] for k in ("proportion_correct", "information_bits")
    )
    people = found["new_laboratory_people"]
    assert f"  - mean of {people} people in a new laboratory (95 %): {percent_span(low, high)}\n" in said.stdout
    assert f"  - in a new laboratory (95 %): {least:.2f}–{most:.2f} bits\n" in said.stdout
    assert "over the range" not in cli("rank", two, "--people", 8, "--intervals", 0).stdout


@pytest.mark.slow
def test_icons_outside_the_data_are_told(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "far.cue"
    cues = "".join(f"icon {n} {{ cool by {k} °C at 6 °C/s; return at 6 °C/s }}\n" for n, k in (("a", 4), ("b", 2)))
    path.write_text(f"cue 1\nset s {{ control skin }}\n{cues}", encoding="utf-8")
    options = ("--people", 1, "--intervals", 0, "--rig", "fingertip")
    words = " ".join(cli("rank", path, *options, "--details").stdout.split())
    assert "Outside the data: all icons: no detection threshold is on record for the fingertip: those of " in words
    assert "Outside the data" not in cli("rank", path, "--people", 1, "--intervals", 0).stdout


def test_a_first_ranking_says_once_on_a_terminal_that_it_compiles(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr("thermicon.circuit.compiled.kept_in", lambda: tmp_path)
    ranking._say_if_first()
    assert capsys.readouterr().err == ""
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    ranking._say_if_first()
    ranking._say_if_first()
    assert capsys.readouterr().err.count("compiling for this computer, once") == 1
