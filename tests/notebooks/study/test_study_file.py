"""A study file at the door: every fault in words, all at once, before anything is simulated."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.builders import messages, missing
from tests.notebooks.study.conftest import CUES, QUICK, write_study
from thermicon.icons.model.errors import CueErrors
from thermicon.notebooks.study.build import read_materials
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


def test_a_million_trials_are_refused_before_anything_is_simulated(tmp_path: Path) -> None:
    many = QUICK.replace("repetitions = 2", "repetitions = 500").replace("blocks = 2", "blocks = 100")
    with pytest.raises(StudyError, match=r"2 icons × \(100 blocks × 500 repetitions \+ 1 practice\) are 100,002 plays"):
        read_materials(write_study(tmp_path, many))


def test_members_of_a_large_family_can_be_named(tmp_path: Path) -> None:
    path = write_study(tmp_path, QUICK.replace('["dip", "glow"]', '["glow", "sink_depth=2_rate=1"]'))
    large = "icon sink(depth in 2..6 step 0.1 °C, rate in 1..3 step 0.02 °C/s) { cool by depth at rate; hold for 1 s }"
    cues = tmp_path / "two.cue"
    cues.write_text(f"{cues.read_text(encoding='utf-8')}{large}\n", encoding="utf-8")
    assert [icon.name for icon in read_materials(path).chosen] == ["glow", "sink_depth=2_rate=1"]
    path.write_text(path.read_text(encoding="utf-8").replace('"glow"', '"snk"'), encoding="utf-8")
    with pytest.raises(StudyError, match=r"there is no icon snk; did you mean sink\?"):
        read_materials(path)
    path.write_text(
        QUICK.replace('icons = ["dip", "glow"]\n', "").replace("repetitions = 2", "repetitions = 1"), "utf-8"
    )
    text = CUES + large.replace("2..6 step 0.1", "2..6 step 0.2").replace("1..3 step 0.02", "1..1.3 step 0.3") + "\n"
    cues.write_text(text, encoding="utf-8")
    with pytest.raises(StudyError, match=r"the set has \d\d icons, and a person can be asked for 30; name some"):
        read_materials(path)


def test_all_faults_are_named_at_once(tmp_path: Path) -> None:
    text = QUICK.replace("repetitions = 2", "repetitions = 0").replace("gap_s = 10", "gap = 10")
    with pytest.raises(StudyError) as problem:
        read_materials(write_study(tmp_path, text))
    lines = str(problem.value).splitlines()
    assert len(lines) == 2
    assert all(line.startswith(str(tmp_path / "study.toml")) for line in lines)


BYTES = (QUICK.encode("utf-16"), QUICK.replace("quick", "qüick").encode("latin-1"), b"", b"format = ")


@pytest.mark.parametrize(("content", "words"), list(zip(BYTES, messages(__file__)["bytes"], strict=True)))
def test_what_is_not_a_study_file_or_not_there_is_said(content: bytes, words: str, tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_bytes(content)
    with pytest.raises(StudyError, match=words):
        read_materials(path)
    with pytest.raises(StudyError, match=r"nothing-here\.toml: no such study file"):
        read_materials("nothing-here.toml")
    with pytest.raises(CueErrors, match=r"six-icons"):
        read_materials(write_study(tmp_path, QUICK.replace("two.cue", "six-icon")))


def test_a_threshold_takes_no_set() -> None:
    text = 'format = 1\nname = "t"\n[stimuli]\nset = "six-icons"\n[participants]\ncount = 1\n[threshold]\n'
    with pytest.raises(StudyError, match=r"leave out set and icons"):
        parse_study(text + 'direction = "cool"\n', "t.toml")
    with pytest.raises(StudyError, match=r"threshold\.least_K = 5 K is not below threshold\.most_K = 4 K"):
        parse_study(text.replace('set = "six-icons"\n', "") + 'direction = "cool"\nleast_K = 5\n', "t.toml")


def test_the_shipped_study_is_read_from_anywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    materials = read_materials("example.toml")
    assert len(materials.chosen) == 6
    assert labels_of(materials.study) == tuple(f"{k:02d}" for k in range(1, 13))
    (tmp_path / "example.toml").write_text("format = 1\n", encoding="utf-8")
    with pytest.raises(StudyError, match="name is missing"):  # a file of that name comes first
        read_materials("example.toml")


def test_the_seed_depends_on_everything_that_decides_a_study(tmp_path: Path) -> None:
    first = read_materials(write_study(tmp_path, QUICK))
    assert read_materials(tmp_path / "study.toml").seed == first.seed
    commented = read_materials(write_study(tmp_path, "# a remark\n" + QUICK))
    assert commented.seed == first.seed, "a comment decides nothing"
    for change in (("gap_s = 10", "gap_s = 11"), ('labels = ["A", "B"]', 'labels = ["A", "C"]')):
        assert read_materials(write_study(tmp_path, QUICK.replace(*change))).seed != first.seed
    path = write_study(tmp_path, QUICK)
    (tmp_path / "two.cue").write_text(
        (tmp_path / "two.cue").read_text(encoding="utf-8").replace("2 °C/s; hold for 1 s", "1 °C/s; hold for 1 s"),
        encoding="utf-8",
    )
    assert read_materials(path).seed != first.seed, "an icon decides too"


def test_orders_follow_the_hash() -> None:
    study = parse_study(study_text("example"), "example")
    seed = seed_of(study_hash(study, {}))
    names = tuple("abcdef")
    courses = courses_of(study, names, seed)
    assert courses == courses_of(study, names, seed)
    assert [course.label for course in courses] == list(labels_of(study))
    assert all([trial.trial for trial in course.trials if trial.block] == list(range(1, 13)) for course in courses)
    assert all({trial.trial for trial in course.trials if not trial.block} == {0} for course in courses)
