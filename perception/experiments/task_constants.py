"""Constants of a task that an observer does not carry: criteria of other tasks, ratings, labels.

They were inferred together with the observer's own and stand in the same file.
"""

from __future__ import annotations

from thermicon.circuit.records import RecordError, Table

from ..observer.observer import Observer, variant_records
from ..observer.variants import source_of

DISCREPANCY = 0.05
"""What a model of this kind may miss a published or measured value by, as a share; assumed."""
UNSTATED = 0.10
"""Error of a threshold whose error is not stated, as a share; assumed."""


def task_constant(
    procedure: str, quantity: str, observer: Observer, records: Table | None = None, channel: str = ""
) -> float:
    """A constant of the observer's variant, from the shipped records or from others.

    Raises RecordError that names procedure, table and constant where it is missing.

    >>> round(task_constant("yes/no", "criterion of yes and no", Observer.load()), 1)
    5.1
    """
    table = variant_records(observer.variable) if records is None else records
    known = {record.quantity for record in table}
    own = f"{quantity}{source_of(observer.variable)}"
    try:
        return table.one(own if own in known else quantity, channel=channel).central
    except RecordError as missing:
        named = f"{quantity!r}{f' ({channel})' if channel else ''}"
        raise RecordError(
            f"{procedure} needs {named}, which {table.name} does not have: add the record, or leave out records to use "
            f"the shipped ones ({missing})"
        ) from None
