"""Tables of answers or measurements: accepted forms, errors."""

import math
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from tests.builders import messages
from thermicon.circuit import Rig
from thermicon.perception.pilot import trials_file
from thermicon.perception.pilot.measurements_file import read_measurements
from thermicon.perception.pilot.trials import score
from thermicon.perception.pilot.trials_file import TrialsError, read_trials

ICONS = ("cool-step", "warm-step", "dip")
HEAD = "participant,trial,presented,responded"


VALUES = "participant,kind,method,channel,size_K,value,unit,standard_error,trials,baseline_C"
GOOD = (
    "P1,threshold,limits,cold,,1.2,K,0.1,,",
    "P1,reaction_time,,warm,6,850,ms,,12,31",
    "P2,rating,,warm,6,40,points,,,",
)


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


def asked_and_said(missing: str = "") -> dict[str, list[tuple[str, str]]]:
    """Two participants' trials, in two blocks of six; every fifth is answered wrongly or, with a word, not at all."""
    rng, found = np.random.default_rng(5), {}
    for person in ("P1", "P2"):
        shown = [ICONS[k] for _ in range(2) for k in rng.permutation([0, 1, 2, 0, 1, 2])]
        found[person] = [(icon, icon if k % 5 else missing or ICONS[k % 3]) for k, icon in enumerate(shown)]
    return found


def table_of(shape: str, trials: dict[str, list[tuple[str, str]]]) -> list[str]:
    """The lines of a file in which these trials are written in one of the shapes."""
    long = [(person, k, *pair) for person, pairs in trials.items() for k, pair in enumerate(pairs)]
    if shape == "wide":
        head = ",".join(f"icon_{k},answer_{k}" for k in range(12))
        return [f"who,{head}", *(",".join([p, *sum(pairs, ())]) for p, pairs in trials.items())]
    if shape == "instructions":
        rows = [f"{p},{k},{icon},{said}" for p, k, icon, said in long]
        return [HEAD, "P1,,,", "P1,read,,go on", *rows, "P2,end,null,null"]
    if shape == "greeting":
        rows = [",".join(map(str, row)) for row in long]
        return ["Experiment 1, thermal icons", "who,trial,presented,responded", *rows]
    if shape == "stimuli":
        rows = [f"{p},{2 * k},+,null\n{p},{2 * k + 1},{icon},{said}" for p, k, icon, said in long]
        return [HEAD.title(), "P1,-1,<p>Place your hand</p>, ", *rows]
    if shape == "restarting":
        return [HEAD, *(f"{p},{k % 6 + 1},{icon},{said}" for p, k, icon, said in long)]
    if shape == "blocks":
        return [f"Block,{HEAD}", *(f"{k // 6},{p},{k % 6 + 1},{icon},{said}" for p, k, icon, said in long)]
    said = [*ICONS, "none"]
    pairs = [(icon, answer if answer in ICONS else "none") for *_, icon, answer in long]
    counts = [f"{icon}," + ",".join(str(pairs.count((icon, answer))) for answer in said) for icon in reversed(ICONS)]
    return ["Table 3: confusions", ",".join(["", *said]), *counts]


@pytest.mark.parametrize("missing", ["", "None", "null", "no answer", "-", "timeout"])
@pytest.mark.parametrize("shape", ["blocks", "restarting", "wide", "instructions", "matrix", "greeting", "stimuli"])
def test_however_an_experiment_writes_its_trials_their_scores_are_the_same(
    tmp_path: Path, shape: str, missing: str
) -> None:
    trials = asked_and_said(missing)
    head, *rows = table_of(shape, trials)
    found = read_trials(written(tmp_path, *rows, head=head), ICONS, {"participant": "who"})
    every = [pair for pairs in trials.values() for pair in pairs]
    pairs = [pair for pair in every if pair[1] in ICONS]
    joint, shown, said = Counter(pairs), Counter(icon for icon, _ in pairs), Counter(answer for _, answer in pairs)
    bits = sum(n / len(pairs) * math.log2(n * len(pairs) / (shown[a] * said[b])) for (a, b), n in joint.items())
    own = score("all", found.counts, found.unanswered.sum(axis=1))
    assert own.proportion_correct == pytest.approx(sum(icon == answer for icon, answer in every) / 24)
    assert own.information_bits_plugin == pytest.approx(bits)
    assert (own.trials, own.unanswered, found.total) == (24, 24 - len(pairs), 24)
    assert found.pooled.tolist() == [[joint[a, b] for b in ICONS] for a in ICONS]
    assert (found.participants, found.grouped) == ((("all",), True) if shape == "matrix" else (("P1", "P2"), False))
    assert found.passed == {"instructions": 3, "stimuli": 25}.get(shape, 0)


def test_an_icon_that_is_misspelt_is_no_instruction_and_per_cents_are_asked_about(tmp_path: Path) -> None:
    with pytest.raises(
        TrialsError, match=r"csv:3: presented is 'dipp', which is not an icon of the set; did you mean dip"
    ):
        read_trials(written(tmp_path, "P1,1,dip,dip", "P1,2,dipp,"), ICONS)
    with pytest.raises(TrialsError, match=r"csv:2: presented is 'wave', which is not an icon .*; known: cool"):
        read_trials(written(tmp_path, "P1,1,wave,wave"), ICONS)
    with pytest.warns(UserWarning, match="sum to 100, read as counts; if they are per cents, write numbers of answers"):
        read_trials(written(tmp_path, "dip,90.0,10", "cool-step,5,95", head=",dip,cool-step"), ICONS)


@pytest.mark.parametrize("lost", ["missing", "n/a", "NaN"])
def test_what_is_missing_is_no_trial_and_a_silence_is_a_miss_of_felt_and_named_alone(tmp_path: Path, lost: str) -> None:
    rows = ["P1,1,dip,dip", "P1,2,dip,none", f"P1,3,dip,{lost}", "P1,4,dip,cool-step", f"P2,1,dip,{lost}"]
    found = read_trials(written(tmp_path, *rows), ICONS)
    assert (found.participants, found.total, found.missing, found.forced) == (("P1",), 3, 2, False)
    own = score("all", found.counts, found.unanswered.sum(axis=1))
    assert (own.proportion_correct, own.named) == (pytest.approx(1 / 3), 0.5)
    forced = read_trials(written(tmp_path, *(row for row in rows if "none" not in row)), ICONS)
    own = score("all", forced.counts, forced.unanswered.sum(axis=1))
    assert forced.forced and own.proportion_correct == own.named == 0.5
    counts = read_trials(
        written(tmp_path, "dip,3,1,4,2", "cool-step,0,5,0,0", head=f",dip,cool-step,{lost},none"), ICONS
    )
    assert (counts.missing, counts.unanswered.sum(), counts.total, counts.grouped) == (4, 2, 11, True)
    both = read_trials(
        written(tmp_path, "dip,3,0,4,2", "cool-step,0,1,1,0", head=",dip,cool-step,timeout,none"), ICONS[::2]
    )
    assert both.unanswered.tolist() == [[1, 6]]


def test_somebody_who_felt_nothing_is_a_participant_without_a_name(tmp_path: Path) -> None:
    found = read_trials(written(tmp_path, "P1,1,dip,dip", "P2,1,dip,", "P2,2,dip,timeout"), ICONS)
    own = score("P2", found.counts[1:], found.unanswered[1:].sum(axis=1))
    assert (own.trials, own.unanswered, own.proportion_correct, own.named) == (2, 2, 0.0, None)


def test_an_icon_may_be_called_none(tmp_path: Path) -> None:
    found = read_trials(written(tmp_path, "P1,1,none,none", "P1,2,dip,"), ("none", "dip"))
    assert (found.pooled.tolist(), found.unanswered.tolist()) == ([[1, 0], [0, 0]], [[0, 1]])


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
    with pytest.raises(TrialsError, match="the file is empty; the first line is such as: participant,trial"):
        read_trials(path, ICONS)
    path.write_bytes(b"PK\0\1")
    with pytest.raises(TrialsError, match="binary file, not a table"):
        read_trials(path, ICONS)
    written(tmp_path, *(f"P1,{k},dip,dip" for k in range(5)))
    monkeypatch.setattr(trials_file, "MOST_ROWS", 4)
    with pytest.raises(TrialsError, match="more than 4 rows; split the file"):
        read_trials(path, ICONS)
    monkeypatch.setattr(trials_file, "MOST_MB", 1e-5)
    with pytest.raises(TrialsError, match="too large for a table of trials; the limit is 1e-05 MB"):
        read_trials(path, ICONS)
    monkeypatch.undo()
    monkeypatch.setattr(trials_file, "MOST_PARTICIPANTS", 2)
    written(tmp_path, *(f"P{k},1,dip,dip" for k in range(3)))
    with pytest.raises(TrialsError, match="3 participants; at most 2 are taken: check that the column participant"):
        read_trials(path, ICONS)


def test_values_units_defaults_and_gaps_are_read(tmp_path: Path, rig: Rig) -> None:
    found = read_measurements(written(tmp_path, *GOOD, head=VALUES), rig)
    limits, time, rating = found.conditions
    assert (limits.size_K, limits.rate_K_per_s, limits.baseline_C) == (12.0, 1.0, 32.0)
    assert (time.method, time.rate_K_per_s, time.baseline_C) == ("choice", 5.0, 31.0)
    assert rating.method == "magnitude"
    assert found.values[0, 1] == pytest.approx(0.85)
    assert np.isnan(found.values[0, 2]) and np.isnan(found.values[1, 0])
    assert found.errors[0, 0] == pytest.approx(0.1)
    assert found.trials[0, 1] == 12.0
    assert found.assumed_errors == 1
    assert len(found.digest) == 16


def test_measurements_that_are_given_as_answers_are_told_where_they_belong(tmp_path: Path) -> None:
    with pytest.raises(TrialsError, match="these are measurements, not answers; give them as measurements"):
        read_trials(written(tmp_path, *GOOD, head=VALUES), ICONS)


@pytest.mark.parametrize("cell", ["drives/cool-step.csv", r"C:\icons\Cool_Step.wav", "COOL STEP", "num_2"])
def test_a_cell_means_an_icon_by_its_name_its_file_or_what_is_said_of_it(tmp_path: Path, cell: str) -> None:
    found = read_trials(written(tmp_path, f"P1,1,{cell},dip", f"P1,2,dip,{cell}"), ICONS, {"cool-step": "num_2"})
    assert found.pooled[ICONS.index("cool-step"), ICONS.index("dip")] == 1
    assert found.pooled[ICONS.index("dip"), ICONS.index("cool-step")] == 1
    with pytest.raises(TrialsError, match=r"'num_3', which is not an icon .*ICON.: .num_3"):
        read_trials(written(tmp_path, "P1,1,num_3,num_3"), ICONS)


@pytest.mark.parametrize(
    "words", ["shown_{k} answer_{k}", "trial{k}_stimulus trial{k}_response", "icon.{k} responded.{k}"]
)
def test_a_row_of_each_person_may_call_its_columns_otherwise(tmp_path: Path, words: str) -> None:
    first, second = (words.format(k=k).split() for k in (1, 2))
    path = written(tmp_path, "P1,dip,dip,warm-step,", head=",".join(("participant", *first, *second)))
    found = read_trials(path, ICONS)
    assert (found.pooled.sum(), found.pooled[2, 2], found.unanswered[0, 1], found.total) == (1, 1, 1, 2)
    with pytest.raises(TrialsError, match=f"{second[0]} stands alone"):
        read_trials(written(tmp_path, "P1,dip,dip,dip", head=",".join(("participant", *first, second[0]))), ICONS)


def test_columns_are_proposed_by_their_cells_and_not_by_their_names_alone(tmp_path: Path) -> None:
    rows = (f"html,{k},{k // 2}-{k},P{k // 2},{'dip' if k else 'warm-step'},dip" for k in range(6))
    path = written(tmp_path, *rows, head="trial_type,trial_index,node_id,subject,Q1,Q2_key")
    theirs = {"participant": "subject", "trial": "trial_index", "presented": "Q1", "responded": "Q2_key"}
    with pytest.raises(TrialsError, match="columns missing: participant, trial, presented, responded") as raised:
        read_trials(path, ICONS)
    assert raised.value.changes["columns"] == theirs
    assert read_trials(path, ICONS, theirs).pooled[:, 2].tolist() == [0, 1, 5]


def test_the_screens_of_a_trial_are_one_trial(tmp_path: Path) -> None:
    rows = ["P1,1,dip,", "P1,1,dip,dip", "P1,2,dip,cool-step", "P1,2,dip,", "P1,3,dip,", "P1,3,dip,", "P1,4,dip,"]
    found = read_trials(written(tmp_path, *rows), ICONS)
    assert (found.total, found.passed, found.unanswered.sum()) == (4, 3, 2)
    with pytest.raises(TrialsError, match="trial '1' twice"):
        read_trials(written(tmp_path, "P1,9,dip,dip", *rows[:2], "P1,1,cool-step,"), ICONS)


def test_another_word_for_what_was_not_felt_can_be_said_and_a_name_that_is_none_of_ours_is_refused(
    tmp_path: Path,
) -> None:
    path = written(tmp_path, "P1,1,dip,dip", "P1,2,dip,nichts")
    with pytest.raises(TrialsError, match="leave the cell empty, or put none for ICON"):
        read_trials(path, ICONS)
    assert read_trials(path, ICONS, {"none": "nichts"}).unanswered.sum() == 1
    with pytest.raises(
        TrialsError, match="dipp is neither a column of answers nor an icon of the set; did you mean dip"
    ):
        read_trials(path, ICONS, {"dipp": "nichts"})


@pytest.mark.parametrize("coding", ["utf-8", "utf-16"])
def test_the_log_of_e_prime_is_told_what_to_export(tmp_path: Path, coding: str) -> None:
    path = tmp_path / "e.txt"
    path.write_text("*** Header Start ***\nSubject: 1\n\t*** LogFrame Start ***\n\tIcon: dip\n", encoding=coding)
    with pytest.raises(TrialsError, match="this is a log of E-Prime, not a table; export a table from E-DataAid"):
        read_trials(path, ICONS)


@pytest.mark.parametrize(
    ("corner", "turned"), [("presented", False), ("stimulus/response", False), ("response\\stimulus", True)]
)
def test_the_corner_of_a_matrix_says_whether_its_rows_are_answers(tmp_path: Path, corner: str, turned: bool) -> None:
    found = read_trials(written(tmp_path, "dip,7,3", "cool-step,0,5", head=f"{corner},dip,cool-step"), ICONS[::2])
    assert found.pooled.tolist() == ([[5, 3], [0, 7]] if turned else [[5, 0], [3, 7]])


def test_icons_and_answers_may_stand_in_cells_of_json(tmp_path: Path) -> None:
    cell = '"{{""icon"": ""{}"", ""answer"": {{""name"": ""{}""}}}}"'
    rows = (f"P1,1,{cell.format('dip', 'dip')}", f"P1,2,{cell.format('warm-step', 'dip')}", "P1,3,{}")
    theirs = {"presented": "icon", "responded": "answer.name"}
    found = read_trials(written(tmp_path, *rows, head="participant,trial,data"), ICONS, theirs)
    assert (found.pooled[2, 2], found.pooled[1, 2], found.total, found.passed) == (1, 1, 2, 1)
    with pytest.raises(TrialsError, match=r"presented is 'wave', which is not an icon"):
        read_trials(
            written(tmp_path, f"P1,1,{cell.format('wave', 'dip')}", head="participant,trial,data"), ICONS, theirs
        )


def test_two_icons_that_are_written_alike_need_their_own_names(tmp_path: Path) -> None:
    found = read_trials(written(tmp_path, "P1,1,a_b,A-b"), ("a-b", "A-b", "a_b"))
    assert found.pooled.tolist() == [[0, 0, 0], [0, 0, 0], [0, 1, 0]]
    with pytest.raises(TrialsError, match="'A_B', which is not an icon"):
        read_trials(written(tmp_path, "P1,1,A_B,a-b"), ("a-b", "A-b", "a_b"))


def test_files_of_several_people_are_joined_with_a_person_each(tmp_path: Path) -> None:
    files = list[Path]()
    for name, head in (("ann", "trial,presented,responded"), ("bob", "trial,presented,responded"), ("cy", HEAD)):
        (tmp_path / f"{name}.csv").write_text(f"{head}\n" + f"{'C1,' * (head == HEAD)}1,dip,dip\n")
        files.append(tmp_path / f"{name}.csv")
    assert read_trials(files, ICONS).participants == ("ann", "bob", "C1")
    (tmp_path / "dan.csv").write_text(f"{HEAD}\nC1,1,dip,cool-step\n")
    found = read_trials([*files, tmp_path / "dan.csv"], ICONS)
    assert found.participants == ("ann", "bob", "C1", "dan") and found.total == 4
    assert found.digest != read_trials(files, ICONS).digest


def test_rounded_per_cents_are_asked_for_their_trials(tmp_path: Path) -> None:
    head = ",dip,cool-step"
    with pytest.raises(TrialsError, match="rows sum to 99 to 101: these are per cents; write numbers of answers"):
        read_trials(written(tmp_path, "dip,62,37", "cool-step,0,100", head=head), ICONS)
    assert read_trials(written(tmp_path, "dip,62,36", "cool-step,0,100", head=head), ICONS).total == 198


@pytest.mark.parametrize("row", MESSAGES["measurements"])
def test_each_mistake_is_named_with_its_line_and_cure(tmp_path: Path, rig: Rig, row: str) -> None:
    added = row if "12,1.4" in row else row.replace("P1,", "P9,")
    path = written(tmp_path, *GOOD, added, head=VALUES)
    with pytest.raises(TrialsError, match=rf"trials\.csv:5: .*{MESSAGES['measurements'][row]}"):
        read_measurements(path, rig)


def test_a_missing_or_misspelt_column_is_named(tmp_path: Path, rig: Rig) -> None:
    with pytest.raises(TrialsError, match=r"columns missing: channel, unit; found: participant, kind, value"):
        read_measurements(written(tmp_path, "P1,rating,3", head="participant,kind,value"), rig)
    head = VALUES.replace("standard_error", "standard_eror")
    with pytest.raises(TrialsError, match=r"no column 'standard_eror'; did you mean standard_error"):
        read_measurements(written(tmp_path, *GOOD, head=head), rig)
