"""``thermicon fit``: what it prints, what it writes, and what it refuses."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from thermicon.circuit import Rig
from thermicon.circuit.fitting.laboratory import synthetic_log, write_log

Cli = Callable[..., Any]
CONTACT, SEEBECK, OHM = "contact.resistance_m2K_per_W", "module.seebeck_V_per_K", "module.resistance_ohm"
RATE = ("--set", "driver.update_Hz=20")


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "rig.csv"
    write_log(synthetic_log(Rig.load("thenar").with_(**{CONTACT: 7e-4}), seed=1, rate_Hz=20.0), path)
    return path


def test_a_fit_prints_parameters_and_writes_the_rig_and_the_figure(cli: Cli, log: Path, tmp_path: Path) -> None:
    rig, figure = tmp_path / "mine.toml", tmp_path / "fit.png"
    said = cli("fit", log, "--free", f"{CONTACT},{SEEBECK}", "--free", OHM, "-o", rig, "--figure", figure, *RATE)
    assert said.exit_code == 0, said.stderr
    lines = said.stdout.splitlines()
    assert lines[0].split() == ["key", "fitted", "95", "%", "interval", "±"]
    assert [line.split()[0] for line in lines[2:5]] == [CONTACT, SEEBECK, OHM]
    assert float(lines[2].split()[1]) == pytest.approx(7e-4, rel=0.02)
    assert any(line.startswith("display (rig.csv)") for line in lines)
    assert "uncertainty of the fitted rig" in said.stdout and "(was ±30 %)" in said.stdout.replace("\n", " ")
    assert max(map(len, lines)) <= 80
    assert said.stderr == f"wrote {rig}\nwrote {figure}\n"
    assert Rig.load(rig).contact.resistance_m2K_per_W == pytest.approx(7e-4, rel=0.02)
    assert figure.stat().st_size > 20_000


def test_what_is_not_identified_is_named_with_the_cure(cli: Cli, log: Path) -> None:
    said = cli("fit", log, "--free", "ambient.temperature_C,skin.rest_C", *RATE, "--set", f"{CONTACT}=7e-4")
    assert said.exit_code == 0, said.stderr
    text = " ".join(said.stdout.split())
    assert "not identified: ambient.temperature_C; cannot be separated from skin at rest here; measure it" in text
    assert "strongly correlated: ambient.temperature_C and skin.rest_C (1.00)" in text


def test_a_plan_says_before_measuring_what_helps(cli: Cli) -> None:
    said = cli(
        "fit",
        "--plan",
        "--free",
        f"{CONTACT},{SEEBECK},module.thermal_resistance_K_per_W,heat_sink.temperature_C",
        "--fixed-skin",
    )
    assert said.exit_code == 0, said.stderr
    assert "95 % intervals to expect" in " ".join(said.stdout.split())
    lines = [line.replace("(", "").split() for line in said.stdout.splitlines()]
    assert ["key", "D", "D", "V", "D", "V", "H", "D", "S", "D", "V", "H", "S"] in lines
    contact = next(line for line in lines if line[:1] == [CONTACT])
    alone, both = (float(contact[place].removeprefix("±")) for place in (1, 3))
    assert alone > 1.5 * both


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "name the keys to fit"),
        (("--free", CONTACT), "give a LOG, or --plan"),
        (("a.csv", "--plan", "--free", CONTACT), "leave out LOG, or --plan"),
        (("--plan", "--free", CONTACT, "-o", "a.toml"), "prints a table only"),
        (("a.csv", "--free", CONTACT, "--offset", "-1"), "-1 K is outside 0 to 10 K"),
    ],
)
def test_a_command_line_that_makes_no_sense(cli: Cli, arguments: tuple[str, ...], message: str) -> None:
    said = cli("fit", *arguments)
    assert said.exit_code == 2
    assert message in " ".join(said.stderr.replace("│", " ").split())


def test_bad_input_is_one_sentence_and_leaves_nothing(cli: Cli, log: Path, tmp_path: Path) -> None:
    out = tmp_path / "mine.toml"
    for arguments, message in (
        ((tmp_path / "none.csv", "--free", CONTACT), "none.csv: no such log"),
        ((log, "--free", CONTACT, "--rig", "tcs2"), "no log has a drive"),
    ):
        said = cli("fit", *arguments, "-o", out)
        assert said.exit_code == 1
        assert message in said.stderr and "Traceback" not in said.stderr
        assert not out.exists()
    said = cli("fit", log, "--free", CONTACT, "-o", log)
    assert said.exit_code == 1 and "a rig is written as .toml" in said.stderr


def test_a_key_that_is_held_wrong_is_named_and_the_rig_gets_its_name(cli: Cli, tmp_path: Path) -> None:
    path, rig = tmp_path / "sink.csv", tmp_path / "tuesday.toml"
    truth = Rig.load("thenar").with_(**{CONTACT: 7e-4, "heat_sink.resistance_K_per_W": 0.5})
    write_log(synthetic_log(truth, seed=1, rate_Hz=20.0), path)
    said = cli("fit", path, "--free", CONTACT, "-o", rig, "--fixed-skin", *RATE)
    text = " ".join(said.stderr.split())
    assert "display_C: residuals of 51.3 mK rms exceed the log's own noise of 2" in text
    assert "what is held fixed is taken as right: free heat_sink.resistance_K_per_W" in text
    assert Rig.load(rig).name == "tuesday"
    named = cli("fit", path, "--free", f"{CONTACT},heat_sink.resistance_K_per_W", "-o", rig, "--name", "bench 2", *RATE)
    assert "exceed the log's own noise" not in named.stderr
    assert Rig.load(rig).name == "bench 2"
    assert cli("fit", path, "--free", CONTACT, "--name", "bench").exit_code == 2


def test_misspelt_columns_and_text_cells_are_named(cli: Cli, log: Path, tmp_path: Path) -> None:
    text = log.read_text(encoding="utf-8")
    wrong = tmp_path / "wrong.csv"
    wrong.write_text(text.replace("display_C", "Display_c"), encoding="utf-8")
    said = cli("fit", wrong, "--free", CONTACT, *RATE)
    assert said.exit_code == 1
    assert "wrong.csv: Display_c: did you mean display_C? Rename it" in said.stderr
    lines = text.splitlines()
    place = lines[0].split(",").index("display_C")
    for row in range(100, 110):
        cells = lines[row].split(",")
        cells[place] = "n/a"
        lines[row] = ",".join(cells)
    gaps = tmp_path / "gaps.csv"
    gaps.write_text("\n".join(lines) + "\n", encoding="utf-8")
    said = cli("fit", gaps, "--free", CONTACT, *RATE)
    assert "display_C is 'n/a' in 10 of" in said.stderr


def test_a_current_by_another_name_and_one_log_twice_are_named(cli: Cli, log: Path, tmp_path: Path) -> None:
    text = log.read_text(encoding="utf-8")
    amps, twin = tmp_path / "amps.csv", tmp_path / "twin.csv"
    amps.write_text(text.replace("current_A", "amps"), encoding="utf-8")
    twin.write_text(text, encoding="utf-8")
    said = cli("fit", amps, "--free", CONTACT, *RATE)
    words = " ".join(said.stderr.split())
    assert said.exit_code == 1 and "voltage_V of amps.csv, which is taken as the drive" in words
    assert "columns that are not used: amps (rename it current_A, if that is what it is)" in words
    for second in (log, twin):
        said = cli("fit", log, second, "--free", CONTACT, *RATE)
        assert said.exit_code == 1 and "has the same content as rig.csv" in " ".join(said.stderr.split())


def test_an_interval_that_says_nothing_is_said_to(cli: Cli, log: Path) -> None:
    said = cli(
        "fit",
        log,
        "--rig",
        "fingertip",
        "--free",
        f"{CONTACT},heat_sink.temperature_C,{SEEBECK}",
        "--fixed-skin",
        *RATE,
    )
    row = next(line for line in said.stdout.splitlines() if line.startswith(CONTACT))
    assert row.split()[2:] == ["not", "known", "unknown"]
    assert "K   " in next(line for line in said.stdout.splitlines() if line.startswith("display ("))
    assert "widened as far as a rig file may state" in " ".join(said.stdout.split())


@pytest.mark.slow
def test_a_log_is_laid_beside_a_trace(cli: Cli, log: Path, tmp_path: Path) -> None:
    figure = tmp_path / "beside.png"
    said = cli("simulate", "calibration-drive", "--measured", log, "--figure", figure, "--set", f"{CONTACT}=7e-4")
    assert said.exit_code == 0, said.stderr
    assert "measured − simulated (rig.csv, shifted by" in said.stdout
    line = next(line for line in said.stdout.splitlines() if line.startswith("  display   rms"))
    assert 0.01 < float(line.split()[2]) < 0.1
    assert figure.stat().st_size > 20_000
    several = cli("simulate", "six-icons", "--measured", log)
    assert several.exit_code == 2
    assert "name it with --icon" in several.stderr
