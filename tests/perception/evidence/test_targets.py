"""The targets are data: they load, name records that are there, and carry no published number of their own."""

from dataclasses import replace
from pathlib import Path

import pytest

from thermicon.circuit.records import RecordError, Table
from thermicon.perception.evidence.calibrate import calibrate, to_toml
from thermicon.perception.evidence.targets import Row, Target, load_targets, published_for
from thermicon.perception.observer.observer import DATA, load_thresholds

TARGETS = load_targets()


def rows() -> list[Row]:
    return [row for target in TARGETS for row in target.rows]


def test_nine_targets_with_rows_and_a_mechanism_each() -> None:
    assert [target.number for target in TARGETS] == list(range(1, 10))
    for target in TARGETS:
        assert target.asks
        assert target.mechanism
        # Of published pulses nothing is known but how many were named.
        assert any(row.judged for row in target.rows) == (target.title != "Sequences of short pulses")


def test_labels_tell_rows_apart() -> None:
    labels = [(row.target, row.label) for row in rows()]
    assert len(labels) == len(set(labels))


def test_published_numbers_are_predicted_or_said_to_be_fitted() -> None:
    known, fitted = load_thresholds(), 0
    for row in rows():
        if row.published:
            published = published_for(row, known)
            assert published.source
            uses = {r.use for r in known.select(row.published) if r.source == published.source}
            fitted += published.text.endswith(", fitted")
            assert published.text.endswith(", fitted") == ("calibrate" in uses)
            assert uses & {"predict", "calibrate"}
        else:
            assert published_for(row, known).value is None
    assert 0 < fitted < 12


def test_another_number_published_is_another_number_shown_and_the_observer_stays() -> None:
    known = load_thresholds()
    moved = tuple(replace(r, value=r.value * 0.9, low=None) if r.use == "predict" and r.value else r for r in known)
    other = Table(known.name, moved)
    changed = 0
    for row in rows():
        if row.published:
            before, after = published_for(row, known), published_for(row, other)
            changed += before.text != after.text
    assert changed > 20
    assert to_toml(calibrate(other)) == (DATA / "observer.toml").read_text(encoding="utf-8")


def test_texts_of_published_numbers() -> None:
    known = load_thresholds()
    texts = {row.label: published_for(row, known).text for row in rows()}
    assert texts["reaction time at 10 cm², cold"] == "0.77 [0.63 to 0.94] s, fitted"
    assert texts["back of the hand, men 20–30 y, warm"] == "1.62 [1.01 to 2.61] K"
    assert texts["felt peak minus the skin's, cold"] == "sign −"
    assert texts["exponent of area, cold"] == "−0.23 [−0.27 to −0.19], fitted"
    assert texts["rise from cold to warm"] == "0.64 proportion, the worst"
    assert texts["reaction time, warm over cold"] == "2.16, fitted"


def write(folder: Path, text: str) -> tuple[Target, ...]:
    path = folder / "targets.toml"
    path.write_text(text, encoding="utf-8")
    return load_targets(path)


TARGET = '[[record]]\nkind = "target"\ntarget = 1\nquantity = "t"\nunit = "s"\nsource = "a"\n'
ROW = '[[record]]\nkind = "row"\ntarget = 1\nname = "n"\nquantity = "q"\nunit = "s"\nsource = "a"\nrule = "shown"\n'


def test_messages(tmp_path: Path) -> None:
    assert write(tmp_path, TARGET + ROW)[0].rows[0].name == "n"
    with pytest.raises(RecordError, match=r"target 1 has no row"):
        write(tmp_path, TARGET)
    with pytest.raises(RecordError, match=r"rows of target 2, which is not there"):
        write(tmp_path, TARGET + ROW + ROW.replace("target = 1", "target = 2"))
    with pytest.raises(RecordError, match=r"'t' has kind = 'goal', which is neither target nor row"):
        write(tmp_path, TARGET.replace('"target"', '"goal"') + ROW)
    with pytest.raises(RecordError, match=r"'q' does not say of which target: add target = its number"):
        write(tmp_path, TARGET + ROW.replace("target = 1\n", "value = 1.0\n"))
    with pytest.raises(RecordError, match=r"unknown key 'mechanisms'; did you mean mechanism"):
        write(tmp_path, TARGET + 'mechanisms = "x"\n' + ROW)
    many = Row(2, "limits", "cold", "K", "x", "y", "shown", "ours", published="limits threshold")
    with pytest.raises(RecordError, match=r"6 records of 'limits threshold' for 'limits, cold': one is needed"):
        published_for(replace(many, published_site=""), load_thresholds())
    with pytest.raises(RecordError, match=r"0 records .* whose conditions begin with 'girls' for 'limits, cold'"):
        published_for(replace(many, published_where="girls"), load_thresholds())
