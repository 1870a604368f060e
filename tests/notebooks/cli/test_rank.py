"""``thermicon rank`` at the command line."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
import typer

from tests.builders import few_draws
from thermicon.base.words.number_text import percent_span
from thermicon.notebooks.cli import ranking
from thermicon.notebooks.cli.options import CrowdOptions, RigOptions, commands
from thermicon.notebooks.report.following import after_ranking
from thermicon.perception import rank
from thermicon.perception.observer.observer import DATA

Cli = Callable[..., Any]
PROMISED = {
    "top": "thermicon rig rig_changes seed people tracking by memory content_hash icons pairs confusion set chosen",
    "icon": "name detected_probability onset_s channel peak_change_K attack_K_per_s delay_s proportion_correct "
    "reachable safe reason cautions rules rules_score outside_data",
    "pair": "a b d_prime confused_probability why rules edit distinguishable_by_rules",
    "set": "proportion_correct proportion_correct_interval information_bits information_bits_interval bits_per_s "
    "information_bits_plugin trials worst_pair rules_disagree proportion_correct_by_memory rules_score rules "
    "proportion_correct_interval_new_laboratory information_bits_interval_new_laboratory",
}
TOP, ICON, PAIR, SET = ({*words.split()} for words in PROMISED.values())


@pytest.fixture
def records(tmp_path: Path) -> Path:
    own = tmp_path / "lab.toml"
    own.write_bytes((DATA / "observer.toml").read_bytes())
    return own


def test_the_json_has_the_promised_keys_and_the_details_its_numbers(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "rank.json"
    said = cli.good("rank", two, "--people", 8, "--seed", 3, "--intervals", 8, "--json", out, "--details")
    text = out.read_text(encoding="utf-8")
    assert "NaN" not in text and "Infinity" not in text
    ranked = json.loads(text)
    assert set(ranked) >= TOP
    assert (ranked["rig"], ranked["seed"], ranked["people"], ranked["memory"]) == ("thenar", 3, 8, "both")
    assert ranked["tracking"] == "display"  # what control display asks for
    for icon in ranked["icons"]:
        assert set(icon) >= ICON
        assert set(icon["peak_change_K"]) == {"cold_receptor", "warm_receptor"}
    assert all(set(pair) >= PAIR for pair in ranked["pairs"])
    found = ranked["set"]
    assert set(found) >= SET
    (low, high), named, (least, most) = (
        found[f"{k}_interval_new_laboratory"] for k in ("felt_and_named", "proportion_correct", "information_bits")
    )
    people = found["new_laboratory_people"]
    both = f"{percent_span(low, high)}; named: {percent_span(*named)}"
    assert f"- mean of {people} people in a new laboratory (95 %): {both}" in " ".join(said.stdout.split())
    assert f"  - in a new laboratory (95 %): {least:.2f}–{most:.2f} bits\n" in said.stdout
    assert "48-trial experiment" in said.stdout
    assert max(len(line) for line in said.stdout.splitlines() if not line.startswith("Next: ")) <= 80


def test_draws_too_few_for_an_interval_say_what_they_hold(cli: Cli) -> None:
    few, enough = (
        " ".join(cli.good("rank", "wave-confusions", "--people", 4, "--intervals", n).stdout.split()) for n in (38, 39)
    )
    assert "38 draws are too few for 95 %: they hold at most 94 %." in few and "too few" not in enough


def test_what_is_asked_first_stands_in_a_few_lines(process: Cli) -> None:
    said = process("rank", "wave-confusions", "--people", 4, "--intervals", 0).stdout.splitlines()
    assert len(said) <= 21
    assert "\x1b" not in "".join(said)
    shown = [
        next(k for k, line in enumerate(said) if words in line) for words in ("felt and named", "bits", "detected")
    ]
    assert shown == sorted(shown) and said[shown[-1] + 1].startswith("d′")
    assert any(line.startswith("Next: thermicon improve wave-confusions --people 4 --intervals 0 ") for line in said)
    more = next(k for k, line in enumerate(said) if line.split()[:3] == ["and", "7", "more"])
    least = min(rank("wave-confusions", people=4, parameters=0).icons, key=lambda icon: icon.felt_and_named)
    assert said[more + 1].split()[0] == least.name, "the icon that is in the way stays"


def test_rules_of_thumb_score_a_set_without_the_model(cli: Cli) -> None:
    said = " ".join(cli.good("rank", "six-icons", "--by", "rules", "--people", 4).stdout.split())
    assert "warming-step 100 % 3 of 3 5 of 5 3.01 ×" in said
    assert "15 of 15 pairs distinguishable by the rules" in said
    assert "rate of change (ROC) at the receptor (cold): 1.12 K/s against at least 0.1 K/s: passes" in said
    assert said.index("cooling-step 100") < said.index("double-dip 100") < said.index("warming-step 100")
    assert "worst pair, warming-step and linear-warming: rate ratio" in said
    assert "detected" not in said


@pytest.mark.parametrize(
    ("d_prime", "said"),
    [
        (2.57, "thermicon export 'my icons.cue' --set contact.area_cm2=9 --to csv -o drives"),
        (2.5, "thermicon improve 'my icons.cue' --people 7 --set contact.area_cm2=9 --edits -o edited.cue"),
    ],
)
def test_the_next_command_is_chosen_by_what_was_found(d_prime: float, said: str) -> None:
    pairs = (SimpleNamespace(d_prime=9.0), SimpleNamespace(d_prime=d_prime))
    icons = tuple(SimpleNamespace(name=name, safe=True, reachable=True) for name in "abc")
    set_ = SimpleNamespace(
        pairs=pairs, icons=icons, felt=SimpleNamespace(detected=np.array([0.9, 0.8, 0.7])), elements=()
    )
    found: Any = SimpleNamespace(ranking=set_, goal=None, edits={})
    rig, crowd = RigOptions(set=["contact.area_cm2=9"]), CrowdOptions(people=7)
    assert after_ranking(found, commands(["my icons.cue"], rig, crowd)) == said


@pytest.mark.parametrize(
    ("d_prime", "detected", "said"),
    [
        (2.57, 0.51, "thermicon export a.cue --to csv -o drives"),
        (2.5, 0.51, "change a or b, then thermicon rank a.cue"),
        (2.57, 0.49, "write b larger, then thermicon rank a.cue"),
    ],
)
def test_icons_on_several_elements_are_changed_by_hand_or_exported(d_prime: float, detected: float, said: str) -> None:
    pair = SimpleNamespace(d_prime=d_prime, a="a", b="b")
    icons = tuple(
        SimpleNamespace(name=name, safe=True, reachable=True, detected_probability=felt)
        for name, felt in (("a", 0.9), ("b", detected))
    )
    set_ = SimpleNamespace(
        pairs=(pair,), worst=pair, icons=icons, felt=SimpleNamespace(detected=np.array([0.9, detected])), elements="lr"
    )
    found: Any = SimpleNamespace(ranking=set_, goal=None, edits={})
    assert after_ranking(found, commands(["a.cue"], RigOptions(), CrowdOptions())) == said


def test_files_are_joined_into_one_set(cli: Cli, two: Path, tmp_path: Path) -> None:
    more = tmp_path / "more.cue"
    head = "cue 1\nset more { site thenar; control display; baseline 32 °C }\n"
    more.write_text(head + "icon slow { warm by 2 °C at 0.5 °C/s; return at 1 °C/s }\n", encoding="utf-8")
    said = cli.good("rank", two, more, "--people", 5, "--intervals", 0)
    assert said.stdout.startswith("Two for a test; more.cue\n")
    for name in ("cool-step", "warm-step", "slow"):
        assert f"\n{name} " in said.stdout
    first, *_ = cli("rank", more, "--people", 5, "--intervals", 0).stdout.splitlines()
    assert "detected" in first, "a file without a title has none"
    more.write_text(more.read_text(encoding="utf-8").replace("32", "33"), encoding="utf-8")
    said = cli("rank", two, more)
    assert said.exit_code == 1
    assert "more.cue has baseline 33.0, not 32.0 as in" in said.stderr


def test_an_icon_that_is_not_reached_is_in_the_way_and_says_its_lines_to_change(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "fast.cue"
    path.write_text(
        "cue 1\nset s { site thenar; control display; baseline 32 °C }\n"
        "icon fast { cool by 6 °C at 60 °C/s; hold for 3 s; return at 3 °C/s }\n"
        "icon slow { cool by 6 °C at 3 °C/s; hold for 3 s; return at 3 °C/s }\n"
        "icon warm { warm by 4 °C at 2 °C/s; hold for 3 s; return at 2 °C/s }\n",
        encoding="utf-8",
    )
    said = " ".join(cli.good("rank", path, "--people", 8, "--intervals", 0, "--goal", "named >= 99.9 %").stdout.split())
    assert "In the way: fast and slow are confused most" in said
    assert "worst pair that can be played: slow and warm" in said
    assert "Next: change the lines of fast as said below, then thermicon rank" in said
    assert "cool by 6 °C at 60 °C/s → cool by " in said


def test_a_set_that_asks_too_much_says_the_worst_in_twenty_lines(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "hard.cue"
    path.write_text(
        "cue 1\nset s { control current }\n"
        "icon burn { to -3 A at 20 A/s; hold for 20 s; return at 20 A/s }\n"
        "icon jolt { to 1.6 A at 0.4 A/s; to 0.1 A at 0.4 A/s }\n",
        encoding="utf-8",
    )
    lines = cli("rank", path, "--people", 1, "--intervals", 0).stdout.splitlines()
    assert len(lines) <= 23
    assert "burn is NOT SAFE and not reached: " in " ".join(lines)
    assert any(line.endswith(" more notes: thermicon rank --details") for line in lines)


def test_a_first_ranking_says_once_on_a_terminal_that_it_compiles(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr("thermicon.base.numbers.compiled.kept_in", lambda: tmp_path)
    ranking._say_if_first()
    assert capsys.readouterr().err == ""
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    ranking._say_if_first()
    ranking._say_if_first()
    assert capsys.readouterr().err.count("compiling for this computer, once") == 1


def test_who_watches_many_icons_sees_the_table_before_the_intervals_and_the_next_command_last(
    cli: Cli, two: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    how = "rank", two, "--people", 4, "--intervals", 4
    usual = cli.good(*how).stdout.splitlines()
    monkeypatch.setattr(ranking, "shown_at_once", lambda: True)
    assert cli.good(*how).stdout.splitlines() == usual, "these are few"
    monkeypatch.setattr(ranking, "MANY", 2)
    lines = cli.good(*how).stdout.splitlines()
    assert sorted(filter(None, lines)) == sorted(filter(None, usual))
    assert lines[-1].startswith("Next: ")
    stopped = Mock(side_effect=typer.Exit(1))
    monkeypatch.setattr("thermicon.perception.ranking.rank.with_intervals", stopped)
    assert "most confused with" in cli(*how).stdout


def test_records_have_no_interval_and_say_so(cli: Cli, two: Path, records: Path) -> None:
    said = cli.good("rank", two, "--people", 4, "--observer", records, "--details")
    assert "lab.toml has no posterior draws" in said.stderr
    assert "no interval for a new laboratory" in " ".join(said.stdout.split())
    assert "in a new laboratory" not in said.stdout


@pytest.mark.parametrize("command", [("pilot", "--answers", "t.csv"), ("pilot",), ("rank", "--doubt")])
def test_what_needs_draws_refuses_records_and_names_the_draws_beside_them(
    cli: Cli, two: Path, records: Path, tmp_path: Path, command: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    trials = tmp_path / "t.csv"
    trials.write_text("participant,trial,presented,responded\nP,1,cool-step,cool-step\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    for beside in ("the table of draws (.csv) that pilot --keep writes", "lab.csv, which stands beside it"):
        said = cli(*command, two, "--observer", records)
        assert (said.exit_code, said.stdout) == (1, "")
        assert beside in " ".join(said.stderr.split())
        (tmp_path / "lab.csv").write_bytes((DATA / "posterior.csv").read_bytes())


def test_as_many_draws_are_used_as_there_are_and_another_rig_is_warned_of(cli: Cli, two: Path, tmp_path: Path) -> None:
    lab, out = few_draws(tmp_path / "lab.csv", 6, "by weights from 12 laboratories", "thenar"), tmp_path / "out.json"
    said = cli.good("rank", two, "--people", 4, "--observer", lab, "--json", out)
    assert "note: lab.csv has 6 draws: all of them are used (--intervals is 128 by default)" in said.stderr
    assert "conditioned on" not in said.stderr
    assert "in your laboratory, lab.csv (95 %): " in " ".join(said.stdout.split())
    assert ", observer lab.csv." in said.stdout
    held = json.loads(out.read_text(encoding="utf-8"))
    assert (held["observer"], len(held["persons"]["proportion_correct"])) == ("lab.csv", 4)
    for more, words in (
        (("--people", 4, "--intervals", 7), "--intervals 7: the lab.csv posterior has 6 draws"),
        (("--doubt",), "lab.csv has 6 draws, and 64 are needed: keep more with pilot --draws 128"),
    ):
        said = cli("rank", two, "--observer", lab, *more)
        assert (said.exit_code, said.stdout) == (1, "")
        assert words in said.stderr
    other = few_draws(tmp_path / "other.csv", 3, "by weights from 12 laboratories", "hand-dorsum")
    said = cli("rank", two, "--people", 2, "--observer", other)
    assert "warning: other.csv was conditioned on the hand-dorsum rig, not on thenar" in said.stderr


def test_workers_change_no_byte(cli: Cli, two: Path, tmp_path: Path) -> None:
    outs = []
    for extra in ((), ("--workers", 1), ("--workers", 3)):
        outs.append(tmp_path / f"{len(outs)}.json")
        cli.good("rank", two, "--people", 5, "--intervals", 0, "--json", outs[-1], *extra)
    assert len({out.read_bytes() for out in outs}) == 1


def test_a_cluster_that_is_not_there_is_bad_input(cli: Cli, two: Path) -> None:
    pytest.importorskip("distributed")
    said = cli("rank", two, "--people", 2, "--workers", "nowhere")
    assert (said.exit_code, "'nowhere' is not the address of a scheduler" in said.stderr) == (1, True)


def test_the_table_of_doubt_says_what_to_measure_first(cli: Cli, two: Path, tmp_path: Path) -> None:
    out, picture = tmp_path / "out.json", tmp_path / "out.png"
    quick = ("--doubt", "--people", 3, "--intervals", 64, "--set", "contact.area_cm2=4")
    said = cli.good("rank", two, *quick, "--json", out, "--figure", picture)
    assert said.stderr == f"wrote {out}\nwrote {picture}\n"
    assert max(len(line) for line in said.stdout.splitlines()) <= 80
    effects = json.loads(out.read_text(encoding="utf-8"))["effects"]
    assert {"constant", "unit", "low", "high", "proportion_correct", "information_bits"} <= set(effects[0])
    words = " ".join(said.stdout.split())
    assert words.startswith("Two for a test constant 95 % of draws named bits named low–high ")
    assert "What to measure first, with the share of the variance of what is named that it would remove: - " in words
    assert effects[0]["constant"].split()[0] in words
    assert "64 draws for 3 virtual people on the thenar rig with contact.area_cm2=4 (seed 0, memory: both): " in words
    units = {each["constant"]: each["unit"] for each in effects}
    assert (units["contact resistance"], units["thickness of the outermost layer"]) == ("m²·K/W", "mm")
    assert "memory noise (episodes)" in units and "degC" not in words and "d'" not in words
    assert picture.stat().st_size > 10_000


def test_a_set_on_two_sides_is_ranked_by_where_it_plays_and_says_what_is_not_in_it(cli: Cli, tmp_path: Path) -> None:
    made, page = tmp_path / "made.json", tmp_path / "page.html"
    few = ("--people", 8, "--intervals", 4)
    said = cli.good("rank", "turns", "--rig", "wheel", *few, "--json", made, "--report", page).stdout
    rows = {line.split()[0]: line for line in said.splitlines() if line.startswith(("leave-", "turn-"))}
    assert "left, right" in rows["turn-left"]
    assert rows["leave-right"].split()[1] == "right"
    place = "place: the elements are apart, so nothing about place is assumed; what driving costs is not in it"
    assert place in " ".join(said.split())
    assert "Next: thermicon export turns --rig wheel --to csv -o drives" in said
    held = json.loads(made.read_text("utf-8"))
    assert {icon["name"]: icon["where"] for icon in held["icons"]}["leave-left"] == ["left"]
    assert [round(cost["published"], 3) for cost in held["place"]["costs"]] == [0.942, 0.917]
    for cost in held["place"]["costs"]:
        assert cost["predicted"] * (1 - cost["lapse"]) + cost["lapse"] / 2 == pytest.approx(cost["published"])
        assert cost["proportion_correct"] < held["set"]["proportion_correct"]
    whole = page.read_text("utf-8")
    for shown in (place, "side recognised while driving: 94.2 %", "what elements do to one another", "left: mostly"):
        assert shown in whole


def test_a_lapse_of_the_layout_file_is_what_the_details_said(cli: Cli, tmp_path: Path) -> None:
    wheel = (files("thermicon.circuit") / "layouts" / "wheel.toml").read_text("utf-8")
    driving = tmp_path / "driving.toml"
    driving.write_text(wheel.replace('surfaces = "apart"', 'surfaces = "apart"\nlapse = 0.5', 1))
    said = cli.good("rank", "turns", "--rig", driving, "--people", 8, "--intervals", 0, "--json", "-")
    held = json.loads(said.stdout)
    assert held["set"]["proportion_correct"] == pytest.approx(0.5 * 0.95 + 0.5 / 4, abs=0.03)
    assert held["place"]["costs"] == []
    told = cli.good("rank", "turns", "--rig", driving, "--people", 2, "--intervals", 0).stdout
    assert "a lapse of 50 % of trials, for what else people do, is in it" in " ".join(told.split())


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["turns"], "the rig thenar is one element: give a layout that has them, such as wheel"),
        (
            ["calls", "--rig", "wheel"],
            "wheel has left, right: give elements these names, or give a layout that has them, such as ring-four",
        ),
        (["six-icons", "--rig", "wheel"], "a layout of several elements, and one plays here; give the rig of one"),
        (["bars", "--rig", "tcs2-strips"], 'take elements that are apart (surfaces = "apart"), such as those of wheel'),
        (["turns", "--rig", "wheel", "--set", "contact.area_cm2=4"], "write set = { … } into an element"),
    ],
)
def test_icons_and_elements_that_do_not_go_together_say_which_is_which(cli: Cli, words: list[str], told: str) -> None:
    assert told in " ".join(cli("rank", *words).stderr.split())


@pytest.mark.slow
def test_no_bit_depends_on_whether_machine_code_was_just_made_or_kept(tmp_path: Path) -> None:
    """Two copies of one compiled function, made for two callers, may round differently: which one runs is chance."""
    program = [sys.executable, "-m", "thermicon.notebooks.cli.main"]
    made, kept = (
        [
            subprocess.run([*program, *words.split()], capture_output=True, check=True, env=env).stdout
            for words in ("rank six-icons --json -", "rank pulse-sequences --json -", "simulate six-icons -o -")
        ]
        for env in 2 * [{**os.environ, "THERMICON_CACHE": str(tmp_path)}]
    )
    assert made == kept
