"""``thermicon pilot`` as a plan or with answers."""

import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.notebooks.conftest import Cli
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.pilot.conditioning import MeasuredValues, Namings

QUICK = ("--draws", 24)
VALUES = """participant,kind,method,channel,size_K,value,unit,standard_error,trials
ann,threshold,limits,cold,,1.4,K,,10
ann,reaction_time,,warm,6,2100,ms,150,
ann,rating,,cold,6,40,points,,
bob,threshold,limits,cold,,2.3,K,,10
bob,reaction_time,,warm,6,1.7,s,,12
"""


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


def told(said: Any, *words: str) -> str:
    """What was printed, which has these words."""
    assert said.exit_code == 0, said.stderr
    printed = " ".join(said.stdout.split())
    assert [each for each in words if each not in printed] == [], printed
    return printed


@pytest.mark.slow
def test_answers_print_write_and_keep(cli: Cli, two: Path, answers: Path, tmp_path: Path) -> None:
    out, lab = tmp_path / "out.json", tmp_path / "lab.toml"
    asked = ("pilot", two, "six-icons", "--answers", answers, *QUICK, "--seed", 4)
    said = cli(*asked, "--json", out, "--keep", lab)
    told(
        said,
        *("Two for a test trials named 95 % bits ", "bob 6 83 % 44–97 %"),
        *("bias (Miller–Madow)", "Test of fit (posterior predictive): p = "),
        *("two.cue felt & named ", "six-icons felt & named ", "effective sample size ", " of 24 draws"),
    )
    assert said.stderr == f"wrote {out}\nwrote {lab} and {lab.with_suffix('.csv')}\n"
    own = json.loads(out.read_text(encoding="utf-8"))
    assert (own["participants"], own["trials"], own["seed"]) == (4, 19, 4)
    assert len(own["predictions"]) == 2
    assert len(PosteriorDraws.load(lab.with_suffix(".csv"))) == 12
    assert not list(tmp_path.glob(".*"))
    assert cli(*asked, "--json", "-").stdout == out.read_text(encoding="utf-8"), "the same question, the same bytes"


def test_the_command_after_keep_predicts_for_the_laboratory(cli: Cli, two: Path, answers: Path, tmp_path: Path) -> None:
    lab = tmp_path / "my lab.toml"
    words = told(cli("pilot", two, "--answers", answers, *QUICK, "--seed", 3, "--keep", lab))
    assert words.endswith(f"--observer '{lab.with_suffix('.csv')}'")
    command = shlex.split("thermicon rank " + words.split("thermicon rank ")[1])
    ranked = cli(*command[1:])
    told(ranked, "your laboratory, my lab.csv")
    assert "warning: my lab.csv was conditioned on" not in ranked.stderr


def test_trials_without_an_answer_and_counts_of_a_group_are_said(cli: Cli, two: Path, tmp_path: Path) -> None:
    path, out = tmp_path / "trials.csv", tmp_path / "out.json"
    rows = [f"ann,{k},warm-step,{'warm-step' if k else 'timeout'}" for k in range(24)]
    path.write_text("\n".join(["participant,trial,presented,responded", "ann,read,,", *rows, "bob,1,warm-step,"]))
    words = told(cli("pilot", two, "--answers", path, *QUICK, "--json", out), "not felt", "1 rows or trials")
    assert "all 25 2 92 % " in words and "2 of 25 trials have no answer, so were not felt" in words
    assert "Observed where they answered: 100 %" in words
    own = json.loads(out.read_text(encoding="utf-8"))
    assert (sum(own["unanswered"]), sum(map(sum, own["counts"])), own["trials"]) == (2, 23, 25)
    assert (own["rows_passed_over"], own["one_group"], own["each"][1]["unanswered"]) == (1, False, 1)
    path.write_text("shown,warm-step,cool-step\nwarm-step,20,4\ncool-step,5,19\n")
    words = told(cli("pilot", two, "--answers", path, *QUICK, "--json", out), "Counts of one group do not show")
    assert "all 48 81 %" in words and "Each trial has an answer" in words and "not felt" not in words
    assert json.loads(out.read_text(encoding="utf-8"))["one_group"]


def test_eight_of_eight_silences_on_one_icon_are_seen(cli: Cli, two: Path, tmp_path: Path) -> None:
    path, sealed = tmp_path / "trials.csv", tmp_path / "sealed.json"
    rows = [f"{who},{k},{icon},{said}" for who in ("ann", "bob") for k in range(8)
            for icon, said in [("cool-step", "cool-step") if k % 2 else ("warm-step", "none")]]  # fmt: skip
    path.write_text(
        "\n".join(["participant,trial,presented,responded", *rows, *(f"cem,{k},cool-step,cool-step" for k in range(8))])
    )
    words = told(cli("pilot", two, "--answers", path, *QUICK), "warm-step: 8 of 8 not felt; predicted ")
    assert "all 24 8 67 % " in words and "the prediction of what is felt missed" in words
    assert "Icons not felt outside their predicted 95 % (1 of 2): " in words
    cli.good("rank", two, "--people", 8, "--intervals", 0, "--json", sealed)
    told(
        cli("pilot", two, sealed, "--answers", path),
        "Felt and named: 67 % of 24 plays; it says ",
        "Its icons are not what it says: p under 0.01",
    )
    held = json.loads(sealed.read_text(encoding="utf-8"))
    held["icons"] = [{key: icon[key] for key in icon if key != "felt_and_named"} for icon in held["icons"]]
    sealed.write_text(json.dumps(held), encoding="utf-8")
    told(cli("pilot", two, sealed, "--answers", path), "8 plays were not felt. ", "it is read on named alone")


def test_a_sealed_prediction_is_scored_beside_its_cue_file(cli: Cli, two: Path, answers: Path, tmp_path: Path) -> None:
    sealed, out = tmp_path / "sealed.json", tmp_path / "out.json"
    cli.good("rank", two, "--people", 8, "--intervals", 0, "--json", sealed)
    said = cli("pilot", two, sealed, "--answers", answers, "--json", out)
    words = told(
        said, "guessing −1.00 50 %", "19 answers, 95 % named correctly. The prediction was better than guessing"
    )
    own = json.loads(out.read_text(encoding="utf-8"))
    assert own["sealed"]["sha256"] in words
    assert [*own["scores"]][2:] == ["skin temperature alone", "best that its matrix allows"]
    for wrong in (
        [two, sealed],
        [sealed, "--answers", answers],
        [two, sealed, "--answers", answers, "--keep", "l.toml"],
    ):
        assert "sealed prediction" in cli("pilot", *wrong).stderr


def test_answers_without_a_likelihood_are_given_alone(
    cli: Cli, two: Path, answers: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def singular(*_: object) -> None:
        raise np.linalg.LinAlgError

    out, lab, figure = (tmp_path / name for name in ("out.json", "lab.toml", "figure.svg"))
    monkeypatch.setattr(Namings, "weighed", singular)
    words = told(
        cli("pilot", two, "--answers", answers, *QUICK, "--json", out, "--figure", figure),
        *("two.cue felt & named ", "Test of fit (posterior predictive): p = "),
        "The likelihood of the answers cannot be used: the covariance matrix of the data cannot be factorised. The "
        "prediction is not sharpened by them, and the answers alone are given: 95 % named, 95 % interval 75–100 %. "
        "Check the table for numbers that cannot be, or use more draws, or another seed.",
    )
    assert not [word for word in ("after", "effective", "--keep", "Traceback") if word in words]
    assert json.loads(out.read_text(encoding="utf-8"))["unusable"] in words and figure.exists()
    said = cli("pilot", two, "--answers", answers, *QUICK, "--keep", lab)
    assert (said.exit_code, lab.exists()) == (1, False)
    assert f"{lab} is not written: there are no draws of this laboratory" in said.stderr
    assert "the answers alone are given" in " ".join(said.stdout.split())
    path = tmp_path / "v.csv"
    path.write_text(VALUES, encoding="utf-8")
    monkeypatch.setattr(MeasuredValues, "weighed", singular)
    told(
        cli("pilot", two, "--measurements", path, *QUICK),
        *("condition people measured predicted 95 % ──", "The likelihood of the values cannot be used"),
        "the values alone are given: cold, limits, 1 K/s: 1.79 K; ",
    )


def test_enough_draws_say_by_how_much_it_narrowed(cli: Cli, two: Path, answers: Path) -> None:
    words = told(cli("pilot", two, "--answers", answers, "--draws", 200), "after (95 %) narrower")
    assert "too few to say" not in words


def test_plan_of_one_set(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "plan.json"
    said = cli("pilot", two, *QUICK, "--participants", "16,4", "--trials", "6,20", "--wanted", 12, "--json", out)
    told(said, "participants 6 trials 20 trials", "in points; * marks an interval of 12 points or less")
    own = json.loads(out.read_text(encoding="utf-8"))
    assert [(each["participants"], each["trials"]) for each in own["designs"]] == [(4, 6), (4, 20), (16, 6), (16, 20)]


@pytest.mark.slow
def test_a_table_of_measurements_conditions_a_set(cli: Cli, two: Path, tmp_path: Path) -> None:
    path, lab, out = (tmp_path / name for name in ("v.csv", "lab.toml", "v.json"))
    path.write_text(VALUES, encoding="utf-8")
    said = cli("pilot", two, "--measurements", path, "--draws", 40, "--keep", lab, "--json", out)
    told(
        said,
        *("cold, limits, 1 K/s 2 1.79 K", "warm, choice reaction 2 1.89 s", "Test of fit (posterior predictive): p = "),
        *("1 of 5 values have neither standard_error nor trials: an error of 10 % is assumed.", "Ratings count by"),
        *("two.cue felt & named ", "effective sample size ", " of 40 draws"),
        f"thermicon rank {two} --observer {lab.with_suffix('.csv')}",
    )
    found = json.loads(out.read_text(encoding="utf-8"))
    assert (found["participants"], found["values"], found["errors_assumed"]) == (2, 5, 1)
    assert len(PosteriorDraws.load(lab.with_suffix(".csv"))) == 20
    cli.good("pilot", two, "--measurements", path, "--draws", 20, "--observer", lab.with_suffix(".csv"))
