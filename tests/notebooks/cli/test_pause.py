"""Repetition and the hardware at an export: what ``--pause`` allows, what sidecars and players hold, what is said."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.circuit.surerig import SURE, sure_rig
from thermicon.circuit import Export, Gate, export
from thermicon.circuit.delivery.pack import pack
from thermicon.icons import load_library, parse
from thermicon.notebooks.report.gate_words import gate_words
from thermicon.notebooks.workbench.view_blocks import delivered_html, gate_html

Cli = Callable[..., Any]
GLOW = """cue 1
set s { site thenar; control display; baseline 32 °C }
icon glow { warm by 7 °C at 3 °C/s; hold for 4 s; return at 3 °C/s }
icon dip { cool by 3 °C at 2 °C/s; return at 2 °C/s }
"""


def prepared(form: str) -> Export:
    return export(parse(GLOW), sure_rig(), format=form, pause_s=60.0)


@pytest.fixture(scope="module")
def glow() -> Export:
    """Two icons for PsychoPy, played a minute apart on a rig that is known exactly."""
    return prepared("psychopy")


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
    assert "the hardware must provide" not in said.stderr
    said = cli.good(*arguments, "--pause", told[1])
    assert json.loads((out / "glow.json").read_text())["safety"]["repeated"]["pause_s"] == float(told[1])


class TestFiles:
    """What the gate says stands beside the drive and in what plays it."""

    @pytest.mark.slow
    def test_the_sidecar_has_repetition_and_the_demands(self, glow: Export) -> None:
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

    def test_players_have_the_strictest_numbers_of_the_gate(self, glow: Export) -> None:
        ready = prepared("c-array")
        player = pack(ready.prepared, ready.form)["thermicon_player.h"].decode()
        demands = [verdict(ready, place).demands for place in (0, 1)]
        low, high = (
            max(one.cut_off_display_C.low for one in demands),
            min(one.cut_off_display_C.high for one in demands),
        )
        rest = max(one.rest_before_first_play_s or 0.0 for one in demands)
        numbers = {name: float(value) for name, value in re.findall(r"#define THERMICON_(\w+) \(?(-?[\d.]+)f", player)}
        assert numbers["WATCHDOG_S"] == min(one.watchdog_s for one in demands) != 0.5
        assert numbers["LOW_C"] == low != 10.0
        assert numbers["HIGH_C"] == high != 43.0
        assert numbers["REACT_S"] == min(one.cut_off_display_C.react_within_s for one in demands)
        assert numbers["REST_S"] == rest != 60.0
        assert numbers["PAUSE_S"] == demands[0].pause_at_least_s != 60.0
        player = pack(glow.prepared, glow.form)["play_icons.py"].decode()
        assert [str(verdict(glow, place).demands) for place in (0, 1)] == list(map(str, demands))
        assert f"LOW_C, HIGH_C = {low}, {high}" in player
        assert f"\nREST_S = {rest}" in player
        assert f"\nPAUSE_S = {demands[0].pause_at_least_s}" in player


class TestWords:
    """What holds for a set is said once, and the strictest of what differs."""

    def test_a_set_in_two_lines(self, glow: Export) -> None:
        (again, repeated), (hardware, demanded) = gate_words(glow.prepared)
        assert (again, hardware) == ("repeated plays, in any order", "the hardware must provide")
        assert repeated.startswith("green, 27 to 29 plays in 30 min with 60 s between them; shortest safe pause: ")
        assert re.search(r"; back within 0.1 K of rest after \S+ s \(dip\) to \S+ s \(glow\)$", repeated)
        strictest = min((verdict(glow, k).demands.watchdog_s, name) for k, name in enumerate(("glow", "dip")))
        assert demanded.startswith(f"watchdog {strictest[0]:g} s ({strictest[1]}), cut-off at ")
        assert "rest held for " in demanded

    def test_what_no_watchdog_and_no_rest_can_do_is_said(self, glow: Export) -> None:
        gate = verdict(glow)
        worse = replace(gate.demands, watchdog_s=0.0, rest_before_first_play_s=None, zero_current_at_most_s=120.0)
        ready = [replace(glow.prepared[0], verdict=replace(gate, demands=worse)), glow.prepared[1]]
        demanded = dict(gate_words(ready))["the hardware must provide"]
        assert demanded.startswith("a current that cannot hang (glow), for which no watchdog is quick enough, cut-off")
        assert "a display at its baseline before it touches the skin (glow)" in demanded
        assert "zero current in contact for 120 s at most" in demanded

    def test_the_page_has_every_check_with_its_scenario_and_each_source_once(self) -> None:
        ready = export(load_library("six-icons")["cooling-step"], "thenar")
        shown = gate_html(ready.prepared[0])
        assert all(f"<td>{check.scenario}</td>" in shown for check in verdict(ready).checks)
        assert shown.count("<sup") == len(verdict(ready).checks) and "contact −30 %" in shown
        source = verdict(ready).checks[0].source
        assert shown.count(f"1 {source}") == 1
        delivered = delivered_html(ready)
        assert "<th>repeated plays</th><td>green, 12 plays" in delivered
        assert delivered.count("the hardware must provide") == 1
