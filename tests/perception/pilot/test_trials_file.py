"""Tables of answers: what is read, and what each bad table is refused with."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from thermicon.perception.pilot import trials_file
from thermicon.perception.pilot.trials_file import TrialsError, read_trials

ICONS = ("cool-step", "warm-step", "dip")
HEAD = "participant,trial,presented,responded"


def written(folder: Path, *rows: str, head: str = HEAD) -> Path:
    path = folder / "trials.csv"
    path.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return path


def test_answers_are_counted_by_participant_and_icon(tmp_path: Path) -> None:
    rows = ("P1,1,dip,dip,1.5", "P2,1,cool-step,warm-step,9", "P1,2,dip,cool-step,8", "P1,3,dip,dip,2.5")
    found = read_trials(written(tmp_path, *rows, head=f"{HEAD},time_s"), ICONS)
    assert found.participants == ("P1", "P2")
    assert found.counts[0].tolist() == [[0, 0, 0], [0, 0, 0], [1, 0, 2]]
    assert found.counts[1].tolist() == [[0, 1, 0], [0, 0, 0], [0, 0, 0]]
    assert found.time_s[0] == 2.0 and np.isnan(found.time_s[1])  # times of correct answers alone
    assert found.never_presented == ("warm-step",)
    assert found.single_trial == ("P2",)
    assert len(found.digest) == 16 and found.source == "trials.csv"


def test_semicolons_quotes_comments_and_further_columns_are_read(tmp_path: Path) -> None:
    head = "# made by hand\nblock;responded;presented;trial;participant"
    found = read_trials(written(tmp_path, 'A;dip;"dip";1;P1', "", 'A;"warm-step"; dip ;2;P1', head=head), ICONS)
    assert found.pooled[2].tolist() == [0, 1, 1]


@pytest.mark.parametrize(
    ("rows", "head", "said"),
    [
        ((), HEAD, "no row below the names of the columns; write one row per trial"),
        (("P1,1,dip",), "participant,trial,shown", "columns missing: presented, responded; found: participant, trial"),
        (("P1,1,dip,dip",), HEAD.replace("trial", "Trial"), "column missing: trial; .*rename 'Trial' to trial"),
        (("P1,1,dip,dip,x",), f"{HEAD},trial", "the column trial appears twice"),
        (("P1,1,dip,dip", "P1,1,dip,dip"), HEAD, "csv:3: participant 'P1' has trial '1' twice, also in line 2"),
        (("P1,1,dip,dipp",), HEAD, "csv:2: responded is 'dipp', which is not an icon of the set; did you mean dip"),
        (("P1,1,Dip,dip",), HEAD, "presented is 'Dip', .*did you mean dip. Names differ by case"),
        (("P1,1,dip,",), HEAD, "csv:2: responded is empty; fill it in, or remove the row"),
        ((",1,dip,dip",), HEAD, "csv:2: participant is empty"),
        (("P1,1,dip,dip", "p1,2,dip,dip"), HEAD, "participants 'P1' and 'p1' differ by case alone; did you mean 'P1'"),
        (("P1,1,dip,dip,soon",), f"{HEAD},time_s", "time_s is 'soon', not a time of 0 to 3600 s"),
        (("P1,1,dip,dip,-1",), f"{HEAD},time_s", "time_s is '-1', not a time of 0 to 3600 s"),
        (
            ("P1,1,dip,cool-step,-0.4",),
            f"{HEAD},time_s",
            "csv:2: time_s is '-0.4', not a time of 0 to 3600 s; leave it",
        ),
        (("P1,1,dip,dip,2", "P1,2,dip,cool-step,9000"), f"{HEAD},time_s", "csv:3: time_s is '9000', not a time of"),
        (("P1,1,dip,dip,9",), HEAD, "csv:2: 5 cells, where the first line names 4"),
        ((f"{'P' * 101},1,dip,dip",), HEAD, "participant has 101 characters; at most 100"),
    ],
)
def test_a_bad_table_is_refused_with_place_and_cure(
    tmp_path: Path, rows: tuple[str, ...], head: str, said: str
) -> None:
    path = written(tmp_path, *rows, head=head)
    with pytest.raises(TrialsError, match=said):
        read_trials(path, ICONS)


@pytest.mark.parametrize("times", [(1240, 980, 2315), (1240.5, 980.25, 2315.75), (4200, 980, 3700), (850, 0, 990)])
def test_times_in_milliseconds_are_recognised(tmp_path: Path, times: tuple[float, ...]) -> None:
    rows = [f"P{k},1,dip,{'dip' if k else 'cool-step'},{time}" for k, time in enumerate(times)]
    cure = "these look like milliseconds; divide the column by 1000, so that it is in s"
    with pytest.raises(TrialsError, match=f"trials.csv: time_s has a median of .*: {cure}"):
        read_trials(written(tmp_path, *rows, head=f"{HEAD},time_s"), ICONS)
    seconds = [f"P{k},1,dip,dip,{time / 1000}" for k, time in enumerate(times)]
    found = read_trials(written(tmp_path, *seconds, head=f"{HEAD},time_s"), ICONS)
    assert found.time_s == tuple(time / 1000 for time in times)


def test_one_participant_in_milliseconds_is_named(tmp_path: Path) -> None:
    rows = [f"P1,{k},dip,dip,{1.2 + 0.1 * k}" for k in range(9)] + [f"P2,{k},dip,dip,{1200 + k}" for k in range(4)]
    with pytest.raises(TrialsError, match=r"time_s of participant 'P2' has a median of 1201\.5: these look like mill"):
        read_trials(written(tmp_path, *rows, head=f"{HEAD},time_s"), ICONS)


@pytest.mark.parametrize("times", [(61.5, 80, 75), (1240, 1.5), (65, 72, 90), (1.2, 1.5, 1800)])
def test_slow_answers_stay_seconds(tmp_path: Path, times: tuple[float, ...]) -> None:
    rows = [f"P1,{k},dip,dip,{time}" for k, time in enumerate(times)]
    found = read_trials(written(tmp_path, *rows, head=f"{HEAD},time_s"), ICONS)
    assert found.time_s == (float(np.median(times)),)


@pytest.mark.parametrize(
    "column", ["time_ms", "Time_s", "RT", "key_resp.rt", "response_time (s)", "reaction time [ms]"]
)
def test_times_under_another_name_are_said_not_to_be_read(tmp_path: Path, column: str) -> None:
    path = written(tmp_path, "P1,1,dip,dip,900", head=f"{HEAD},{column}")
    (said,) = read_trials(path, ICONS).warnings
    assert said.startswith(f"{path}: times in the column {column!r} are not read: name it time_s and give s")
    for head in (f"{HEAD},{column},time_s", f"{HEAD},timeline,sometimes"):
        assert read_trials(written(tmp_path, "P1,1,dip,dip,900,0.9", head=head), ICONS).warnings == ()


def test_empty_absent_binary_and_large_files_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "trials.csv"
    with pytest.raises(TrialsError, match="no such table of trials"):
        read_trials(path, ICONS)
    path.write_bytes(b"")
    with pytest.raises(TrialsError, match="the file is empty; a table of trials was expected"):
        read_trials(path, ICONS)
    path.write_bytes(b"PK\0\1")
    with pytest.raises(TrialsError, match="binary file, not a table of trials"):
        read_trials(path, ICONS)
    written(tmp_path, *(f"P1,{k},dip,dip" for k in range(5)))
    monkeypatch.setattr(trials_file, "MOST_ROWS", 4)
    with pytest.raises(TrialsError, match="more than 4 rows; one experiment a file"):
        read_trials(path, ICONS)
    monkeypatch.setattr(trials_file, "MOST_MB", 1e-5)
    with pytest.raises(TrialsError, match="too large for a table of trials; the limit is 1e-05 MB"):
        read_trials(path, ICONS)


def test_more_participants_than_an_experiment_has_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trials_file, "MOST_PARTICIPANTS", 2)
    path = written(tmp_path, *(f"P{k},1,dip,dip" for k in range(3)))
    with pytest.raises(TrialsError, match="3 participants; at most 2 are taken: check that the column participant"):
        read_trials(path, ICONS)
