import json
from pathlib import Path

import pytest

from tests.builders import messages
from thermicon.base.files.records import Record, RecordError, RecordTable, dump_records, load_records

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


def table_of(tmp_path: Path, text: str, *extra: str) -> RecordTable:
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
    assert table.one("velocity", channel="cold") is cold
    assert table_of(tmp_path, dump_records(table, comment="two\nlines"), "tissue") == table


@pytest.mark.parametrize(("change", "message"), messages(__file__)["record"].items())
def test_wrong_records_are_refused(tmp_path: Path, change: str, message: str) -> None:
    text = GOOD.replace(*json.loads(change), 1) if change.startswith("[") else change.lstrip()
    with pytest.raises(RecordError, match=message):
        table_of(tmp_path, text, "tissue")


def test_what_is_not_there_or_not_known_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match=r"missing.toml: no such table of records"):
        load_records(tmp_path / "missing.toml")
    with pytest.raises(RecordError, match=r"unknown key 'tissue'"):
        table_of(tmp_path, GOOD)


@pytest.mark.parametrize(("asked", "message"), messages(__file__)["look up"].items())
def test_look_up_names_the_nearest(tmp_path: Path, asked: str, message: str) -> None:
    quantity, _, channel = asked.partition(" ")
    with pytest.raises(RecordError, match=message):
        table_of(tmp_path, GOOD, "tissue").one(quantity, channel=channel)


def test_a_channel_also_finds_what_holds_for_both() -> None:
    both = Record("spread", "1", "norms", value=0.2, channel="both")
    own = Record("spread", "1", "norms", value=0.3, channel="cold")
    assert RecordTable("t", (both,)).one("spread", channel="warm") is both
    assert RecordTable("t", (both, own)).one("spread", channel="cold") is own


def test_a_record_may_hold_only_further_numbers() -> None:
    record = Record("tissue", "mixed", "Jiang et al. 2002", extra=(("thickness_mm", 2.0),))
    assert record.get("thickness_mm") == 2.0
    with pytest.raises(RecordError, match=r"tissue: no column 'thicknes_mm'; did you mean thickness_mm\?"):
        record.get("thicknes_mm")
    with pytest.raises(RecordError, match=r"tissue: only its further columns have numbers"):
        _ = record.central
