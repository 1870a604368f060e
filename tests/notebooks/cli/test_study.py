"""``thermicon study`` at the command line."""

import csv
import json
import shutil
from pathlib import Path

import pytest

from tests.notebooks.conftest import Cli
from tests.notebooks.study.conftest import QUICK, make, write_study

HOT = QUICK.replace('["dip", "glow"]', '["dip", "burn"]')


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make(tmp_path_factory.mktemp("study"), QUICK)


def test_study_json_states_what_was_derived_and_judged(out: Path) -> None:
    facts = json.loads((out / "study.json").read_text(encoding="utf-8"))
    assert facts["participants"] == ["A", "B"]
    assert (facts["gap_s"], facts["gap_because"], facts["landing_s"]) == (10.0, "given", 30.0)
    assert 0.0 < facts["carry_over_d_prime"] < 5.0
    assert 0.0 < facts["landing_left_K"] < facts["landing_left_at_10_s_K"] < 2.5
    assert {label: session["verdict"] for label, session in facts["sessions"].items()} == {"A": "green", "B": "green"}
    for session in facts["sessions"].values():
        assert session["dose_cem43_worst_min"] < session["dose_cem43_limit_min"]
        assert abs(session["baseline_drift_K"]) < 1.0
    assert facts["choices"]["dip"] == {"key": "1", "text": "a dip"}
    assert "not a medical or ethical clearance" in facts["what_it_is_not"]


def test_the_folder_is_verified_as_a_whole(out: Path, tmp_path: Path, cli: Cli) -> None:
    for who in "AB":
        with (out / f"sub-{who}_task-quick_conditions.csv").open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == 10
        assert all((out / row["drive_file"]).is_file() and (out / row["sidecar_file"]).is_file() for row in rows)
    cli.good("export", "--verify", out)
    copy = Path(shutil.copytree(out, tmp_path / "copy"))
    conditions = copy / "sub-A_task-quick_conditions.csv"
    conditions.write_text(conditions.read_text(encoding="utf-8").replace("dip", "glow"), encoding="utf-8")
    (copy / "run_study.py").unlink()
    said = cli("export", "--verify", copy)
    assert said.exit_code == 1
    assert "sub-A_task-quick_conditions.csv: is not the file that was exported with study.json" in said.stderr
    assert "run_study.py: is missing; it was exported with study.json" in said.stderr


def test_the_same_study_gives_the_same_bytes(out: Path, tmp_path: Path) -> None:
    first, again = ({path.name: path.read_bytes() for path in one.iterdir()} for one in (out, make(tmp_path, QUICK)))
    assert first == again


def refused(cli: Cli, folder: Path, text: str) -> str:
    """What a refused study says; nothing may be there."""
    said = cli("study", write_study(folder, text), "-o", folder / "out")
    assert said.exit_code == 3, said.stdout
    assert sorted(path.name for path in folder.iterdir()) == ["study.toml", "two.cue"]
    assert "nothing was written" in said.stderr
    return str(said.stderr)


@pytest.mark.slow
def test_a_gap_that_is_not_safe_refuses_the_study_and_names_the_shortest(tmp_path: Path, cli: Cli) -> None:
    text = refused(cli, tmp_path, HOT.replace("gap_s = 10", "gap_s = 0"))
    assert "refused: burn: NOT SAFE: " in text
    assert "timing.gap_s = " in text or "no pause up to 10 min" in text
    assert "--pause" not in text


@pytest.mark.slow
def test_a_derived_gap_grows_until_it_is_safe(tmp_path: Path, cli: Cli) -> None:
    """The same icons with nothing given: the gate asks for more than carry-over of d′ 5 does."""
    text = HOT.replace("gap_s = 10\n", "carry_over_d_prime = 5\n").replace("hold for 20 s", "hold for 1 s")
    path = write_study(tmp_path, text)
    (tmp_path / "two.cue").write_text(
        (tmp_path / "two.cue").read_text(encoding="utf-8").replace("hold for 20 s", "hold for 12 s"), encoding="utf-8"
    )
    said = cli.good("study", path, "-o", tmp_path / "made")
    assert "the shortest pause that is safe" in said.stdout
    assert said.stdout.count(" * ") == 1 and "long for one visit" not in said.stdout


@pytest.mark.slow
def test_a_session_beyond_its_dose_is_refused(tmp_path: Path, cli: Cli) -> None:
    """In the short session of this rig no drive is too much by itself; in the whole order of play they are."""
    rules = (
        "'safety.reason=\"the session of the test lasts one minute\"', 'safety.session_min=1', "
        "'safety.thermal_dose_min_CEM43=0.2', "
    )
    text = HOT.replace("rig_changes = [", f"rig_changes = [{rules}").replace("repetitions = 2", "repetitions = 14")
    text = text.replace("gap_s = 10", "gap_s = 170")
    said = refused(cli, tmp_path, text)
    assert "refused: session of participant A: NOT SAFE: " in said
    assert "thermal dose" in said


@pytest.mark.slow
@pytest.mark.parametrize(
    ("held", "words"),
    [
        (["study.json"], "out holds a study already and was kept; give another folder with -o"),
        (["README.txt"], "README.txt was not written by thermicon, since no sidecar lists it, and is kept"),
        (["study.json", "data/dataset_description.json"], "holds a study already"),
        (["study.json", "data/sub-A_task-quick_answers.csv"], "holds the answers of 1 participant (data/) already"),
    ],
)
def test_files_that_are_there_are_kept(tmp_path: Path, cli: Cli, held: list[str], words: str) -> None:
    for path in (tmp_path / "out" / name for name in held):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("mine", encoding="utf-8")
    said = cli("study", write_study(tmp_path, QUICK), "-o", tmp_path / "out")
    assert (said.exit_code, words in " ".join(said.stderr.split())) == (1, True), said.stderr
    kept = {path.relative_to(tmp_path / "out").as_posix() for path in (tmp_path / "out").rglob("*.*")}
    assert kept == set(held)


@pytest.mark.parametrize(
    ("old", "new", "out", "words"),
    [
        ("dip", "dpi", "out", "study.toml: "),
        ("repetitions = 2", "repetitions = 300", "out", "260 min for each participant; the limit of a session is 180"),
        ("", "", "two.cue", "is a file; give the name of a folder"),
    ],
    ids=["icon", "long", "file"],
)
def test_bad_input_exits_with_1_and_no_traceback(
    old: str, new: str, out: str, words: str, tmp_path: Path, cli: Cli
) -> None:
    said = cli("study", write_study(tmp_path, QUICK.replace(old, new) if old else QUICK), "-o", tmp_path / out)
    assert (said.exit_code, said.stdout, words in said.stderr) == (1, "", True), said.stderr
    assert not (tmp_path / out).is_dir()


@pytest.mark.slow
def test_a_thermode_is_judged_by_its_gate_over_the_whole_session(tmp_path: Path, cli: Cli) -> None:
    text = QUICK.replace("rig_changes", 'rig = "tcs2"\ndevice = "qst-tcs2"\nrig_changes', 1)
    lines = [line for line in text.splitlines() if not line.startswith("rig_changes")]
    text = "\n".join(lines).replace("gap_s = 10", "gap_s = 300").replace("repetitions = 2", "repetitions = 4")
    said = cli.good("study", write_study(tmp_path, text), "-o", tmp_path / "out")
    assert "judged by its drives alone, repeated in any order: a thermode has no current" in said.stdout
    assert said.stdout.count("min each is long for one visit") == 1
    sidecar = json.loads((tmp_path / "out" / "dip.json").read_text(encoding="utf-8"))
    assert sidecar["rig"]["changes"] == ["safety.session_min=86.0"], "18 plays of 3 s and 17 gaps of 300 s"
    assert json.loads((tmp_path / "out" / "study.json").read_text(encoding="utf-8"))["plays"] == "tcs2"


@pytest.mark.slow
def test_of_many_participants_the_extreme_sessions_are_judged(tmp_path: Path, cli: Cli) -> None:
    text = QUICK.replace('labels = ["A", "B"]', "count = 9").replace("repetitions = 2", "repetitions = 1")
    said = cli("study", write_study(tmp_path, text), "-o", tmp_path / "out")
    assert "of 9 orders, those with the coldest and the warmest skin, the largest dose and the" in said.stdout
    facts = json.loads((tmp_path / "out" / "study.json").read_text(encoding="utf-8"))
    assert len(facts["baseline_drift_K"]) == 9
    assert 1 <= len(facts["sessions"]) <= 4
    drifts = {label: abs(drift) for label, drift in facts["baseline_drift_K"].items()}
    assert max(drifts, key=lambda label: drifts[label]) in facts["sessions"]
    for label, session in facts["sessions"].items():
        assert session["baseline_drift_K"] == pytest.approx(facts["baseline_drift_K"][label], abs=1e-9)
