from dataclasses import replace

import pytest

from thermicon.base.files.records import Record, RecordError, RecordTable, dump_records, load_records
from thermicon.perception.evidence.calibrate import COMMENT, calibrate
from thermicon.perception.evidence.results import load_constants
from thermicon.perception.observer.channels import VARIABLES, source_of
from thermicon.perception.observer.draws import PosteriorDraws
from thermicon.perception.observer.observer import CHANNELS, DATA, load_thresholds

SHIPPED = DATA / "observer.toml"
AGAIN = "the observer is out of date: run python -m thermicon.perception.evidence observer"


def test_the_shipped_observer_is_what_calibrate_finds() -> None:
    assert dump_records(calibrate(), comment=COMMENT) == SHIPPED.read_text(encoding="utf-8"), AGAIN


def test_predicted_records_and_references_do_not_reach_the_observer() -> None:
    table = load_thresholds()

    def moved(record: Record) -> Record:
        kept = record.use not in ("predict", "reference")
        return record if kept else replace(record, value=2.0 * record.central, low=None, high=None)

    others = [
        RecordTable(table.name, tuple(map(moved, table))),
        RecordTable(table.name, tuple(record for record in table if record.use != "predict")),
    ]
    for other in others:
        assert other != table
        assert dump_records(calibrate(other), comment=COMMENT) == SHIPPED.read_text(encoding="utf-8"), AGAIN


def test_every_number_of_the_observer_says_where_it_is_from() -> None:
    for record in load_records(SHIPPED):
        assert record.use in ("calibrate", "assumed")
        assert "not calibrated" not in record.source
    for variant in VARIABLES:
        found = load_records(SHIPPED).select(f"memory noise{source_of(variant)}")
        assert [r.method for r in found] == ["episodes"]


def test_constants_are_those_of_the_maximum_with_the_intervals_of_the_draws() -> None:
    shipped = load_records(SHIPPED)
    limit = next(each for each in load_constants() if each.name == "cold limit")
    record = shipped.one("limit", channel="cold")
    assert record.central == pytest.approx(limit.value, rel=1e-3)
    low, _, high = PosteriorDraws.load().interval("cold limit")
    assert record.interval == pytest.approx((low, high), rel=1e-3)
    assert "Campero" in record.source
    for variant in VARIABLES:
        drive = shipped.one(f"threshold drive{source_of(variant)}", channel="warm")
        own = next(each for each in load_constants(variant) if each.name == "warm threshold drive")
        assert drive.central == pytest.approx(own.value, rel=1e-3)


def test_what_the_evidence_does_not_narrow_says_so() -> None:
    shipped = load_records(SHIPPED)
    for each in load_constants():
        channel, _, rest = each.name.partition(" ")
        if each.mechanism == "laboratories":
            continue
        named = channel in CHANNELS
        record = shipped.one(rest, channel=channel) if named else shipped.one(each.name)
        assert (record.use == "assumed") == (each.narrowed > 0.9), each.name


def test_a_table_without_what_is_needed_is_refused() -> None:
    table = load_thresholds()
    without = RecordTable(table.name, tuple(r for r in table if r.quantity != "rate Weber fraction"))
    with pytest.raises(RecordError, match=r"thresholds.toml: no quantity 'rate Weber fraction'"):
        calibrate(without)
