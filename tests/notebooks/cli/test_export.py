"""``thermicon export`` and ``thermicon list devices``: files, words, exit codes."""

from __future__ import annotations

import json
import re
import wave
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tests.circuit.surerig import SURE
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.deliver import deliver
from thermicon.icons import read_cue

Cli = Callable[..., Any]
COLD = """cue 1

set deep { control skin
  baseline 32 °C }

icon frost { cool by 20 °C at 2 °C/s; hold for 8 s; return at 2 °C/s }
"""
STRONG = (
    "--set", "driver.current_limit_A=4", "--set", "driver.voltage_limit_V=40",
    "--set", "driver.transconductance_A_per_V=1",
)  # fmt: skip


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir()) if folder.is_dir() else []


@pytest.mark.slow
def test_every_icon_gets_a_drive_and_a_sidecar(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    weak = ("--set", "driver.transconductance_A_per_V=0.1")
    said = cli("export", two, "--to", "csv", "--device", "dac-16", "-o", out, *weak, *SURE)
    assert (said.exit_code, said.stdout) == (0, "")
    assert names(out) == ["cool-step.csv", "cool-step.json", "warm-step.csv", "warm-step.json"]
    lines = [line for line in said.stderr.splitlines() if "the worst case of safety is milder" not in line]
    assert lines.pop(0).startswith("warning: driver.current_limit_A = 1.5 A takes 15 V of command")
    assert lines[0].startswith("cool-step: 8.01 s at 100 Hz on dac-16, receptors within ")
    assert lines[0].endswith("mK), safety green in 3 scenarios")
    assert "warning: cool-step: dac-16 plays −1 … 1 A (−10 … 10 V through " in said.stderr
    assert (
        f"wrote 2 drives with their sidecars into {out}: cool-step.json, cool-step.csv, warm-step.json" in said.stderr
    )
    assert "to play: put out each row's command at its time" in said.stderr
    assert lines[-1].startswith(
        "safety is a calculation, not a medical or ethical clearance; hardware on skin needs a temp"
    )
    told = json.loads((out / "cool-step.json").read_text())
    assert set(told["perception"]["d_prime"]) == {"warm-step"}


def test_simulate_replays_an_exported_drive_exactly(cli: Cli, two: Path, tmp_path: Path) -> None:
    assert cli("export", two, "--icon", "warm-step", "--to", "csv", "-o", tmp_path / "out", *SURE).exit_code == 0
    trace = tmp_path / "trace.csv"
    assert cli("simulate", "--current", tmp_path / "out" / "warm-step.csv", "--hold", "-o", trace, *SURE).exit_code == 0
    ours = deliver(read_cue(str(two))["warm-step"], Rig.load("thenar"), Device.load("dac-16")).trace.to_frame()
    theirs = pd.read_csv(trace)
    for column in ("time_s", "current_A", "display_C", "skin_C", "cold_receptor_C", "warm_receptor_C"):
        # nine digits are written
        assert np.abs(theirs[column] - ours[column]).max() < 1e-6, column


def test_one_icon_is_still_compared_with_the_others(cli: Cli, tmp_path: Path) -> None:
    said = cli("export", "six-icons", "--icon", "double-dip", "--to", "tdms", "-o", tmp_path / "out", *SURE)
    assert said.exit_code == 0, said.stderr
    assert names(tmp_path / "out") == ["double-dip.json", "double-dip.tdms"]
    assert "wrote 1 drive with its sidecar into " in said.stderr
    assert len(json.loads((tmp_path / "out" / "double-dip.json").read_text())["perception"]["d_prime"]) == 5


@pytest.mark.parametrize(
    "name",
    [
        *("c-array", "tcs2-serial", "psychopy", "setpoint-csv"),
        pytest.param("wav", marks=pytest.mark.slow),
    ],
)
def test_every_format_has_a_device_of_its_own(cli: Cli, two: Path, tmp_path: Path, name: str) -> None:
    said = cli("export", two, "--to", name, "-o", tmp_path / "out", *SURE)
    assert said.exit_code == 0, said.stderr
    assert len(names(tmp_path / "out")) == {"psychopy": 6, "c-array": 5}.get(name, 4)
    open_loop = name not in ("tcs2-serial", "setpoint-csv")
    assert ("open loop: with a module that was not measured" in said.stderr) is open_loop


class TestRefused:
    """Exit code 3, and nothing written."""

    @pytest.mark.parametrize(
        ("more", "scenarios"), [(("--force", *SURE[2:]), 9), pytest.param((), 483, marks=pytest.mark.slow)]
    )
    def test_unsafe_even_when_forced(self, cli: Cli, tmp_path: Path, more: tuple[str, ...], scenarios: int) -> None:
        path = tmp_path / "deep.cue"
        path.write_text(COLD, encoding="utf-8")
        said = cli("export", path, "--to", "csv", "-o", tmp_path / "out", *STRONG, *more)
        assert said.exit_code == 3
        assert "refused: frost is NOT SAFE: skin surface reaches " in said.stderr
        told = next(line for line in said.stderr.splitlines() if line.startswith("refused"))
        for word in ("above the hard limit", "below the hard limit"):
            told = told.replace(word, "beyond the hard limit")
        assert re.search(r"reaches \S+ °C at \S+ s, with contact .*, beyond the hard limit of .* \(.*\)", told)
        assert f"safety red in {scenarios} scenarios" in said.stderr
        assert "not a medical or ethical clearance; hardware on skin needs a temperature cut-off" in said.stderr
        assert said.stderr.endswith("nothing was written\n")
        assert "--force exports it" not in said.stderr
        assert not (tmp_path / "out").exists()

    def test_red_only_in_the_worst_case_is_refused_too(self, cli: Cli, tmp_path: Path) -> None:
        path = tmp_path / "hot.cue"
        path.write_text(
            "cue 1\nset s { control skin\n baseline 32 °C }\n"
            "icon hot { warm by 9.2 °C at 2 °C/s; hold for 3 s; return at 2 °C/s }\n",
            encoding="utf-8",
        )
        said = cli("export", path, "--to", "csv", "-o", tmp_path / "out", "--force")
        assert said.exit_code == 3
        assert "refused: hot is NOT SAFE: skin surface reaches 4" in said.stderr
        assert "gain +10 %" in said.stderr
        assert not (tmp_path / "out").exists()

    @pytest.mark.slow
    def test_amber_is_written_with_its_worst_case_as_a_warning(self, cli: Cli, tmp_path: Path) -> None:
        path = tmp_path / "warm.cue"
        path.write_text(
            "cue 1\nset s { control display\n baseline 32 °C }\n"
            "icon warm { warm by 7 °C at 3 °C/s; hold for 3 s; return at 3 °C/s }\n",
            encoding="utf-8",
        )
        said = cli("export", path, "--to", "csv", "-o", tmp_path / "out")
        assert said.exit_code == 0, said.stderr
        assert "safety amber in 195 scenarios" in said.stderr
        assert re.search(
            r"warning: warm: skin surface reaches \S+ °C at \S+ s, with contact .* soft limit", said.stderr
        )

    def test_unreachable_unless_forced(self, cli: Cli, two: Path, tmp_path: Path) -> None:
        arguments = ("export", two, "--to", "csv", "-o", tmp_path / "out", "--set", "driver.current_limit_A=0.7", *SURE)
        said = cli(*arguments)
        assert said.exit_code == 3
        assert "refused: cool-step is NOT reached: misses its target by " in said.stderr
        assert "--force exports it nevertheless, and the sidecar records that" in said.stderr
        assert not (tmp_path / "out").exists()
        said = cli(*arguments, "--force")
        assert said.exit_code == 0
        assert "forced: cool-step is NOT reached: " in said.stderr
        told = json.loads((tmp_path / "out" / "cool-step.json").read_text())
        assert (told["reached"], told["forced"]) == (False, True)
        assert told["forced_over"][0].startswith("NOT reached: ")

    def test_lossy_unless_forced(self, cli: Cli, two: Path, tmp_path: Path) -> None:
        shipped = (resources.files("thermicon.circuit") / "devices" / "pwm-h-bridge-10.toml").read_text("utf-8")
        (tmp_path / "coarse.toml").write_text(shipped.replace("value = 11", "value = 8"), "utf-8")
        arguments = (
            "export", two, "--to", "c-array", "--device", tmp_path / "coarse.toml", "-o", tmp_path / "out", *SURE,
        )  # fmt: skip
        said = cli(*arguments)
        assert said.exit_code == 3
        assert re.search("refused: cool-step loses too much: the (cold|warm) receptor differs by ", said.stderr)
        assert said.stderr.count("refused: cool-step ") == 1
        assert not (tmp_path / "out").exists()
        assert cli(*arguments, "--force").exit_code == 0
        assert json.loads((tmp_path / "out" / "cool_step.json").read_text())["forced"] is True


class TestFiles:
    """Where files go."""

    @pytest.mark.slow
    def test_files_that_are_there_are_kept_unless_forced(self, cli: Cli, two: Path, tmp_path: Path) -> None:
        out = tmp_path / "out"
        assert cli("export", two, "--to", "csv", "-o", out, *SURE).exit_code == 0
        (out / "cool-step.csv").write_text("mine")
        said = cli("export", two, "--to", "csv", "-o", out, *SURE)
        assert said.exit_code == 1
        assert f"{out / 'cool-step.csv'} and 3 more already exist and were kept; --force replaces" in said.stderr
        assert (out / "cool-step.csv").read_text() == "mine"
        assert cli("export", two, "--to", "csv", "-o", out, "--force", *SURE).exit_code == 0
        assert (out / "cool-step.csv").read_text() != "mine"
        assert (tmp_path / "out.before" / "cool-step.csv").read_text() == "mine"
        assert json.loads((out / "cool-step.json").read_text())["forced"] is False

    @pytest.mark.parametrize(
        ("name", "more", "words"),
        [
            ("warm-step.csv", (), "warm-step.csv already exists and was kept; --force replaces it"),
            ("cool-step.json", ("--force",), "cool-step.json was not written by an export, since no sidecar lists it"),
        ],
    )
    def test_a_file_in_the_way_is_reported_before_anything_is_simulated(
        self,
        cli: Cli,
        two: Path,
        tmp_path: Path,
        monkeypatch: pytest.MonkeyPatch,
        name: str,
        more: tuple[str, ...],
        words: str,
    ) -> None:
        def simulated(*_: object, **__: object) -> None:
            raise AssertionError("simulated")

        monkeypatch.setattr("thermicon.circuit.delivery.export.prepare_set", simulated)
        out = tmp_path / "out"
        out.mkdir()
        (out / name).write_text("{}")
        said = cli("export", two, "--to", "csv", "-o", out, *more)
        assert said.exit_code == 1
        assert words in said.stderr
        assert (out / name).read_text() == "{}"

    def test_a_folder_in_no_folder_is_told_at_once(self, cli: Cli, two: Path, tmp_path: Path) -> None:
        said = cli("export", two, "--to", "csv", "-o", tmp_path / "a" / "b")
        assert said.exit_code == 1
        assert "does not exist; make it first" in said.stderr


@pytest.mark.parametrize(
    ("arguments", "words", "code"),
    [
        (("--to", "cvs", "-o", "out"), "cvs: no such format; did you mean csv?", 1),
        (("--to", "csv", "--device", "dac16", "-o", "out"), "dac16: no such device; did you mean dac-16", 1),
        (
            ("--to", "csv", "--device", "qst-tcs2", "-o", "out"),
            "csv is for devices driven by volts or amperes or duty",
            1,
        ),
        (("--to", "csv", "--icon", "col-step", "-o", "out"), "did you mean cool-step?", 1),
        (("--to", "csv", "--tail", "nan", "-o", "out"), "'--tail': nan s is outside 0 to 86400 s", 2),
        (("--to", "csv"), "Missing option '-o'", 2),
        (("-o", "out"), "Missing option '--to'", 2),
    ],
)
def test_what_cannot_be(
    cli: Cli, two: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], words: str, code: int
) -> None:
    monkeypatch.chdir(two.parent)
    said = cli("export", two, *arguments)
    assert (said.exit_code, said.stdout) == (code, "")
    assert words in " ".join(said.stderr.split())
    assert not Path("out").exists()


def test_another_icon_that_the_device_cannot_play_is_left_out_of_the_comparison(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "mixed.cue"
    path.write_text(
        "cue 1\nset s { control display\n baseline 32 °C }\nicon good { warm by 2 °C at 1 °C/s; return at 1 °C/s }\n"
        "icon busy { repeat 400 { warm by 0.2 °C at 4 °C/s; return at 4 °C/s; rest for 0.1 s } }\n",
        encoding="utf-8",
    )
    said = cli("export", path, "--icon", "good", "--to", "tcs2-serial", "-o", tmp_path / "out", *SURE)
    assert said.exit_code == 0, said.stderr
    assert "warning: busy cannot be played, so nothing is compared with it: qst-tcs2: 1200 segments" in said.stderr


def test_very_many_icons_are_not_compared_with_each_other(
    cli: Cli, two: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("thermicon.notebooks.files.exporting.MOST_COMPARED", 1)
    said = cli("export", two, "--to", "tcs2-serial", "-o", tmp_path / "out", *SURE)
    assert said.exit_code == 0, said.stderr
    assert "warning: 2 icons are too many to compare with each other; d′ is left out" in said.stderr
    assert json.loads((tmp_path / "out" / "cool-step.json").read_text())["perception"]["d_prime"] == {}


def test_devices_and_formats_are_listed(cli: Cli) -> None:
    said = cli("list")
    assert said.exit_code == 0
    for word in ("dac-12", "pwm-h-bridge-10", "set-points", "−10 to 10 V", "15.6 kHz", "tcs2-protocol-ini"):
        assert word in said.stdout
    assert "None of them has been tested on hardware yet." in said.stdout
    assert max(len(line) for line in said.stdout.splitlines()) <= 80


class TestUncertainty:
    """Being surer than what is shipped needs a reason, or the worst case would be milder without a word."""

    HOT = (
        "cue 1\nset s { control skin\n baseline 32 °C }\n"
        "icon hot { warm by 9.2 °C at 2 °C/s; hold for 3 s; return at 2 °C/s }\n"
    )

    def export(self, cli: Cli, tmp_path: Path, *more: str) -> Any:
        path = tmp_path / "hot.cue"
        path.write_text(self.HOT, encoding="utf-8")
        return cli("export", path, "--to", "csv", "-o", tmp_path / "out", *SURE[:-2], *more)

    def test_without_a_reason_nothing_is_written(self, cli: Cli, tmp_path: Path) -> None:
        said = self.export(cli, tmp_path)
        assert said.exit_code == 1
        assert "uncertainty.gain_relative = 0: is smaller than the shipped 0.1, which loosens the gate" in said.stderr
        assert "(--set 'uncertainty.reason=\"measured ...\"'), or use 0.1 or more" in said.stderr
        assert not (tmp_path / "out").exists()

    def test_the_reason_stands_in_the_sidecar(self, cli: Cli, tmp_path: Path) -> None:
        why = "measured on our bench, 2026-05-12"
        said = self.export(cli, tmp_path, "--set", f'uncertainty.reason="{why}"')
        assert said.exit_code == 0, said.stderr
        assert (
            "warning: the worst case of safety is milder: contact resistance ±0 % instead of ±30 %; amb" in said.stderr
        )
        told = json.loads((tmp_path / "out" / "hot.json").read_text())
        assert told["safety"]["uncertainty"]["reason"] == why
        assert len(told["safety"]["uncertainty"]["smaller_than_shipped"]) == 7


def test_a_thermode_says_how_long_its_commands_last(cli: Cli, two: Path, tmp_path: Path) -> None:
    said = cli("export", two, "--icon", "cool-step", "--to", "tcs2-serial", "-o", tmp_path / "out", *SURE)
    assert said.stderr.splitlines()[1].startswith("cool-step: 8 s in 3 segments on qst-tcs2, receptors within ")
    told = json.loads((tmp_path / "out" / "cool-step.json").read_text())
    assert told["played"]["duration_s"] == told["predicted"]["duration_s"] == 8.0


@pytest.mark.slow
def test_a_slow_device_gets_a_sound_file_that_plays(cli: Cli, two: Path, tmp_path: Path) -> None:
    text = (Path(__file__).parents[3] / "circuit/devices/dc-coupled-audio.toml").read_text(encoding="utf-8")
    (tmp_path / "slow.toml").write_text(text.replace("value = 48000", "value = 100"), encoding="utf-8")
    said = cli(
        "export",
        two,
        "--to",
        "wav",
        "--device",
        tmp_path / "slow.toml",
        "--icon",
        "cool-step",
        "-o",
        tmp_path / "out",
        *SURE,
    )
    assert said.exit_code == 0, said.stderr
    with wave.open(str(tmp_path / "out" / "cool-step.wav")) as sound:
        assert (sound.getframerate(), sound.getnframes()) == (48000, 802 * 480)
    told = json.loads((tmp_path / "out" / "cool-step.json").read_text())
    assert told["update_rate_Hz"]["realised"] == 100.0
    assert (told["format"]["frames_per_second"], told["format"]["frames_per_update"]) == (48000, 480)
    said = cli("export", two, "--to", "wav", "--device", "dac-16", "-o", tmp_path / "other")
    assert said.exit_code == 1
    assert "wav: dac-16 is not said to be DC-coupled (dc_coupled = true)" in said.stderr
    assert "use dc-coupled-audio, or another format" in said.stderr


@pytest.mark.slow
def test_the_duties_of_a_bridge_are_not_replayed_and_the_message_says_why(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert cli("export", two, "--to", "csv", "--device", "pwm-h-bridge-10", "-o", out, "--force", *SURE).exit_code == 0
    said = cli("simulate", "--current", out / "cool-step.csv", "--hold", "-o", tmp_path / "trace.csv")
    assert said.exit_code == 1
    assert "cool-step.csv:1: these are duties of a bridge, which switches its full current within" in said.stderr


def test_names_that_differ_in_capitals_are_told_before_any_work(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "names.cue"
    path.write_text(
        "cue 1\nset s { control display }\nicon a-b { hold for 1 s }\nicon A-B { hold for 1 s }\n", encoding="utf-8"
    )
    said = cli("export", path, "--to", "csv", "-o", tmp_path / "out")
    assert said.exit_code == 1
    assert said.stderr.startswith(
        "a-b and A-B: differ only in capitals, so that one's files would overwrite the other's"
    )
    assert not (tmp_path / "out").exists()
    assert cli("export", path, "--icon", "A-B", "--to", "csv", "-o", tmp_path / "out", *SURE).exit_code == 0


@pytest.mark.slow
def test_a_rest_outside_its_own_limit_is_told_at_once(cli: Cli, two: Path, tmp_path: Path) -> None:
    said = cli("export", two, "--to", "csv", "-o", tmp_path / "out", "--set", "safety.skin_lowest_C=35", *SURE)
    assert said.exit_code == 3
    assert "warning: the resting skin of 32 °C (skin.rest_C) is itself below the hard limit" in said.stderr
