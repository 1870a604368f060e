"""A study on a device that plays by itself: the simulated controller and a compiled board."""

import csv
import importlib
import json
import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.circuit.live.test_board import board
from tests.circuit.surerig import sure_rig
from thermicon.circuit import Device
from thermicon.circuit.live.ready import CONTROLLER, judged
from thermicon.icons import parse
from thermicon.perception.pilot.trials_file import read_trials

from .conftest import CUES, QUICK, make, rows_of, run_script
from .test_threshold import THRESHOLD

STATED = "loop: gains of the header, lag 0.1 s, the tests"
ON_A_CONTROLLER = QUICK.replace("[stimuli]", f'[stimuli]\ndevice = "{CONTROLLER}"')
FEW = THRESHOLD.replace("[stimuli]", f'[stimuli]\ndevice = "{CONTROLLER}"').replace("trials = 40", "trials = 20")
REHEARSED = ("--participant", "A", "--simulate", "--device", "simulated")


@pytest.fixture(scope="module")
def live(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make(tmp_path_factory.mktemp("live"), ON_A_CONTROLLER)


def logs_of(folder: Path) -> dict[str, list[dict[str, str]]]:
    """The logs of the blocks by the end of their names."""
    paths = sorted((folder / "sub-A" / "beh").glob("*_log.csv"))
    return {path.stem.partition("task-quick_")[2]: rows_of(path) for path in paths}


@pytest.mark.parametrize("order", ["balanced", "williams", "random"])
def test_a_session_of_each_order_has_all_answers_and_a_log_of_each_block(order: str, tmp_path: Path) -> None:
    """The watchdog of a second runs on through gaps, breaks and questions; nothing but the ticks feeds it."""
    study = make(tmp_path, ON_A_CONTROLLER.replace("[trials]", f'[trials]\norder = "{order}"'))
    ran = run_script(study, tmp_path / "data", *REHEARSED)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert "A: done; 8 answers" in ran.stdout
    run_script(study, tmp_path / "data", "--collect")
    trials = read_trials(tmp_path / "data" / "answers.csv", ["dip", "glow"])
    assert int(trials.counts.sum()) == 8
    conditions = rows_of(study / "sub-A_task-quick_conditions.csv")
    logs = logs_of(tmp_path / "data")
    assert [*logs] == [f"run-1_block-{number}_log" for number in range(3)]
    for number, rows in enumerate(logs.values()):
        played = [row["icon"] for row in rows if row["event"] == "play"]
        assert played == [row["icon"] for row in conditions if row["block"] == str(number)]
        assert rows[0]["event"].startswith("simulated controller on the circuit of rig thenar")
        assert np.diff([float(row["time_s"]) for row in rows]).max() < 0.02
    shown = rows_of(next((tmp_path / "data" / "sub-A" / "beh").glob("*_events.tsv")), "\t")
    onsets = [float(row["onset"]) for row in shown]
    begun = [float(row["time_s"]) for rows in logs.values() for row in rows if row["event"] == "play"]
    assert np.allclose(begun, onsets, atol=0.05), "log and events have one clock"


@pytest.mark.slow
def test_a_threshold_is_measured_too(tmp_path: Path) -> None:
    study = make(tmp_path, FEW)
    ran = run_script(study, tmp_path / "data", *REHEARSED, "--threshold", "0.5")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert len(rows_of(tmp_path / "data" / "sub-A_task-cold_answers.csv")) == 20
    assert len([*(tmp_path / "data").rglob("*_log.csv")]) == 1


def test_the_log_holds_what_the_display_did(live: Path, tmp_path: Path) -> None:
    ran = run_script(live, tmp_path, *REHEARSED, "--press", "115:q")
    assert ran.returncode == 0
    rows = logs_of(tmp_path)["run-1_block-0_log"]
    assert not any(float(row["current_A"]) for row in rows[:500]), "it begins 5 s before the output goes on"
    assert [row["event"] for row in rows if row["event"]][1:3] == ["silence", "polarity test and rest"]
    glow = np.array([float(row["probe_loop_C"]) for row in rows if row["icon"] == "glow"])
    assert glow.max() == pytest.approx(34.0, abs=0.1)
    last = [*logs_of(tmp_path).values()][-1]
    assert any(row["event"] == "output off" for row in last[-5:])
    assert float(last[-1]["current_A"]) == 0.0
    before = {path: path.read_bytes() for path in tmp_path.rglob("*_log.csv")}
    again = run_script(live, tmp_path, *REHEARSED, "--resume")
    assert "A: done; 8 answers" in again.stdout
    assert all(path.read_bytes() == content for path, content in before.items())
    assert {name[:5] for name in logs_of(tmp_path)} == {"run-1", "run-2"}


@pytest.mark.parametrize(
    ("file", "text", "words"),
    [
        ("play_icons.py", "\ndef keep():\n    pass\n", "the host was silent for 1 s"),
        ("study.json", "60", "after 1.3 s of silence the device did not switch off; set its watchdog to 1 s"),
    ],
    ids=["nobody feeds in the gap", "a watchdog of a minute"],
)
def test_a_device_that_is_not_fed_switches_off_and_one_that_would_not_is_refused(
    file: str, text: str, words: str, live: Path, tmp_path: Path
) -> None:
    study = Path(shutil.copytree(live, tmp_path / "study"))
    if file == "study.json":
        facts = json.loads((study / file).read_text(encoding="utf-8"))
        facts["live"]["controller"]["watchdog_s"] = float(text)
        (study / file).write_text(json.dumps(facts), encoding="utf-8")
    else:
        (study / file).write_text((study / file).read_text(encoding="utf-8") + text, encoding="utf-8")
    ran = run_script(study, tmp_path / "data", *REHEARSED)
    assert (ran.returncode, ran.stderr) == (3, "")
    assert words in ran.stdout
    assert "SWITCHED OFF" in ran.stdout
    rows = [*logs_of(tmp_path / "data").values()][-1]
    if file == "study.json":
        assert not any(float(row["current_A"]) for row in rows), "nothing was put out"


def test_the_abort_key_switches_off_in_every_phase(live: Path, tmp_path: Path) -> None:
    for at_s in (3, 7, 15, 40, 98, 105):
        ran = run_script(live, tmp_path / str(at_s), *REHEARSED, "--press", f"{at_s}:escape")
        assert (ran.returncode, ran.stderr) == (3, "")
        assert "ABORTED by key; the display is off" in ran.stdout
        rows = [*logs_of(tmp_path / str(at_s)).values()][-1]
        assert rows[-1]["set_point_C"] == ""


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("--device board", "--port belongs to --device board, which needs it"),
        ("--device simulated --port COM3", "--port belongs to --device board"),
        ("--device board --port COM3 --simulate", "a board plays in real time; leave out --simulate"),
        ("--device board --port COM3 --channel Dev1/ao0", "reads and feeds by itself; leave out --bench and --channel"),
        ("--device board --port /dev/nowhere", "since nobody provides: loop ("),
        ("--device board --port /dev/nowhere --stated loop:gains", "since nobody provides: loop ("),
        (f"--device board --port /dev/nowhere --stated '{STATED}'", "the port /dev/nowhere cannot be opened"),
    ],
)
def test_what_does_not_go_together_is_refused_before_anything_is_put_out(
    words: str, told: str, live: Path, tmp_path: Path
) -> None:
    arguments = next(csv.reader([words], delimiter=" ", quotechar="'"))
    ran = run_script(live, tmp_path / "data", "--participant", "A", *arguments)
    assert ran.returncode == 1
    assert told in ran.stderr
    assert "Traceback" not in ran.stderr
    assert not (tmp_path / "data").exists()


def test_a_study_of_another_device_is_refused(quick: Path, tmp_path: Path) -> None:
    ran = run_script(quick, tmp_path / "data", *REHEARSED)
    assert ran.returncode == 1
    assert "the study is for ni-analogue-output, which takes no set-points one by one" in ran.stderr


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo-terminals")
def test_a_block_is_played_by_the_compiled_board(
    live: Path,
    tmp_path: Path,
    tool: Callable[[str], str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    icons = [icon for icon in parse(CUES) if icon.name != "burn"]
    found = judged(icons, sure_rig(), Device.load(CONTROLLER), 10.0)
    (tmp_path / "board").mkdir()
    monkeypatch.syspath_prepend(str(live))
    for path in live.glob("*study*.py"):
        monkeypatch.delitem(sys.modules, path.stem, raising=False)
    modules: dict[str, Any] = {name: importlib.import_module(name) for name in ("run_study", "study_live")}
    simulated: Any = importlib.import_module("study_simulated")
    script = modules["run_study"]
    files = script.StudyFiles(tmp_path / "data", {**script.read_study(), "landing_s": 1.0})
    with board(found, tmp_path / "board", tool("cc"), 1.0) as bench:
        timer = SimpleNamespace(monotonic=bench.clock, sleep=bench.sleep)
        named = {"device": "board", "port": bench.port, "stated": [STATED]}
        chosen = SimpleNamespace(**named, bench=None, channel=None, simulate=False)
        display = modules["study_live"].live_display(files.study, chosen, timer)

        class Clock(simulated.SimulatedClock):  # type: ignore[misc, name-defined]
            s = property(lambda self: bench.clock(), lambda self, s: None)

            def sleep(self, seconds: float) -> None:
                bench.sleep(seconds)

        screen = simulated.SimulatedScreen(Clock([]), lambda said, names: (said, 1.0), "space")
        rows = [row for row in script.trials_of(files, "A") if row["block"] == "1"]
        run = script.ParticipantRun(files, "A", screen, display, lambda code: None, {})
        code = script.play_all(run, rows)
        bench.sleep(1.0)
    assert bench.turns()[-1, 2] == 0.0
    if code and (late := re.search("this computer was late by .* s", capsys.readouterr().out)):
        pytest.skip(f"the output is off, as it must be: {late[0]}, which no test can help")
    assert code == 0
    assert [said for _, said in run.given.values()] == [row["icon"] for row in rows]
    (log,) = logs_of(tmp_path / "data").values()
    assert [row["icon"] for row in log if row["event"] == "play"] == [row["icon"] for row in rows]
    assert STATED in log[0]["event"]
    assert max(float(row["probe_loop_C"]) for row in log if row["icon"] == "glow") == pytest.approx(34.0, abs=0.15)
