"""Tables of the docs from data files."""

from __future__ import annotations

from collections.abc import Iterator

from table_text import markdown

from thermicon.base.files.records import Record, shipped_records
from thermicon.base.words.number_text import signed
from thermicon.circuit.rig.rules import limit_table
from thermicon.icons.files.catalogue import catalogue

HEADINGS = {"E0": "The file as a whole", "E1": "Words, numbers and units", "E2": "Meaning"}


def errors() -> str:
    """Every error with its meaning and an example; the examples are run."""
    lines, part = [], ""
    for entry in catalogue().values():
        if HEADINGS[entry.code[:2]] != part:
            part = HEADINGS[entry.code[:2]]
            lines += [f"## {part}", ""]
        lines += [f"### {entry.code} {entry.title}", "", entry.meaning, ""]
        if entry.cure:
            lines += [entry.cure, ""]
        if entry.wrong:
            lines += ["```cue", entry.wrong.strip("\n"), "```", "", "```text", entry.message(), "```", ""]
        if entry.right:
            lines += ["Right:", "", "```cue", entry.right.strip("\n"), "```", ""]
    return "\n".join(lines)


def limits_table() -> str:
    """A row for each end of each shipped limit."""
    head = ("limit of", "hard or soft", "shipped", "key in `[safety]`", "can be loosened to")
    return markdown(head, (row for record in limit_table() for end in ("low", "high") for row in _end(record, end)))


def _end(record: Record, end: str) -> Iterator[tuple[str, ...]]:
    """Yield the row of one end of a limit, if it has that end."""
    value, extra = getattr(record, end), dict(record.extra)
    if value is None:
        return
    sign, unit = ("≤" if end == "high" else "≥"), "" if record.unit == "1" else f" {record.unit}"
    key, bound = extra.get(f"{end}_key"), extra.get(f"{end}_bound")
    if record.unit in ("K", "K/s"):
        sign, value = "±", abs(value)
    loosest = f"{signed(float(str(bound)))}{unit}" if bound is not None else "only tightened" if key else "fixed"
    what = record.quantity + (f", {record.conditions}" if record.unit == "K" else "")
    limit = f"{sign}{'' if sign == '±' else ' '}{signed(value)}{unit}"
    yield what, str(extra["severity"]), limit, f"`{key}`" if key else "—", loosest


def uncertainties_table() -> str:
    """A row for each shipped uncertainty of a rig."""
    rows = [
        (f"`{one.quantity}`", f"±{one.central:g}{'' if one.unit == '1' else f' {one.unit}'}", one.source)
        for one in shipped_records("uncertainty.toml")
    ]
    return markdown(("`[uncertainty]`", "shipped", "source"), rows)


DATA_TABLES = {"errors": errors, "limits": limits_table, "uncertainties": uncertainties_table}
"""What fills the places of these names in the pages."""
