"""``thermicon export`` at the command line."""

import json
import re
from dataclasses import replace
from importlib import resources
from io import StringIO
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.circuit.surerig import SURE, sure_rig
from tests.notebooks.conftest import Cli
from thermicon.base.words.number_text import number
from thermicon.circuit import Device, Export, Gate, Rig, export
from thermicon.circuit.delivery.pack import pack
from thermicon.circuit.delivery.ways import deliver
from thermicon.icons import load_library, parse, read_cue
from thermicon.notebooks.report.gate_words import gate_words
from thermicon.notebooks.workbench.view_blocks import delivered_html, gate_html

DRIVER = ("driver.current_limit_A=4", "driver.voltage_limit_V=40", "driver.transconductance_A_per_V=1")
STRONG = [word for change in DRIVER for word in ("--set", change)]


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def icons(folder: Path, *bodies: str, control: str = "skin") -> Path:
    """A file with icons a, b …"""
    path, written = folder / "own.cue", zip("ab", bodies, strict=False)
    rules = f"cue 1\nset s {{ control {control}; baseline 32 °C }}\n"
    path.write_text(rules + "".join(f"icon {name} {{ {body} }}\n" for name, body in written), encoding="utf-8")
    return path


@pytest.mark.slow
def test_every_icon_gets_a_drive_and_a_sidecar(cli: Cli, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    weak = ("--set", "driver.transconductance_A_per_V=0.1")
    said = cli("export", two, "--to", "csv", "--device", "dac-16", "-o", out, *weak, *SURE)
    assert (said.exit_code, said.stdout) == (0, "")
    assert names(out) == ["cool-step.csv", "cool-step.json", "warm-step.csv", "warm-step.json"]
    for words in (
        *("safety is milder: contact resistance ±0 % instead of ±30 %", "cool-step: 8.01 s at 100 Hz on dac-16"),
        *("safety green in 3 scenarios", "warning: cool-step: dac-16 plays −1 … 1 A (−10 … 10 V through "),
        *(f"wrote 2 drives with their sidecars into {out}: cool-step.json", "to play: output each row's value"),
    ):
        assert words in said.stderr
    assert said.stderr.splitlines()[-2].startswith("safety is a calculation, not a medical or ethical clearance")
    told = json.loads((out / "cool-step.json").read_text())
    assert set(told["perception"]["d_prime"]) == {"warm-step"}


def test_simulate_replays_an_exported_drive_exactly_when_it_is_held(cli: Cli, two: Path, tmp_path: Path) -> None:
    cli.good("export", two, "--icon", "warm-step", "--to", "csv", "-o", tmp_path / "out", *SURE)
    ours = deliver(read_cue(str(two))["warm-step"], Rig.load("thenar"), Device.load("dac-16")).trace.to_frame()
    replay = ("simulate", "--current", tmp_path / "out" / "warm-step.csv", "-o", "-", *SURE)
    held, linear = (pd.read_csv(StringIO(cli.good(*replay, *more).stdout)) for more in (("--hold",), ()))
    for column in ("time_s", "current_A", "display_C", "skin_C", "cold_receptor_C", "warm_receptor_C"):
        # nine digits are written
        assert np.abs(held[column] - ours[column]).max() < 1e-6, column
    assert 1e-3 < np.abs(linear["skin_C"] - ours["skin_C"]).max() < 0.5
    assert held[["icon", "target_C"]].isna().all(axis=None)


@pytest.mark.parametrize(
    "name", ["c-array", "tcs2-serial", "psychopy", "setpoint-csv", pytest.param("wav", marks=pytest.mark.slow)]
)
def test_every_format_has_a_device_of_its_own(cli: Cli, two: Path, tmp_path: Path, name: str) -> None:
    said = cli.good("export", two, "--to", name, "-o", tmp_path / "out", *SURE)
    assert len(names(tmp_path / "out")) == {"psychopy": 6, "setpoint-csv": 6, "c-array": 6}.get(name, 4)
    open_loop = name not in ("tcs2-serial", "setpoint-csv")
    assert ("open loop: with a module that was not measured" in said.stderr) is open_loop
    if name == "tcs2-serial":
        assert "\ncool-step: 8 s in 3 segments on qst-tcs2, receptors within " in said.stderr
        told = json.loads((tmp_path / "out" / "cool-step.json").read_text())
        assert told["played"]["duration_s"] == told["predicted"]["duration_s"] == 8.0


@pytest.mark.parametrize(
    ("cue", "more", "words"),
    [
        ("cool by 20 °C at 2 °C/s; hold for 8 s; return at 2 °C/s", (*STRONG, *SURE[2:]), "red in 9 scenarios"),
        ("warm by 9.2 °C at 2 °C/s; hold for 3 s; return at 2 °C/s", (*SURE[2:4], *SURE[6:]), "gain +10 %"),
    ],
    ids=["as given", "only in the worst case"],
)
def test_unsafe_even_when_forced(cli: Cli, tmp_path: Path, cue: str, more: tuple[str, ...], words: str) -> None:
    said = cli("export", icons(tmp_path, cue), "--to", "csv", "-o", tmp_path / "out", "--force", *more)
    assert said.exit_code == 3
    told = next(line for line in said.stderr.splitlines() if line.startswith("refused"))
    assert told.startswith("refused: a is NOT SAFE: skin surface reaches ")
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
    cli: Cli, two: Path, monkeypatch: pytest.MonkeyPatch, to: str, more: tuple[str, ...], words: str
) -> None:
    monkeypatch.chdir(two.parent)
    shipped = (resources.files("thermicon.circuit") / "devices" / "pwm-h-bridge-10.toml").read_text("utf-8")
    Path("own.toml").write_text(shipped.replace("value = 11", "value = 8"), "utf-8")
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
        ("old.json", (), "old.json already exists and was kept; --force replaces the folder"),
        ("warm-step.csv", (), "was not written by thermicon, since no sidecar lists it, and is kept; move it away, or"),
        ("cool-step.csv", ("--force",), "cool-step.csv was not written by thermicon, since no sidecar lists it"),
    ],
)
def test_a_file_in_the_way_is_reported_before_anything_is_simulated(
    cli: Cli, two: Path, monkeypatch: pytest.MonkeyPatch, name: str, more: tuple[str, ...], words: str
) -> None:
    monkeypatch.setattr("thermicon.circuit.delivery.export.prepare_set", None)
    out = two.parent / "out"
    out.mkdir()
    (out / name).write_text(content := '{"thermicon": "1", "file": "warm-step.wav"}')
    said = cli("export", two, "--to", "csv", "-o", out, *more)
    assert said.exit_code == 1
    assert words in said.stderr
    assert (out / name).read_text() == content


def test_another_icon_that_the_device_cannot_play_is_left_out_of_the_comparison(cli: Cli, tmp_path: Path) -> None:
    busy = "repeat 400 { warm by 0.2 °C at 4 °C/s; return at 4 °C/s; rest for 0.1 s }"
    path = icons(tmp_path, "warm by 2 °C at 1 °C/s; return at 1 °C/s", busy, control="display")
    said = cli.good("export", path, "--icon", "a", "--to", "tcs2-serial", "-o", tmp_path / "out", *SURE)
    assert "warning: b cannot be played, so nothing is compared with it: qst-tcs2: 1200 segments" in said.stderr


def test_very_many_icons_are_not_compared_with_each_other(
    cli: Cli, two: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("thermicon.perception.identification.exported.MOST_COMPARED", 1)
    said = cli.good("export", two, "--to", "tcs2-serial", "-o", tmp_path / "out", *SURE)
    assert "warning: 2 icons are too many to compare" in said.stderr
    assert json.loads((tmp_path / "out" / "cool-step.json").read_text())["perception"]["d_prime"] == {}


GLOW = """cue 1
set s { site thenar; control display; baseline 32 °C }
icon glow { warm by 7 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }
icon dip { cool by 3 °C at 2 °C/s; return at 2 °C/s }
"""


@pytest.fixture(scope="module")
def glow() -> Export:
    """Two icons for PsychoPy, played a minute apart on a rig that is known exactly."""
    return export(parse(GLOW), sure_rig(), format="psychopy", pause_s=60.0)


def verdict(ready: Export, place: int = 0) -> Gate:
    found = ready.prepared[place].verdict
    assert isinstance(found, Gate)
    return found


@pytest.mark.slow
def test_a_pause_that_is_too_short_is_refused_with_the_shortest_as_cure(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "glow.cue").write_text(GLOW, encoding="utf-8")
    out = tmp_path / "out"
    arguments = ("export", tmp_path / "glow.cue", "--icon", "glow", "--to", "csv", "-o", out, *SURE[2:])
    said = cli(*arguments, "--pause", "5", "--force")
    assert (said.exit_code, out.exists()) == (3, False)
    (line,) = [line for line in said.stderr.splitlines() if line.startswith("refused")]
    assert line.startswith("refused: glow is NOT SAFE: skin surface reaches 4")
    assert "repeated plays with 5 s of pause" in line
    told = re.search(r"the shortest safe pause is (\S+) s \(--pause (\S+)\)$", line)
    assert told is not None
    assert told[1] == told[2]
    assert 5.0 < float(told[1]) < 60.0
    assert "your hardware must provide" not in said.stderr
    said = cli.good(*arguments, "--pause", told[1])
    assert json.loads((out / "glow.json").read_text())["safety"]["repeated"]["pause_s"] == float(told[1])


@pytest.mark.slow
def test_the_sidecar_has_repetition_and_the_demands(glow: Export) -> None:
    gate = verdict(glow)
    about = json.loads(pack(glow.prepared, glow.form)["glow.json"])
    safety, demands = about["safety"], about["hardware_must_prevent"]
    assert safety["repeated"]["pause_s"] == 60.0
    assert safety["repeated"]["plays"] == gate.repeated.plays == 27  # (1800 + 60) / (8.68 + 60) s
    assert safety["recovery_s"] == gate.repeated.recovery_s
    assert 0.0 < safety["shortest_pause_s"] < 60.0
    assert demands == json.loads(json.dumps(gate.demands.to_dict()))
    assert 0.0 < demands["watchdog_s"] < 60.0
    cut = demands["cut_off_display_C"]
    assert cut["low"] < 32.0 < 39.0 < cut["high"] <= 45.0
    assert cut["react_within_s"] > 0.0
    assert {"needed", "test_current_A", "test_s", "display_change_at_least_K"} <= set(demands["polarity_check"])
    assert demands["pause_at_least_s"] == safety["shortest_pause_s"]
    assert [fault["prevented_by"] for fault in demands["faults"]].count("") == 0


def test_players_have_the_strictest_numbers_of_the_gate(glow: Export) -> None:
    ready = export(parse(GLOW), sure_rig(), format="c-array", pause_s=60.0)
    player = pack(ready.prepared, ready.form)["thermicon_player.h"].decode()
    demands = [verdict(ready, place).demands for place in (0, 1)]
    low, high = (
        max(one.cut_off_display_C.low for one in demands),
        min(one.cut_off_display_C.high for one in demands),
    )
    rest = max(one.rest_before_first_play_s or 0.0 for one in demands)
    numbers = {name: float(value) for name, value in re.findall(r"#define THERMICON_(\w+) \(?(-?[\d.]+)f", player)}
    watchdog = min(one.watchdog_s for one in demands)
    assert numbers["WATCHDOG_S"] == pytest.approx(watchdog, rel=1e-6)
    assert numbers["WATCHDOG_S"] <= watchdog != 0.5
    assert numbers["LOW_C"] == pytest.approx(low, abs=1e-5) != 10.0
    assert numbers["HIGH_C"] == pytest.approx(high, abs=1e-5)
    react = min(one.cut_off_display_C.react_within_s for one in demands)
    assert numbers["REACT_S"] == pytest.approx(react, rel=1e-6)
    assert numbers["REST_S"] == pytest.approx(rest, rel=1e-6) != 60.0
    assert numbers["PAUSE_S"] == pytest.approx(demands[0].pause_at_least_s, rel=1e-6) != 60.0
    player = pack(glow.prepared, glow.form)["play_icons.py"].decode()
    assert [str(verdict(glow, place).demands) for place in (0, 1)] == list(map(str, demands))
    assert f"LOW_C, HIGH_C = {low}, {high}" in player
    assert f"\nREST_S = {rest}" in player
    assert f"\nPAUSE_S = {demands[0].pause_at_least_s}" in player


def test_repetition_and_hardware_of_a_set_are_said_in_two_lines(glow: Export) -> None:
    (again, repeated), (hardware, demanded) = gate_words(glow.prepared)
    assert (again, hardware) == ("repeated plays, in any order", "your hardware must provide")
    assert repeated.startswith("green, 27 to 29 plays in 30 min with 60 s between them; shortest safe pause: ")
    assert re.search(r"; back within 0.1 K of rest after \S+ s \(dip\) to \S+ s \(glow\)$", repeated)
    strictest = min((verdict(glow, k).demands.watchdog_s, name) for k, name in enumerate(("glow", "dip")))
    assert demanded.startswith(f"watchdog {strictest[0]:g} s ({strictest[1]}), cut-off outside ")
    assert "rest held for " in demanded


def test_what_no_watchdog_and_no_rest_can_do_is_said(glow: Export) -> None:
    gate = verdict(glow)
    worse = replace(gate.demands, watchdog_s=0.0, rest_before_first_play_s=None, zero_current_at_most_s=120.0)
    ready = [replace(glow.prepared[0], verdict=replace(gate, demands=worse)), glow.prepared[1]]
    demanded = dict(gate_words(ready))["your hardware must provide"]
    assert demanded.startswith("a current that cannot hang (glow), for which no watchdog is quick enough, cut-off")
    assert "a display at its baseline before it touches the skin (glow)" in demanded
    assert "zero current in contact for 120 s at most" in demanded
    cut = gate.demands.cut_off_display_C
    warmer = replace(gate.demands, cut_off_display_C=replace(cut, low=cut.low + 1.0, high=cut.high + 1.0))
    both = [replace(glow.prepared[0], verdict=replace(gate, demands=each)) for each in (gate.demands, warmer)]
    demanded = dict(gate_words(both))["your hardware must provide"]
    assert f"cut-off outside {number(cut.low + 1.0, 1)} … {number(cut.high, 1)} °C" in demanded


def test_the_page_of_the_gate_has_every_check_with_its_scenario_and_each_source_once() -> None:
    ready = export(load_library("six-icons")["cooling-step"], "thenar")
    shown = gate_html(ready.prepared[0])
    assert all(f"<td>{check.scenario}</td>" in shown for check in verdict(ready).checks)
    assert shown.count("<sup") == len(verdict(ready).checks) and "contact −30 %" in shown
    source = verdict(ready).checks[0].source
    assert shown.count(f"1 {source}") == 1
    delivered = delivered_html(ready)
    assert "<th>repeated plays</th><td>green, 12 plays" in delivered
    assert delivered.count("your hardware must provide") == 1


def test_icons_on_several_elements_are_told_by_element_and_judged_together(cli: Cli, tmp_path: Path) -> None:
    done = cli(
        "export", "bars", "--rig", "tcs2-strips", "--icon", "upward", "--to", "tcs2-serial", "-o", tmp_path / "x"
    )
    assert done.exit_code == 0
    assert "upward on s5: " in done.stderr and "nearest millimetre by 0.14 K" in done.stderr
    assert "all elements together: green" in done.stderr and "whatever their clocks do" in done.stderr
    assert "zones 1 to 5 are the elements in the order of the layout" in done.stderr
    assert cli("export", "--verify", tmp_path / "x").exit_code == 0
