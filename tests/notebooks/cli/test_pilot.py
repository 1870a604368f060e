"""``thermicon pilot``, as a plan and with answers: tables for people, files for scripts, and clear refusals."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from thermicon.perception.observer.draws import PosteriorDraws

Cli = Callable[..., Any]
QUICK = ("--draws", 24)


@pytest.fixture
def answers(tmp_path: Path) -> Path:
    path = tmp_path / "trials.csv"
    rows = ["participant,trial,presented,responded,time_s"]
    for person in ("ann", "bob", "cem"):
        for k in range(6):
            shown = "cool-step" if k % 2 else "warm-step"
            rows.append(f"{person},{k},{shown},{'warm-step' if person == 'bob' and k == 1 else shown},{1.5 + k}")
    path.write_text("\n".join([*rows, "dan,1,cool-step,cool-step,"]) + "\n", encoding="utf-8")
    return path


@pytest.mark.slow
def test_observed_prints_writes_and_keeps(cli: Cli, two: Path, answers: Path, tmp_path: Path) -> None:
    out, lab, picture = tmp_path / "out.json", tmp_path / "lab.toml", tmp_path / "out.png"
    said = cli(
        *("pilot", two, "six-icons", "--answers", answers, *QUICK),
        *("--json", out, "--keep", lab, "--figure", picture),
    )
    assert said.exit_code == 0, said.stderr
    words = " ".join(said.stdout.split())
    assert words.startswith("Two for a test trials correct 95 % bits 95 % further trials time ")
    assert "bob 6 83 % 44–97 %" in words
    assert "One trial only: dan; it counts, but shows no spread." in words
    assert "Bits are corrected for bias (Miller–Madow): the plug-in estimate" in words
    assert "Test of fit (posterior predictive): p = " in words
    assert "two.cue before" in words and "six-icons before" in words
    assert "effective sample size " in words and " of 24 draws" in words
    assert said.stderr == f"wrote {out}\nwrote {picture}\nwrote {lab} and {lab.with_suffix('.csv')}\n"
    own = json.loads(out.read_text(encoding="utf-8"))
    assert (own["participants"], own["trials"], own["single_trial"]) == (4, 19, ["dan"])
    assert len(own["predictions"]) == 2
    assert len(PosteriorDraws.load(lab.with_suffix(".csv"))) == 12
    assert picture.stat().st_size > 10_000
    assert not list(tmp_path.glob(".*"))


@pytest.mark.slow
def test_the_same_question_gets_the_same_bytes(cli: Cli, two: Path, answers: Path) -> None:
    said = [cli("pilot", two, "--answers", answers, *QUICK, "--seed", 4, "--json", "-").stdout for _ in range(2)]
    assert said[0] == said[1]
    assert json.loads(said[0])["seed"] == 4


@pytest.mark.parametrize(
    "options",
    [
        (),
        pytest.param(
            ("--norm", "naming", "--tracking", "display", "--set", "contact.area_cm2=6"), marks=pytest.mark.slow
        ),
    ],
)
def test_what_rank_shows_of_a_kept_laboratory_is_what_it_shows(
    cli: Cli, two: Path, answers: Path, tmp_path: Path, options: tuple[str, ...]
) -> None:
    lab = tmp_path / "my lab.toml"
    said = cli("pilot", two, "--answers", answers, *QUICK, "--seed", 3, "--keep", lab, *options)
    assert said.exit_code == 0, said.stderr
    words = " ".join(said.stdout.split())
    promised = re.search(r"rank shows (\d+ %) correct for this laboratory: 200 other people at the first of", words)
    assert promised is not None
    assert words.endswith(f"--observer '{lab.with_suffix('.csv')}'")
    command = shlex.split("thermicon rank " + words.split("thermicon rank ")[1])
    ranked = cli(*command[1:])
    assert ranked.exit_code == 0, ranked.stderr
    assert re.search(rf"^{promised[1]} +named correctly; ", ranked.stdout, re.M)
    assert "warning: my lab.csv was conditioned on" not in ranked.stderr
    assert "your laboratory, my lab.csv" in " ".join(ranked.stdout.split())


def test_without_keep_the_way_to_a_laboratory_is_named(cli: Cli, two: Path, answers: Path) -> None:
    words = " ".join(cli("pilot", two, "--answers", answers, *QUICK).stdout.split())
    assert words.endswith("With --keep lab.toml, rank, improve and the workbench can predict for this laboratory.")
    assert "rank shows" not in words


def test_an_icon_that_nobody_was_presented_is_named(cli: Cli, two: Path, tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text("participant,trial,presented,responded\nP,1,cool-step,cool-step\nP,2,cool-step,warm-step\n")
    said = cli("pilot", two, "--answers", path, *QUICK)
    assert said.exit_code == 0
    assert "Never presented: warm-step. What is said of them is prediction alone" in " ".join(said.stdout.split())


def test_a_single_slip_judges_no_model(cli: Cli, two: Path, tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text("participant,trial,presented,responded\nP,1,cool-step,warm-step\n", encoding="utf-8")
    said = cli("pilot", two, "--answers", path, *QUICK)
    assert said.exit_code == 0
    words = " ".join(said.stdout.split())
    assert "after the answers were used: 1 answer is too little to judge the model by; 20 or more can" in words
    assert "cannot explain" not in words
    assert "narrower" not in words
    assert "Intervals after rest on 12 laboratories, too few to say by how much they narrowed: use --draws 200" in words


def test_enough_draws_say_by_how_much_it_narrowed(cli: Cli, two: Path, answers: Path) -> None:
    words = " ".join(cli("pilot", two, "--answers", answers, "--draws", 200).stdout.split())
    assert "95 % bits 95 % narrower" in words
    assert "too few to say" not in words


@pytest.mark.slow
def test_odd_answers_are_judged_by_as_much_as_was_tried(cli: Cli, two: Path, tmp_path: Path) -> None:
    path, rows = tmp_path / "t.csv", ["participant,trial,presented,responded"]
    for person in ("ann", "bob", "cem"):
        rows += [f"{person},{k},{'cool-step' if k % 2 else 'warm-step'},cool-step" for k in range(10)]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    few, many = (" ".join(cli("pilot", two, "--answers", path, "--draws", n).stdout.split()) for n in (24, 240))
    assert "the answers are unlikely, but 12 laboratories are too few to say that no constants explain them" in few
    assert "the model cannot explain these answers, not even with other constants" in many


def test_a_bad_table_is_bad_input_and_nothing_is_written(cli: Cli, two: Path, tmp_path: Path) -> None:
    path, out = tmp_path / "t.csv", tmp_path / "out.json"
    path.write_text("participant,trial,presented,responded\nP,1,cool-step,Cool-step\n", encoding="utf-8")
    said = cli("pilot", two, "--answers", path, "--json", out)
    assert said.exit_code == 1
    assert said.stderr.startswith(f"{path}:2: responded is 'Cool-step', which is not an icon of the set; did you mean")
    assert not out.exists()
    assert "no such table of trials" in cli("pilot", two, "--answers", tmp_path / "none.csv").stderr


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--draws", 5), "'--draws': 5 is outside 20 to 20000"),
        (("--seed", -1), "'--seed': -1 is outside 0 to 4294967295"),
        (("--norm", "mean"), "'--norm': 'mean' is not one of episodes, naming"),
        (("--participants", "4"), "'--participants': belongs to a plan, before there are answers"),
        (("--keep", "-"), "'--keep': - is not a file; give a name such as lab.toml"),
    ],
)
def test_bad_options_of_observed(cli: Cli, two: Path, answers: Path, options: tuple[object, ...], told: str) -> None:
    said = cli("pilot", two, "--answers", answers, *options)
    assert (said.exit_code, said.stdout) == (2, "")
    assert told in " ".join(said.stderr.replace("│", " ").split())


def test_outputs_are_checked_before_work_begins(cli: Cli, two: Path, answers: Path, tmp_path: Path) -> None:
    said = cli("pilot", two, "--answers", answers, "--keep", tmp_path / "lab.csv")
    assert said.exit_code == 1
    assert "an observer is written as .toml, not .csv" in said.stderr
    own = answers.with_suffix(".toml")
    assert "is read by this command; give another name" in cli("pilot", two, "--answers", answers, "--keep", own).stderr


def test_what_was_kept_is_never_replaced(cli: Cli, two: Path, answers: Path, tmp_path: Path) -> None:
    lab = tmp_path / "lab.toml"
    lab.with_suffix(".csv").write_text("mine", encoding="utf-8")
    said = cli("pilot", two, "--answers", answers, *QUICK, "--keep", lab)
    assert (said.exit_code, said.stdout) == (1, "")
    told = "already there and kept; give --keep another name, or move them away"
    assert said.stderr == f"{lab.with_suffix('.csv')} {told}\n"
    assert lab.with_suffix(".csv").read_text(encoding="utf-8") == "mine"


def test_doubtful_times_are_warned_of_on_screen_and_in_the_file(
    cli: Cli, two: Path, answers: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out.json"
    text = answers.read_text(encoding="utf-8").replace("ann,3,cool-step,cool-step,4.5", "ann,3,cool-step,cool-step,900")
    answers.write_text(text, encoding="utf-8")
    said = cli("pilot", two, "--answers", answers, *QUICK, "--json", out)
    assert said.exit_code == 0
    warning = f"{answers}:5: time_s is 900 s, and the median of participant 'ann' is "
    assert said.stderr.startswith(f"warning: {warning}")
    assert json.loads(out.read_text(encoding="utf-8"))["warnings"][0].startswith(warning)


def test_plan_of_one_set(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "plan.json"
    said = cli("pilot", two, *QUICK, "--participants", "16,4", "--trials", "6,20", "--presentations", 3, "--json", out)
    assert said.exit_code == 0, said.stderr
    words = " ".join(said.stdout.split())
    assert "participants 6 trials 20 trials" in words
    assert "Mean width of the 95 % interval of the per cent correct, in points; * marks an interval" in words
    assert "Pilot with one participant, 3 presentations in random order:" in words
    own = json.loads(out.read_text(encoding="utf-8"))
    assert [(each["participants"], each["trials"]) for each in own["designs"]] == [(4, 6), (4, 20), (16, 6), (16, 20)]
    assert sum(own["pilot"]["presented"].values()) == len(own["pilot"]["order"]) == 3


def test_plan_of_two_sets(cli: Cli, two: Path) -> None:
    said = cli("pilot", two, "six-icons", *QUICK, "--participants", "6", "--trials", "12", "--presentations", 2)
    words = " ".join(said.stdout.split())
    assert "Difference of the two: " in words
    assert "Share of experiments that distinguish the two sets in the right direction (paired t test at 5 %" in words


def test_a_plan_that_nothing_satisfies_says_so(cli: Cli, two: Path) -> None:
    quick = (*QUICK, "--participants", "4", "--trials", "6", "--presentations", 1)
    said = cli("pilot", two, *quick, "--wanted", 0.1)
    assert "None of these sizes is enough: an interval of 0.1 points or less needs more" in " ".join(
        said.stdout.split()
    )
    same = cli("pilot", two, two, *quick)
    assert "cannot be had where the sets hardly differ" in " ".join(same.stdout.split())


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--participants", "1,8"), "'--participants': 1 is outside 2 to 500"),
        (("--participants", "some"), "'--participants': 'some' is not a list of whole numbers such as 8,16,32"),
        (("--trials", "0"), "'--trials': 0 is outside 1 to 5000"),
        (("--presentations", 0), "'--presentations': 0 is outside 1 to 1000"),
        (("six-icons", "six-icons"), "a plan is for one set, or for two"),
        (("--wanted", 0), "'--wanted': 0 is outside 0 to 100"),
        (("--keep", "lab.toml"), "'--keep': needs --answers FILE"),
    ],
)
def test_bad_options_of_plan(cli: Cli, two: Path, options: tuple[object, ...], told: str) -> None:
    said = cli("pilot", two, *options)
    assert (said.exit_code, said.stdout) == (2, "")
    assert told in " ".join(said.stderr.replace("│", " ").split())


VALUES = """participant,kind,method,channel,size_K,value,unit,standard_error,trials
ann,threshold,limits,cold,,1.4,K,,10
ann,reaction_time,,warm,6,2100,ms,150,
ann,rating,,cold,6,40,points,,
bob,threshold,limits,cold,,2.3,K,,10
bob,reaction_time,,warm,6,1.7,s,,12
"""


@pytest.mark.slow
def test_a_table_of_measurements_conditions_a_set(cli: Cli, two: Path, tmp_path: Path) -> None:
    path, lab, picture, out = (tmp_path / name for name in ("v.csv", "lab.toml", "v.png", "v.json"))
    path.write_text(VALUES, encoding="utf-8")
    said = cli("pilot", two, "--answers", path, "--draws", 40, "--keep", lab, "--figure", picture, "--json", out)
    assert said.exit_code == 0, said.stderr
    words = " ".join(said.stdout.split())
    assert "cold, limits, 1 K/s 2 1.79 K" in words
    assert "warm, choice reaction 2 1.89 s" in words
    assert "Test of fit (posterior predictive): p = " in words
    assert "1 of 5 values have neither standard_error nor trials: an error of 10 % is assumed." in words
    assert "Ratings count by their ratios" in words
    assert "two.cue before" in words
    assert "effective sample size " in words and " of 40 draws" in words
    found = json.loads(out.read_text(encoding="utf-8"))
    assert (found["participants"], found["values"], found["errors_assumed"]) == (2, 5, 1)
    assert len(PosteriorDraws.load(lab.with_suffix(".csv"))) == 20
    assert f"thermicon rank {two} --observer {lab.with_suffix('.csv')}" in words
    assert picture.stat().st_size > 10_000
    kept = cli("pilot", two, "--answers", path, "--draws", 20, "--observer", lab.with_suffix(".csv"))
    assert kept.exit_code == 0, kept.stderr


def test_bad_measurements_are_refused_in_words(cli: Cli, two: Path, tmp_path: Path) -> None:
    path = tmp_path / "v.csv"
    path.write_text(VALUES.replace("2.3,K", "305,K"), encoding="utf-8")
    said = cli("pilot", two, "--answers", path)
    assert said.exit_code == 1
    assert "v.csv:5: value is '305' K, a threshold lies within 0.005 to 20 K" in said.stderr
    metal = cli("pilot", two, "--answers", path, "--set", "load.film_W_per_m2K=10")
    assert metal.exit_code == 1
