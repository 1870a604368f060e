"""``thermicon fit`` at the command line."""

import re
from pathlib import Path

import pytest

from tests.builders import missing
from tests.notebooks.conftest import Cli
from thermicon.circuit import Rig
from thermicon.circuit.fitting.synthetic_log import synthetic_log, write_log

CONTACT, SEEBECK, OHM = "contact.resistance_m2K_per_W", "module.seebeck_V_per_K", "module.resistance_ohm"
RATE = ("--set", "driver.update_Hz=20")


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "rig.csv"
    write_log(synthetic_log(Rig.load("thenar").with_(**{CONTACT: 7e-4}), seed=1, rate_Hz=20.0), path)
    return path


def test_a_fit_prints_parameters_and_writes_the_rig_and_the_figure(cli: Cli, log: Path, tmp_path: Path) -> None:
    rig, figure = tmp_path / "mine.toml", tmp_path / "fit.png"
    keys = ("--free", f"{CONTACT},{SEEBECK}", "--free", OHM)
    said = cli.good("fit", log, *keys, "-o", rig, "--figure", figure, *RATE)
    lines = said.stdout.splitlines()
    assert lines[0].split() == ["key", "fitted", "95", "%", "interval", "±"]
    assert [line.split()[0] for line in lines[2:5]] == [CONTACT, SEEBECK, OHM]
    assert float(lines[2].split()[1]) == pytest.approx(7e-4, rel=0.02)
    assert any(line.startswith("display (rig.csv)") for line in lines)
    assert "uncertainty of the fitted rig" in said.stdout and "(was ±30 %)" in said.stdout.replace("\n", " ")
    assert max(map(len, lines)) <= 80
    assert said.stderr == f"wrote {rig}\nwrote {figure}\n"
    assert Rig.load(rig).contact.resistance_m2K_per_W == pytest.approx(7e-4, rel=0.02)
    assert Rig.load(rig).name == "mine"
    assert figure.stat().st_size > 20_000


def test_a_plan_says_before_measuring_what_helps(cli: Cli) -> None:
    keys = f"{CONTACT},{SEEBECK},module.thermal_resistance_K_per_W,heat_sink.temperature_C"
    said = cli.good("fit", "--plan", "--free", keys, "--fixed-skin")
    lines = [line.replace("(", "").split() for line in said.stdout.splitlines()]
    assert ["key", "D", "D", "V", "D", "V", "H", "D", "S", "D", "V", "H", "S"] in lines
    contact = next(line for line in lines if line[:1] == [CONTACT])
    alone, both = (float(contact[place].removeprefix("±")) for place in (1, 3))
    assert alone > 1.5 * both


def test_what_a_log_does_not_show_is_named_with_the_cure(cli: Cli, log: Path, tmp_path: Path) -> None:
    said = cli("fit", log, "--free", "ambient.temperature_C,skin.rest_C", *RATE, "--set", f"{CONTACT}=7e-4")
    text = " ".join(said.stdout.split())
    assert "not identified: ambient.temperature_C; cannot be separated from skin at rest" in text
    assert "strongly correlated: ambient.temperature_C and skin.rest_C (1.00)" in text
    said = cli("fit", log, "--rig", "fingertip", "--free", f"{CONTACT},{SEEBECK}", "--fixed-skin", *RATE)
    row = next(line for line in said.stdout.splitlines() if line.startswith(CONTACT))
    assert row.split()[2:] == ["not", "known", "unknown"]
    assert "uncertainty of the fitted rig, widened: " in " ".join(said.stdout.split())
    assert "is the most that a rig file may state" in " ".join(said.stderr.split())


@pytest.mark.parametrize(
    ("change", "more", "code", "words"),
    [
        (("display_C", "Displey_C"), RATE, 0, "'Displey_C' is taken as display_C, as the only column in °C"),
        ((r"\n(\d\.450000,[^,]*),[^,]*", r"\n\1,n/a"), RATE, 0, "display_C is 'n/a' in 10 of"),
        (("current_A", "drive"), RATE, 1, "no log has a drive: one of current_A or"),
        (("", ""), (*RATE, "--column", "skin_C=T9"), 2, "no column is called 'T9', to be skin_C; found time_s, curr"),
        (("", ""), (*RATE, "rig.csv"), 1, ["has the same content as", "name it once"]),
        (("", ""), ("--rig", "tcs2"), 1, "rig tcs2 is a thermode, whose display is the drive: display_C with skin_C"),
    ],
    ids=["column", "cells", "drive", "lost", "twice", "thermode"],
)
def test_a_doubtful_log_is_told_and_a_useless_one_leaves_nothing(
    cli: Cli, log: Path, tmp_path: Path, change: tuple[str, str], more: tuple[str, ...], code: int, words: str
) -> None:
    wrong, out = tmp_path / "wrong.csv", tmp_path / "out.toml"
    wrong.write_text(re.sub(*change, log.read_text(encoding="utf-8")), encoding="utf-8")
    said = cli("fit", wrong, *(log if word == "rig.csv" else word for word in more), "--free", CONTACT, "-o", out)
    told = " ".join(said.stderr.split())
    assert (said.exit_code, out.exists(), missing(words, told)) == (code, code == 0, []), told
    assert "Traceback" not in told
