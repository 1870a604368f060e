from pathlib import Path

import pytest

from thermicon.circuit.records import Record, RecordError, Table, dump_records, load_records

GOOD = """
[[record]]
quantity = "velocity"
value = 0.5
low = 0.3
high = 0.7
unit = "m/s"
channel = "warm"
source = "Fowler et al. 1988"
use = "calibrate"

[[record]]
quantity = "velocity"
low = 0.8
high = 3
unit = "m/s"
channel = "cold"
source = "Campero et al. 2001"
tissue = "nerve"
"""


def table_of(tmp_path: Path, text: str, *extra: str) -> Table:
    file = tmp_path / "numbers.toml"
    file.write_text(text, encoding="utf-8")
    return load_records(file, extra=extra)


def test_records_are_read_with_their_intervals(tmp_path: Path) -> None:
    table = table_of(tmp_path, GOOD, "tissue")
    warm, cold = table
    assert (warm.central, warm.interval) == (0.5, (0.3, 0.7))
    assert cold.central == pytest.approx(1.9)
    assert cold.interval == (0.8, 3.0)
    assert cold.get("tissue") == "nerve"
    assert len(table) == 2
    assert table.one("velocity", where={"tissue": "nerve"}) is cold


def test_repr_is_one_line_with_unit_and_source() -> None:
    shown = repr(Record("velocity", "m/s", "Fowler et al. 1988", value=0.5, low=0.3, high=0.7, channel="warm"))
    assert shown == "Record(velocity (warm): 0.5 [0.3, 0.7] m/s; Fowler et al. 1988)"


def test_dumped_records_read_back_equal(tmp_path: Path) -> None:
    table = table_of(tmp_path, GOOD, "tissue")
    again = table_of(tmp_path, dump_records(table, comment="two\nlines"), "tissue")
    assert again == table


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('source = "Fowler et al. 1988"', ""), r"numbers.toml, record 1 \(velocity\): the record has no source: add"),
        (('source = "Fowler et al. 1988"', 'source = " "'), r"record 1 .* has no source"),
        (('quantity = "velocity"\nvalue', "value"), r"record 1 \(no quantity\): the record has no quantity"),
        (("value = 0.5\nlow = 0.3\nhigh = 0.7", ""), r"record 1 .* has no number: add value, or low and high"),
        (
            ("low = 0.3", "low = 0.6"),
            r"low = 0\.6 and value = 0\.5 and high = 0\.7 are not in rising order: low comes first, high last",
        ),
        (("value = 0.5", "value = nan"), r"must be finite numbers"),
        (("value = 0.5", 'value = "0.5"'), r"value = '0.5' must be a number without quotes or unit"),
        (('unit = "m/s"', "unit = 3", 1), r"unit = 3.0 must be a text in quotes"),
        (("value = 0.5", "value = true"), r"value must be a number or a text"),
        (("channel", "chanel"), r"unknown key 'chanel'; did you mean channel\?"),
        (('"calibrate"', '"fit"'), r"use = 'fit' is not one of calibrate, predict, assumed, reference"),
        (('use = "calibrate"', 'confidence = "very"'), r"confidence = 'very' is not one of high, medium, low"),
    ],
)
def test_wrong_records_are_refused(tmp_path: Path, change: tuple[str, str], message: str) -> None:
    text = GOOD.replace(change[0], change[1], 1)
    with pytest.raises(RecordError, match=message):
        table_of(tmp_path, text, "tissue")


def test_wrong_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match=r"numbers.toml: not a valid TOML file: "):
        table_of(tmp_path, "[[record")
    with pytest.raises(RecordError, match=r"numbers.toml: a table of records has \[\[record\]\] blocks"):
        table_of(tmp_path, "records = 1")
    with pytest.raises(RecordError, match=r"numbers.toml: record 1 is not a block"):
        table_of(tmp_path, "record = [1]")
    with pytest.raises(RecordError, match=r"missing.toml: no such table of records"):
        load_records(tmp_path / "missing.toml")
    with pytest.raises(RecordError, match=r"unknown key 'tissue'"):
        table_of(tmp_path, GOOD)


def test_look_up_names_the_nearest(tmp_path: Path) -> None:
    table = table_of(tmp_path, GOOD, "tissue")
    with pytest.raises(RecordError, match=r"no quantity 'velocty'; did you mean velocity\?"):
        table.one("velocty")
    with pytest.raises(RecordError, match=r"'velocity' has no record with channel = 'cool'; did you mean cold\?"):
        table.one("velocity", channel="cool")
    with pytest.raises(RecordError, match=r"2 records match 'velocity': say which channel, site or method"):
        table.one("velocity")
    with pytest.raises(RecordError, match=r"velocity: no column 'tisue'; did you mean tissue\?"):
        table.records[1].get("tisue")


def test_a_channel_also_finds_what_holds_for_both() -> None:
    both = Record("spread", "1", "norms", value=0.2, channel="both")
    own = Record("spread", "1", "norms", value=0.3, channel="cold")
    assert Table("t", (both,)).one("spread", channel="warm") is both
    assert Table("t", (both, own)).one("spread", channel="cold") is own


def test_a_record_may_hold_only_further_numbers() -> None:
    record = Record("tissue", "mixed", "Jiang et al. 2002", extra=(("thickness_mm", 2.0),))
    assert record.get("thickness_mm") == 2.0
    with pytest.raises(RecordError, match=r"tissue: only its further columns have numbers"):
        _ = record.central
