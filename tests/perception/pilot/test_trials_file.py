"""Tables of answers: what is read, and what each bad table is refused with."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.builders import messages
from thermicon.perception.pilot import trials_file
from thermicon.perception.pilot.trials_file import TrialsError, read_trials

ICONS = ("cool-step", "warm-step", "dip")
HEAD = "participant,trial,presented,responded"


def written(folder: Path, *rows: str, head: str = HEAD) -> Path:
    path = folder / "trials.csv"
    path.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return path


def test_answers_are_counted_by_participant_and_icon(tmp_path: Path) -> None:
    rows = ("P1,1,dip,dip", "P2,1,cool-step,warm-step", "P1,2,dip,cool-step", "P1,3,dip,dip")
    found = read_trials(written(tmp_path, *rows), ICONS)
    assert found.participants == ("P1", "P2")
    assert found.counts[0].tolist() == [[0, 0, 0], [0, 0, 0], [1, 0, 2]]
    assert found.counts[1].tolist() == [[0, 1, 0], [0, 0, 0], [0, 0, 0]]
    assert found.never_presented == ("warm-step",)
    assert len(found.digest) == 16 and found.source == "trials.csv"


def test_semicolons_quotes_comments_and_further_columns_are_read(tmp_path: Path) -> None:
    head = "# made by hand\nblock;responded;presented;trial;participant"
    found = read_trials(written(tmp_path, 'A;dip;"dip";1;P1', "", 'A;"warm-step"; dip ;2;P1', head=head), ICONS)
    assert found.pooled[2].tolist() == [0, 1, 1]


MESSAGES = messages(__file__)


@pytest.mark.parametrize("text", MESSAGES["trials"])
def test_a_bad_table_is_refused_with_place_and_cure(tmp_path: Path, text: str) -> None:
    with pytest.raises(TrialsError, match=MESSAGES["trials"][text]):
        read_trials(written(tmp_path, head=text), ICONS)


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
