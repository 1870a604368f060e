"""The tables of docs/explain/safety.md are those of the data files; run as a script, this file prints them anew."""

import re
from pathlib import Path

import pytest

from thermicon.circuit import Device, Rig, SessionPlan, play_session
from thermicon.circuit.delivery.device import device_names
from thermicon.circuit.records import Record
from thermicon.circuit.rig.rules import LONGEST_SESSION_MIN, Limits, limit_table
from thermicon.circuit.rig.uncertainty import uncertainty_table
from thermicon.circuit.safety.demanded import TEST_A, TEST_S
from thermicon.circuit.safety.endings import ENDING_S, ENDINGS, LATER_S
from thermicon.circuit.safety.repeated import LONGEST_PAUSE_S
from thermicon.circuit.safety.single import RECOVERED_K
from thermicon.circuit.safety.single_faults import BEYOND_K, INSTANTS, MARGIN, REACTIONS_S
from thermicon.icons import load_library
from thermicon.icons.number_text import signed

PAGE = Path(__file__).resolve().parents[1] / "docs" / "explain" / "safety.md"
LIMITS_HEAD = "| limit of | hard or soft | shipped | key in `[safety]` | can be loosened to |"
UNCERTAINTY_HEAD = "| `[uncertainty]` | shipped | source |"


def side(record: Record, end: str) -> list[str]:
    """The row of one end of a record; nothing where it has no such end."""
    value, extra = getattr(record, end), dict(record.extra)
    if value is None:
        return []
    sign, unit = ("≤" if end == "high" else "≥"), "" if record.unit == "1" else f" {record.unit}"
    key, bound = extra.get(f"{end}_key"), extra.get(f"{end}_bound")
    if record.unit in ("K", "K/s"):
        sign, value = "±", abs(value)
    loosest = f"{signed(float(str(bound)))}{unit}" if bound is not None else "only tightened" if key else "fixed"
    what = record.quantity + (f", {record.conditions}" if record.unit == "K" else "")
    limit = f"{sign}{'' if sign == '±' else ' '}{signed(value)}{unit}"
    return [f"| {what} | {extra['severity']} | {limit} | {f'`{key}`' if key else '—'} | {loosest} |"]


def limit_rows() -> list[str]:
    """A row for each end of each shipped limit."""
    return [row for record in limit_table() for end in ("low", "high") for row in side(record, end)]


def uncertainty_rows() -> list[str]:
    """A row for each shipped uncertainty."""
    return [
        f"| `{one.quantity}` | ±{one.central:g}{'' if one.unit == '1' else f' {one.unit}'} | {one.source} |"
        for one in uncertainty_table()
    ]


def rows_below(head: str) -> list[str]:
    """The rows of the table with this head."""
    table = PAGE.read_text(encoding="utf-8").partition(f"{head}\n")[2].partition("\n\n")[0]
    return table.splitlines()[1:]


@pytest.mark.parametrize(
    ("head", "rows"), [(LIMITS_HEAD, limit_rows()), (UNCERTAINTY_HEAD, uncertainty_rows())], ids=["limits", "corners"]
)
def test_a_table_is_that_of_its_data(head: str, rows: list[str]) -> None:
    assert rows_below(head) == rows


def test_the_constants_without_a_source_are_those_of_the_code() -> None:
    text = re.sub(r"\s+", " ", PAGE.read_text(encoding="utf-8"))
    assert set(ENDINGS) == {"last value held", "zero current", "power off"}
    for words in (
        f"session of {Limits.shipped().session_s / 60:g} min",
        f"1 to {LONGEST_SESSION_MIN:g} min",
        f"{ENDING_S:g} s of each ending",
        f"{LATER_S / 60:g} min of zero current",
        f"within {RECOVERED_K:g} K of rest",
        f"0 to {LONGEST_PAUSE_S:g} s",
        f"{MARGIN:g} of the time",
        f"{BEYOND_K:g} K beyond",
        f"{TEST_A:g} A for {TEST_S:g} s",
        f"{INSTANTS} stretches of the drive",
        f"{', '.join(f'{one:g}' for one in REACTIONS_S[:0:-1])} or {REACTIONS_S[0]:g} s",
    ):
        assert words in text, words


if __name__ == "__main__":
    print("\n".join([LIMITS_HEAD, *limit_rows(), "", UNCERTAINTY_HEAD, *uncertainty_rows()]))


def test_the_device_without_a_row_among_the_refusals_is_named() -> None:
    page, refusals = PAGE.read_text(encoding="utf-8"), PAGE.parents[1] / "reference" / "refusals.md"
    rows = refusals.read_text(encoding="utf-8").partition("## Causes")[0]
    missing = [name for name in device_names() if f"| {name} |" not in rows]
    assert missing == ["dc-coupled-audio"]
    assert "(`dc-coupled-audio`) is judged as volts" in page
    assert Device.load("dc-coupled-audio").driven_by == "volts"


def test_a_session_of_a_closed_loop_is_judged_in_the_open_loop_scenarios() -> None:
    page, rig = " ".join(PAGE.read_text(encoding="utf-8").split()), Rig.load("thenar")
    plan = SessionPlan(("cooling-step",), 10.0)
    looped = play_session(load_library("six-icons"), plan, rig, tracking="display")
    assert f"**is judged in the {looped.scenarios} open-loop scenarios too**" in page
    coldest = next(check for check in looped.checks if check.quantity == "display" and not check.upper)
    assert coldest.value < looped.trace.display_C.min() - 1.0, "a loop would not let the display go so far"
