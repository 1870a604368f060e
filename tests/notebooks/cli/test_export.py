"""``thermicon export``: files, words, exit codes; what is refused leaves nothing."""

from __future__ import annotations

import json
import re
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
STRONG = (
    "--set", "driver.current_limit_A=4", "--set", "driver.voltage_limit_V=40",
    "--set", "driver.transconductance_A_per_V=1",
)  # fmt: skip


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir()) if folder.is_dir() else []


def one_icon(folder: Path, name: str, cue: str, control: str = "skin") -> Path:
    """A file with one icon."""
    path = folder / f"{name}.cue"
    path.write_text(
        f"cue 1\nset s {{ control {control}\n baseline 32 °C }}\nicon {name} {{ {cue} }}\n", encoding="utf-8"
    )
    return path


def device(folder: Path, name: str, old: str, new: str) -> Path:
    """A shipped device with another number."""
    path = folder / "own.toml"
    shipped = (resources.files("thermicon.circuit") / "devices" / f"{name}.toml").read_text("utf-8")
    path.write_text(shipped.replace(f"value = {old}", f"value = {new}"), "utf-8")
    return path


@pytest.mark.slow
def test_every_icon_gets_a_drive_and_a_sidecar(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    weak = ("--set", "driver.transconductance_A_per_V=0.1")
    said = cli("export", two, "--to", "csv", "--device", "dac-16", "-o", out, *weak, *SURE)
    assert (said.exit_code, said.stdout) == (0, "")
    assert names(out) == ["cool-step.csv", "cool-step.json", "warm-step.csv", "warm-step.json"]
    for words in (
        "warning: the worst case of safety is milder: contact resistance ±0 % instead of ±30 %",
        "cool-step: 8.01 s at 100 Hz on dac-16, receptors within ",
        "safety green in 3 scenarios",
        "warning: cool-step: dac-16 plays −1 … 1 A (−10 … 10 V through ",
        f"wrote 2 drives with their sidecars into {out}: cool-step.json, cool-step.csv, warm-step.json",
        "to play: put out each row's command at its time",
    ):
        assert words in said.stderr
    assert said.stderr.splitlines()[-1].startswith("safety is a calculation, not a medical or ethical clearance")
    told = json.loads((out / "cool-step.json").read_text())
    assert set(told["perception"]["d_prime"]) == {"warm-step"}


def test_simulate_replays_an_exported_drive_exactly(cli: Cli, two: Path, tmp_path: Path) -> None:
    cli.good("export", two, "--icon", "warm-step", "--to", "csv", "-o", tmp_path / "out", *SURE)
    trace = tmp_path / "trace.csv"
    cli.good("simulate", "--current", tmp_path / "out" / "warm-step.csv", "--hold", "-o", trace, *SURE)
    ours = deliver(read_cue(str(two))["warm-step"], Rig.load("thenar"), Device.load("dac-16")).trace.to_frame()
    theirs = pd.read_csv(trace)
    for column in ("time_s", "current_A", "display_C", "skin_C", "cold_receptor_C", "warm_receptor_C"):
        # nine digits are written
        assert np.abs(theirs[column] - ours[column]).max() < 1e-6, column


@pytest.mark.parametrize(
    "name", ["c-array", "tcs2-serial", "psychopy", "setpoint-csv", pytest.param("wav", marks=pytest.mark.slow)]
)
def test_every_format_has_a_device_of_its_own(cli: Cli, two: Path, tmp_path: Path, name: str) -> None:
    said = cli.good("export", two, "--to", name, "-o", tmp_path / "out", *SURE)
    assert len(names(tmp_path / "out")) == {"psychopy": 6, "c-array": 5}.get(name, 4)
    open_loop = name not in ("tcs2-serial", "setpoint-csv")
    assert ("open loop: with a module that was not measured" in said.stderr) is open_loop
    if name == "tcs2-serial":
        assert said.stderr.splitlines()[1].startswith("cool-step: 8 s in 3 segments on qst-tcs2, receptors within ")
        told = json.loads((tmp_path / "out" / "cool-step.json").read_text())
        assert told["played"]["duration_s"] == told["predicted"]["duration_s"] == 8.0


class TestRefused:
    """Exit code 3, and nothing written."""

    @pytest.mark.parametrize(
        ("cue", "more", "words"),
        [
            (
                "cool by 20 °C at 2 °C/s; hold for 8 s; return at 2 °C/s",
                (*STRONG, *SURE[2:]),
                "safety red in 9 scenarios",
            ),
            ("warm by 9.2 °C at 2 °C/s; hold for 3 s; return at 2 °C/s", (), "gain +10 %"),
        ],
        ids=["as given", "only in the worst case"],
    )
    def test_unsafe_even_when_forced(
        self, cli: Cli, tmp_path: Path, cue: str, more: tuple[str, ...], words: str
    ) -> None:
        path = one_icon(tmp_path, "deep", cue)
        said = cli("export", path, "--to", "csv", "-o", tmp_path / "out", "--force", *more)
        assert said.exit_code == 3
        told = next(line for line in said.stderr.splitlines() if line.startswith("refused"))
        assert told.startswith("refused: deep is NOT SAFE: skin surface reaches ")
        assert re.search(r"reaches \S+ °C at \S+ s, with .*, (above|below) the hard limit of .* \(.*\)", told)
        assert words in said.stderr
        assert "not a medical or ethical clearance" in said.stderr
        assert said.stderr.endswith("nothing was written\n")
        assert "--force exports it" not in said.stderr
        assert not (tmp_path / "out").exists()

    @pytest.mark.parametrize(
        ("to", "more", "words"),
        [
            ("csv", ("--set", "driver.current_limit_A=0.7"), "cool-step is NOT reached: misses its target by "),
            ("c-array", ("--device", "own.toml"), "cool-step loses too much: the "),
        ],
    )
    def test_what_is_not_reached_or_lossy_unless_forced(
        self, cli: Cli, two: Path, monkeypatch: pytest.MonkeyPatch, to: str, more: tuple[str, ...], words: str
    ) -> None:
        monkeypatch.chdir(two.parent)
        device(two.parent, "pwm-h-bridge-10", "11", "8")
        said = cli("export", two, "--to", to, "-o", "out", *more, *SURE)
        assert said.exit_code == 3
        assert said.stderr.count("refused: cool-step ") == said.stderr.count(f"refused: {words}") == 1
        assert "--force exports it nevertheless, and the sidecar records that" in said.stderr
        assert not Path("out").exists()
        said = cli.good("export", two, "--to", to, "-o", "out", *more, *SURE, "--force")
        assert f"forced: {words}" in said.stderr
        told = json.loads(next(Path("out").glob("cool*.json")).read_text())
        assert told["forced"] is True
        assert told["forced_over"][0].startswith(("NOT reached: ", "loses too much"))
        assert told["reached"] is (to != "csv")


@pytest.mark.parametrize(
    ("name", "more", "words"),
    [
        ("warm-step.csv", (), "warm-step.csv already exists and was kept; --force replaces the folder"),
        ("cool-step.json", ("--force",), "cool-step.json was not written by an export, since no sidecar lists it"),
    ],
)
def test_a_file_in_the_way_is_reported_before_anything_is_simulated(
    cli: Cli, two: Path, monkeypatch: pytest.MonkeyPatch, name: str, more: tuple[str, ...], words: str
) -> None:
    monkeypatch.setattr("thermicon.circuit.delivery.export.prepare_set", None)
    out = two.parent / "out"
    out.mkdir()
    (out / name).write_text("{}")
    said = cli("export", two, "--to", "csv", "-o", out, *more)
    assert said.exit_code == 1
    assert words in said.stderr
    assert (out / name).read_text() == "{}"


def test_another_icon_that_the_device_cannot_play_is_left_out_of_the_comparison(cli: Cli, tmp_path: Path) -> None:
    path = one_icon(tmp_path, "good", "warm by 2 °C at 1 °C/s; return at 1 °C/s", "display")
    busy = "icon busy { repeat 400 { warm by 0.2 °C at 4 °C/s; return at 4 °C/s; rest for 0.1 s } }\n"
    path.write_text(path.read_text(encoding="utf-8") + busy, encoding="utf-8")
    said = cli.good("export", path, "--icon", "good", "--to", "tcs2-serial", "-o", tmp_path / "out", *SURE)
    assert "warning: busy cannot be played, so nothing is compared with it: qst-tcs2: 1200 segments" in said.stderr


def test_very_many_icons_are_not_compared_with_each_other(
    cli: Cli, two: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("thermicon.notebooks.files.exporting.MOST_COMPARED", 1)
    said = cli.good("export", two, "--to", "tcs2-serial", "-o", tmp_path / "out", *SURE)
    assert "warning: 2 icons are too many to compare" in said.stderr
    assert json.loads((tmp_path / "out" / "cool-step.json").read_text())["perception"]["d_prime"] == {}
