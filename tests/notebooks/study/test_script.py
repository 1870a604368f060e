"""The script of a study, run in a process of its own without thermicon, PsychoPy or hardware."""

import json
import os
import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from tests.builders import messages
from thermicon.perception.pilot.trials_file import read_trials

from .conftest import Runner, rows_of, run_script

ROOT = Path(__file__).parents[3]
COLUMNS = ["participant", "trial", "presented", "responded", "time_s"]


def answers(folder: Path, who: str = "A") -> list[dict[str, str]]:
    return rows_of(folder / f"sub-{who}_task-quick_answers.csv")


def events(folder: Path, who: str = "A", run: int = 1) -> list[dict[str, str]]:
    return rows_of(folder / f"sub-{who}" / "beh" / f"sub-{who}_task-quick_run-{run}_events.tsv", "\t")


@pytest.fixture(scope="module")
def done(quick: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the data of participants A, who answers by chance, and B, who is always right."""
    folder = tmp_path_factory.mktemp("done")
    for who, more in (("A", []), ("B", ["--correct", 1])):
        ran = run_script(quick, folder, "--participant", who, "--simulate", *more)
        assert (ran.returncode, ran.stderr) == (0, "")
        assert f"{who}: done; 8 answers after" in ran.stdout
    return folder


def test_a_simulated_run_writes_answers_and_events(quick: Path, done: Path) -> None:
    conditions = rows_of(quick / "sub-A_task-quick_conditions.csv")
    found, played = answers(done), events(done)
    assert list(found[0]) == COLUMNS
    assert [row["presented"] for row in found] == [row["icon"] for row in conditions if row["trial"] != "0"]
    assert [int(row["trial"]) for row in found] == list(range(1, 9))
    assert {row["responded"] for row in found} <= {"dip", "glow"}
    assert all(float(row["time_s"]) > 3.0 for row in found), "answers come after the icon, from whose start they count"
    assert all(row["presented"] == row["responded"] for row in answers(done, "B")), "a perfect person is always right"
    assert [row["trial_type"] for row in played] == [row["icon"] for row in conditions], "practice included"
    assert all((done / "stimuli" / row["stim_file"]).is_file() for row in played)
    columns = json.loads((done / "task-quick_events.json").read_text(encoding="utf-8"))
    assert set(played[0]) <= set(columns)


def test_the_scripts_need_neither_thermicon_nor_psychopy_to_be_simulated(quick: Path) -> None:
    own = {"study_answers", "study_bench", "study_options", "study_run"}
    for name in ("run_study.py", *(f"{name}.py" for name in sorted(own)), "study_simulated.py"):
        lines = (quick / name).read_text(encoding="utf-8").splitlines()
        imported = {line.split()[1].partition(".")[0] for line in lines if line.startswith(("import ", "from "))}
        assert imported <= sys.stdlib_module_names | own


def test_pauses_landings_and_breaks_are_kept(quick: Path, done: Path) -> None:
    played = events(done)
    onsets = [float(row["onset"]) for row in played]
    ends = [onset + float(row["duration"]) for onset, row in zip(onsets, played, strict=True)]
    assert onsets[0] >= 30.0, "the hand lands"
    for before, (row, after) in enumerate(pairwise(played)):
        waited = onsets[before + 1] - ends[before]
        assert waited >= 10.0
        if row["block"] == "1" and after["block"] == "2":
            assert waited >= 40.0 + 30.0, "a break, and the hand lands again"
        elif row["block"] == "0" and after["block"] == "1":
            assert waited < 40.0, "after practice the hand stays"
    planned = rows_of(quick / "sub-A_task-quick_desc-planned_events.tsv", "\t")
    assert [row["trial_type"] for row in planned] == [row["trial_type"] for row in played]
    assert all(float(row["onset"]) <= onset for row, onset in zip(planned, onsets, strict=True))


def test_equal_seeds_give_equal_answers(script: Runner, tmp_path: Path) -> None:
    for folder, seed in (("one", 1), ("two", 1), ("three", 2)):
        script("--participant", "A", "--simulate", "--seed", seed, output=tmp_path / folder)
    one, two, three = (answers(tmp_path / folder) for folder in ("one", "two", "three"))
    assert one == two != three
    assert "8 answers of 1 participant\n" in script("--collect", output=tmp_path / "one").stdout


def test_what_is_done_is_not_overwritten_and_is_joined(script: Runner, done: Path) -> None:
    before, files = answers(done), sorted(done.rglob("*"))
    again = script("--participant", "A", "--simulate", output=done)
    assert again.returncode == 1
    assert "has 8 trials already: --resume goes on after them" in again.stderr
    again = script("--participant", "A", "--simulate", "--resume", output=done)
    assert again.returncode == 0 and "A: done before, 8 trials; there is nothing to resume" in again.stdout
    assert (answers(done), sorted(done.rglob("*"))) == (before, files)
    assert "16 answers of 2 participants\n" in script("--collect", output=done).stdout
    joined = rows_of(done / "answers.csv")
    assert list(joined[0]) == COLUMNS
    assert [row["participant"] for row in joined] == ["A"] * 8 + ["B"] * 8


def test_a_trial_without_an_answer_is_a_row_that_says_none_and_reads_back_as_not_felt(
    quick: Path, tmp_path: Path
) -> None:
    study = shutil.copytree(quick, tmp_path / "study")
    facts = json.loads((study / "study.json").read_text(encoding="utf-8"))
    (study / "study.json").write_text(json.dumps({**facts, "answer_s": 1.0}), encoding="utf-8")
    ran = run_script(study, tmp_path, "--participant", "A", "--simulate")
    found = answers(tmp_path)
    silent = sum(row["responded"] == "none" for row in found)
    said = {row["trial"]: row["response"] for row in events(tmp_path) if row["trial"] != "0"}
    assert said == {row["trial"]: row["responded"] for row in found}
    assert [int(row["trial"]) for row in found] == list(range(1, 9)) and 0 < silent < 8
    assert f"done; {8 - silent} answers after" in ran.stdout
    assert "nothing to resume" in run_script(study, tmp_path, "--participant", "A", "--simulate", "--resume").stdout
    joined = run_script(study, tmp_path, "--collect").stdout
    assert f"{8 - silent} answers of 1 participant; {silent} trials without an answer\n" in joined
    assert read_trials(tmp_path / "answers.csv", ["dip", "glow"]).unanswered.sum() == silent


def test_the_stop_key_ends_after_the_trial_and_resume_goes_on(script: Runner, tmp_path: Path) -> None:
    first = script("--participant", "A", "--simulate", "--press", "70:q")
    assert first.returncode == 0
    assert "stopped by key; --resume goes on" in first.stdout
    some = answers(tmp_path)
    assert 0 < len(some) < 8
    assert len(events(tmp_path)) == len(some) + 2, "every trial that began has its answer"
    rest = script("--participant", "A", "--simulate", "--resume")
    assert "8 answers" in rest.stdout
    assert [int(row["trial"]) for row in answers(tmp_path)] == list(range(1, 9))
    assert len(events(tmp_path, run=2)) == 8 - len(some)


@pytest.mark.parametrize(("words", "told"), messages(__file__)["options"].items())
def test_an_option_of_the_virtual_person_is_checked(words: str, told: str, script: Runner) -> None:
    done = script("--participant", "A", "--simulate", *words.split())
    assert done.returncode == 2
    assert told in done.stderr and "Traceback" not in done.stderr


def test_a_reader_who_leaves_does_not_end_the_run(quick: Path, tmp_path: Path) -> None:
    command = [sys.executable, quick / "run_study.py", "--participant", "A", "--simulate", "--verbose"]
    with subprocess.Popen(
        [*map(str, command), "--output", str(tmp_path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as run:
        assert run.stdout is not None and run.stderr is not None
        assert "Place the hand" in run.stdout.readline()
        run.stdout.close()
        assert run.stderr.read() == ""
        assert run.wait(timeout=60) == 0
    assert len(answers(tmp_path)) == 8


def test_a_start_that_fails_or_ends_before_a_trial_leaves_no_data(
    script: Runner, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    absent = "raise ModuleNotFoundError(\"No module named 'psychopy'\", name='psychopy')\n"
    (tmp_path / "psychopy.py").write_text(absent, encoding="utf-8")
    shut = "def Serial(port, **how):\n    raise OSError(f'could not open port {port}')\n"
    (tmp_path / "serial.py").write_text(shut, encoding="utf-8")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    for arguments, words in (
        (("--bench", "missing.py"), "--bench missing.py: there is no such file"),
        (("--marker", "bell"), "--marker bell: give none, serial:PORT"),
        (("--marker", "serial:COM9"), "does not open: could not open port COM9; check --port, --channel, --marker"),
        ((), "the package psychopy is missing in this Python"),
    ):
        done = script("--participant", "A", *arguments, output=tmp_path / "data")
        assert done.returncode == 1 and words in done.stderr and "Traceback" not in done.stderr
    assert not (tmp_path / "data").exists()
    script("--participant", "A", "--simulate", "--press", "5:escape")
    assert not list(tmp_path.rglob("sub-*"))
    for arguments, words in (
        (("--participant", "C"), "there is no participant C; the study has A, B"),
        ((), "whose trials? give --participant LABEL, one of A, B"),
        (("--collect",), "there are no answers in"),
    ):
        done = script(*arguments)
        assert done.returncode == 1 and words in done.stderr


@pytest.mark.parametrize(
    ("at_s", "words"),
    [(5, ""), (32, ""), (45, ""), (60, ""), (40, "--abort-key f1 --press 5:escape")],
    ids=["landing", "a play", "a question or pause", "later", "another key"],
)
def test_the_abort_key_ends_at_once_wherever_it_comes(at_s: float, words: str, script: Runner) -> None:
    key = "f1" if words else "escape"
    stopped = script("--participant", "A", "--simulate", *words.split(), "--press", f"{at_s}:{key}")
    assert stopped.returncode == 3
    assert "ABORTED by key; the display is off" in stopped.stdout
    minutes = float(stopped.stdout.partition("answers after ")[2].split()[0])
    assert minutes == pytest.approx(at_s / 60.0, abs=0.06)


def changed_player(quick: Path, folder: Path, text: str) -> Path:
    """A copy of the study whose player goes on with some text."""
    study = Path(shutil.copytree(quick, folder / "study"))
    with (study / "play_icons.py").open("a", encoding="utf-8") as file:
        file.write(text)
    return study


def test_an_interrupt_switches_off(quick: Path, tmp_path: Path) -> None:
    study = changed_player(quick, tmp_path, "\ndef keep():\n    raise KeyboardInterrupt\n")
    ran = run_script(study, tmp_path, "--participant", "A", "--simulate")
    assert ran.returncode != 0 and "A: SWITCHED OFF: INTERRUPTED; 0 answers" in ran.stdout


KEEPS = """
_kept = [0.0]
def keep():
    _kept.append(time.monotonic())
    if time.monotonic() - _kept[-2] > 0.02:
        with open("GAPS", "a") as file:
            file.write(f"{time.monotonic() - _kept[-2]}\\n")
"""


def test_the_device_is_kept_awake_whenever_no_play_does_it(quick: Path, tmp_path: Path) -> None:
    """A watchdog of a second: the loop that reads the keys feeds it; a rest and ten plays of 3 s feed it themselves."""
    study = changed_player(quick, tmp_path, KEEPS.replace("GAPS", str(tmp_path / "gaps")))
    assert run_script(study, tmp_path, "--participant", "A", "--simulate").returncode == 0
    gaps_s = [float(line) for line in (tmp_path / "gaps").read_text(encoding="utf-8").split()]
    assert len(gaps_s) == 11 and all(gap_s == pytest.approx(3.01, abs=0.1) for gap_s in gaps_s[1:])


@pytest.mark.parametrize(
    ("text", "ending"),
    [
        (
            "def keep():\n    if time.monotonic() > 60: raise Stopped('the display is at 60 C')",
            "SWITCHED OFF: the display",
        ),
        ("_off = None", "NOT SWITCHED OFF, do that by hand at once ('NoneType' object is not callable): 'NoneType'"),
        ("import nidaqmx\nnidaqmx.Task()", "NOT SWITCHED OFF, do that by hand at once (tasks that nobody closed: 1): "),
    ],
    ids=["stopped between plays", "off fails", "a task stays open"],
)
def test_what_goes_wrong_is_the_ending_and_never_done(text: str, ending: str, quick: Path, tmp_path: Path) -> None:
    ran = run_script(changed_player(quick, tmp_path, f"\n{text}\n"), tmp_path, "--participant", "A", "--simulate")
    assert (ran.returncode, ran.stderr) == (3, "")
    assert f"A: {ending}" in ran.stdout and "done" not in ran.stdout


STAND_INS = {
    "psychopy/__init__.py": "",
    "psychopy/visual.py": '''
"""By psychopy/visual/window.py: what was drawn is shown by flip(), which waits for the next frame (waitBlanking) and
leaves the buffer empty; a window that was closed shows nothing more; its context belongs to the thread that made it."""

import threading
import time

class Window:
    def __init__(self, size=(800, 600), pos=None, color=(0, 0, 0), fullscr=None, units="norm"):
        self.drawn, self.thread, self.open = [], threading.current_thread(), True
    def check(self):
        assert self.open, "this window is closed"
        assert threading.current_thread() is self.thread, "another thread made this window"
    def flip(self):
        self.check()
        time.sleep(1 / 60 - time.monotonic() % (1 / 60))
        print(*self.drawn, file=open(__file__ + ".log", "a"))
        self.drawn = []
    def close(self):
        self.check()
        self.open = False

class TextStim:
    def __init__(self, win, text="Hello", height=None, wrapWidth=None):
        self.win, self.text = win, text
    def draw(self):
        self.win.check()
        self.win.drawn.append(self.text.replace("\\n", "|"))
''',
    "psychopy/event.py": '''
"""By psychopy/event.py: getKeys() gives the names of the keys pressed since it was last called, each once."""

import time

last = [time.monotonic()]

def getKeys(keyList=None, modifiers=False, timeStamped=False):
    """A person who presses both keys ten times a second."""
    before, last[0] = last[0], time.monotonic()
    return ["space", "1"] * (int(10 * last[0]) - int(10 * before))
''',
    "nidaqmx/__init__.py": '''
"""The stand-in that keeps the rules of the driver; at the end it notes what was put out, and the tasks left open."""

import atexit
import sys
import time

from tests.circuit.daq import Daq

device = Daq(time.monotonic)

def note(path=__file__ + ".log"):
    with open(path, "w") as file:
        for row in device.out:
            print("put", len(row) if isinstance(row, list) else row, file=file)
        print("open", device.open_tasks, file=file)

atexit.register(note)
sys.modules["nidaqmx"] = sys.modules["nidaqmx.constants"] = device
''',
}
"""Stand-ins with the names, arguments and rules of PsychoPy and nidaqmx, as far as the script uses them."""


@pytest.mark.slow
def test_with_psychopy_and_a_device_it_runs_in_real_time(quick: Path, tmp_path: Path) -> None:
    for name, text in STAND_INS.items():
        (tmp_path / "stubs" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "stubs" / name).write_text(text, encoding="utf-8")
    folder = tmp_path / "study"
    shutil.copytree(quick, folder)
    facts = json.loads((folder / "study.json").read_text(encoding="utf-8"))
    facts |= {"landing_s": 0.2, "gap_s": 0.3, "break_s": 0.2}
    (folder / "study.json").write_text(json.dumps(facts), encoding="utf-8")
    with (folder / "play_icons.py").open("a", encoding="utf-8") as file:
        file.write("\nREST_S = PAUSE_S = 0.1\n")
    conditions = folder / "sub-A_task-quick_conditions.csv"
    lines = [line.replace(",3.01,", ",0.2,") for line in conditions.read_text(encoding="utf-8").splitlines()]
    conditions.write_text("\n".join(lines) + "\n", encoding="utf-8")
    done = subprocess.run(
        [sys.executable, str(folder / "run_study.py"), "--participant", "A", "--window"],
        capture_output=True, encoding="utf-8", timeout=100, check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path / "stubs"), str(ROOT)])},
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert len(answers(folder / "data")) == 8
    put = (tmp_path / "stubs" / "nidaqmx" / "__init__.py.log").read_text(encoding="utf-8").split("\n")
    assert sum(line.startswith("put 3") for line in put) == 10, "every drive of about 300 samples, practice included"
    assert put[-3:] == ["put 0.0", "open 0", ""], "the output is off at the end, and no task is left"
    shown = (tmp_path / "stubs" / "psychopy" / "visual.py.log").read_text(encoding="utf-8")
    for words in ("Place the hand on the display", "Practice is over", "Which pattern was that?||1   a dip|2   a glow"):
        assert words in shown
