"""Every fault of a study file in words before anything is simulated."""

from pathlib import Path

import pytest

from tests.builders import messages, missing
from tests.notebooks.study.conftest import CUES, QUICK, write_study
from thermicon.icons.model.errors import CueErrors
from thermicon.notebooks.study.build import plays_of, read_materials
from thermicon.notebooks.study.schedule import courses_of, seed_of
from thermicon.notebooks.study.study_file import StudyError, labels_of, parse_study, study_hash, study_text

FAULTS = messages(__file__)["faults"]


@pytest.mark.parametrize(("change", "words"), FAULTS.items())
def test_a_fault_is_named_with_its_cure(change: str, words: str | list[str], tmp_path: Path) -> None:
    old, new = change.split(" -> ")
    assert old in QUICK
    path = write_study(tmp_path, QUICK.replace(old, new, 1))
    with pytest.raises(StudyError) as problem:
        read_materials(path)
    assert missing(words, str(problem.value)) == []


def test_members_of_a_large_family_can_be_named(tmp_path: Path) -> None:
    path = write_study(tmp_path, QUICK.replace('["dip", "glow"]', '["glow", "sink_depth=2_rate=1"]'))
    large = "icon sink(depth in 2..6 step 0.1 °C, rate in 1..3 step 0.02 °C/s) { cool by depth at rate; hold for 1 s }"
    cues = tmp_path / "two.cue"
    cues.write_text(f"{cues.read_text(encoding='utf-8')}{large}\n", encoding="utf-8")
    assert [icon.name for icon in read_materials(path).chosen] == ["glow", "sink_depth=2_rate=1"]
    path.write_text(path.read_text(encoding="utf-8").replace('"glow"', '"snk"'), encoding="utf-8")
    with pytest.raises(StudyError, match=r"there is no icon snk; did you mean sink\?"):
        read_materials(path)
    all_of_it = QUICK.replace('icons = ["dip", "glow"]\n', "").replace("repetitions = 2", "repetitions = 1")
    path.write_text(all_of_it, "utf-8")
    text = CUES + large.replace("2..6 step 0.1", "2..6 step 0.2").replace("1..3 step 0.02", "1..1.3 step 0.3") + "\n"
    cues.write_text(text, encoding="utf-8")
    with pytest.raises(StudyError, match=r"the set has \d\d icons, and a person can be asked for 30; name some"):
        read_materials(path)


def test_all_faults_are_named_at_once(tmp_path: Path) -> None:
    text = QUICK.replace("repetitions = 2", "repetitions = 0").replace("gap_s = 10", "gap = 10")
    with pytest.raises(StudyError) as problem:
        read_materials(write_study(tmp_path, text))
    lines = str(problem.value).splitlines()
    assert [line.startswith(str(tmp_path / "study.toml")) for line in lines] == [True, True]


BYTES = (QUICK.encode("utf-16"), QUICK.replace("quick", "qüick").encode("latin-1"), b"", b"format = ")


@pytest.mark.parametrize(("content", "words"), list(zip(BYTES, messages(__file__)["bytes"], strict=True)))
def test_what_is_not_a_study_file_is_said(content: bytes, words: str, tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_bytes(content)
    with pytest.raises(StudyError, match=words):
        read_materials(path)


def test_the_shipped_study_is_read_from_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(StudyError, match=r"nothing-here\.toml: no such study file"):
        read_materials("nothing-here.toml")
    with pytest.raises(CueErrors, match=r"six-icons"):
        read_materials(write_study(tmp_path, QUICK.replace("two.cue", "six-icon")))
    materials = read_materials("example.toml")
    assert len(materials.chosen) == 6
    assert labels_of(materials.study) == tuple(f"{k:02d}" for k in range(1, 13))
    (tmp_path / "example.toml").write_text("format = 1\n", encoding="utf-8")
    with pytest.raises(StudyError, match="name is missing"):  # a file of that name comes first
        read_materials("example.toml")


def test_the_seed_depends_on_everything_that_decides_a_study(tmp_path: Path) -> None:
    def seed(text: str) -> int:
        return read_materials(write_study(tmp_path, text)).seed

    first = seed(QUICK)
    assert seed("# a remark\n" + QUICK) == first, "a comment decides nothing"
    for change in (("gap_s = 10", "gap_s = 11"), ('labels = ["A", "B"]', 'labels = ["A", "C"]')):
        assert seed(QUICK.replace(*change)) != first
    path = write_study(tmp_path, QUICK)
    (tmp_path / "two.cue").write_text(CUES.replace("2 °C/s; hold for 1 s", "1 °C/s; hold for 1 s"), encoding="utf-8")
    assert read_materials(path).seed != first, "an icon decides too"


def test_orders_follow_the_hash() -> None:
    study = parse_study(study_text("example"), "example")
    seed, names = seed_of(study_hash(study, {})), tuple("abcdef")
    courses = courses_of(study, names, seed)
    assert courses == courses_of(study, names, seed)
    assert [course.label for course in courses] == list(labels_of(study))
    assert {len(course.trials) for course in courses} == {plays_of(study, 6)}, "practice is played, too"
    assert all([trial.trial for trial in course.trials if trial.block] == list(range(1, 13)) for course in courses)
    assert all({trial.trial for trial in course.trials if not trial.block} == {0} for course in courses)
