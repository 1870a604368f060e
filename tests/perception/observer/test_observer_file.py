"""Observer files that cannot be used: what is missing, what it is called now, and what to do."""

from __future__ import annotations

from pathlib import Path

import pytest

from thermicon.circuit.records import RecordError, Table, dump_records, load_records
from thermicon.perception import Observer
from thermicon.perception.observer.channels import VARIABLES, Variable
from thermicon.perception.observer.observer_file import NEEDED, NEEDED_OF, SHIPPED


def without(quantity: str, instead: str | None = None) -> Table:
    records = tuple(
        r if r.quantity != quantity else type(r)(instead or "x", r.unit, r.source, r.central)
        for r in load_records(SHIPPED)
        if r.quantity != quantity or instead
    )
    return Table("mine.toml", records)


def test_a_missing_number_is_named_with_the_nearest(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(dump_records(without("gain noise", "gain nois")), encoding="utf-8")
    with pytest.raises(
        RecordError, match=r"a number that an observer needs is missing: 'gain noise' \('gain nois' may"
    ):
        Observer.load(path)
    with pytest.raises(RecordError, match=r"^mine.toml: a number .* missing: 'limit'\. Cure: begin with a copy of"):
        Observer.from_table(without("limit"))


@pytest.mark.parametrize("variable", VARIABLES)
def test_whatever_is_needed_is_asked_for(variable: Variable) -> None:
    """Every quantity of the list that an observer is built from leads to this error, and to no other."""
    for quantity in (*NEEDED, *NEEDED_OF[variable]):
        kept = tuple(r for r in load_records(SHIPPED) if not r.quantity.startswith(quantity))
        with pytest.raises(RecordError, match=rf"missing: .*'{quantity}'"):
            Observer.from_table(Table("x", kept), variable=variable)


def test_a_file_that_is_not_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "binary.toml"
    path.write_bytes(b"[[record]]\nquantity = '\xff'")
    with pytest.raises(
        RecordError, match=r"binary.toml: not UTF-8 text \(byte 23\); save the table of records as UTF-8"
    ):
        Observer.load(path)


def test_a_quantity_in_another_unit_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    text = SHIPPED.read_text(encoding="utf-8")
    path.write_text(text.replace('unit = "s"', 'unit = "ms"', 1), encoding="utf-8")
    with pytest.raises(
        RecordError, match=r"mine\.toml: .*: unit 'ms', but this quantity is in '.+': convert the value"
    ):
        Observer.load(path)
