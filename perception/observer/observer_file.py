"""Observer files: whether one has every number that an observer needs."""

from __future__ import annotations

from pathlib import Path

from thermicon.circuit.records import RecordError, Table, load_records
from thermicon.icons.near_words import nearest_words

NEEDED = (
    "neutral zone", "slow adaptation time", "threshold drive", "conduction velocity", "area exponent",
    "softness of the limits", "threshold on the forearm", "integration time",
    "slope of sensation", "transducer exponent", "gain noise", "reference area", "criterion of speeded answers",
    "noise correlation time", "path length to the cord", "decision time", "choice time", "decision time between trials",
    "lapse rate", "memory noise", "mean rating", "rating at threshold", "rating exponent",
    "scatter of ratings", "share of the scatter of ratings", "cost of a missing episode", "bar of an episode",
)  # fmt: skip
"""Quantities of every variant; a variant's own have its ending."""

NEEDED_OF = {"temperature": ("limit",), "heat flow": ("neutral heat flow",)}
"""Quantities that depend on the sensory variable."""

SHIPPED = Path(__file__).parents[1] / "data" / "observer.toml"
CURE = (
    f"begin with a copy of the shipped file, {SHIPPED}, and change numbers there; or infer all of them again from your "
    "evidence with python -m thermicon.perception.evidence fit and python -m thermicon.perception.evidence observer"
)
MOST_NAMED = 6


def read_records(path: Path) -> Table:
    """Records of an observer's file; a RecordError where a quantity has another unit than the shipped one.

    Values are not converted.
    """
    table = load_records(path)
    shipped = {record.quantity: record.unit for record in load_records(SHIPPED)}
    for record in table:
        unit = shipped.get(record.quantity, record.unit)
        if record.unit != unit:
            raise RecordError(
                f"{table.name}: {record.quantity}: unit {record.unit!r}, but this quantity is in {unit!r}: convert the "
                "value and its interval, and write that unit"
            )
    return table


def check_complete(table: Table, variable: str, variant: str) -> None:
    """Raise a RecordError where quantities are missing for a variant, whose own names end as `variant` says."""
    known = {record.quantity for record in table}
    wanted = (*NEEDED, *NEEDED_OF[variable])
    missing = [name for name in wanted if name not in known and f"{name}{variant}" not in known]
    if not missing:
        return
    near = {name: nearest_words(name, sorted(known - set(wanted)), 1, 0.75) for name in missing}
    meant = [f"{close[0]!r} may be meant for {name!r}" for name, close in near.items() if close]
    hint = f" ({'; '.join(meant[:MOST_NAMED])})" if meant else ""
    count = "a number that an observer needs is" if len(missing) == 1 else "numbers that an observer needs are"
    more = [f"and {len(missing) - MOST_NAMED} more"] if len(missing) > MOST_NAMED else []
    named = ", ".join([*(repr(name) for name in missing[:MOST_NAMED]), *more])
    raise RecordError(f"{table.name}: {count} missing: {named}{hint}. Cure: {CURE}")
