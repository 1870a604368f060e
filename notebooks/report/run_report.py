"""Reports of runs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from thermicon.base.words.number_text import number, percent, span

from ..files.trace_files import Aligned, differences, quantity, with_unit
from .blocks import Block, Grid, Text, grid

if TYPE_CHECKING:
    import pandas as pd

    from thermicon.circuit import Session, Trace

MOST_SHOWN = 60
"""Plays in the table of a session; all of them are in the JSON."""
PRINTED: Mapping[str, tuple[float, str, str]] = {
    "felt_and_named": (100.0, ".0f", " %"),
    "felt_and_named_95": (100.0, ".0f", " %"),
    "named": (100.0, ".0f", " %"),
    "named_95": (100.0, ".0f", " %"),
    "detected": (100.0, ".0f", " %"),
    "onset": (1.0, ".2f", " s"),
    "d_prime": (1.0, ".1f", ""),
    "bits": (1.0, ".2f", " bits"),
}
"""By measured quantity: factor, format and unit in print; d′ is that of the nearest other icon."""


def headline(trace: Trace) -> str:
    """One line about a run: its name, and what it came to."""
    return f"{trace.icon or 'drive'}: {outcome_text(trace)}"


def outcome_text(trace: Trace) -> str:
    """The length of a run, and whether it reached its target or why not."""
    start = f"{number(float(trace.time_s[-1]), 2)} s"
    if trace.outcome is None:
        return start
    if not trace.outcome.reached:
        return f"{start}, NOT reached: {trace.outcome.reason}"
    miss = abs(trace.outcome.largest_miss_K)
    miss_text = "everywhere within 1 mK" if miss < 1e-3 else f"largest miss {number(miss, 3)} K"
    slowest = trace.outcome.slowest_step_s
    steps = "" if slowest is None else f", slowest step {number(slowest, 2)} s"
    return f"{start}, reached ({miss_text}{steps})"


def _current(trace: Trace) -> str:
    if not trace.has_current:
        return "none: the thermode controls its temperature itself"
    return span(float(trace.current_A.min()), float(trace.current_A.max()), "A", 2)


def describe(trace: Trace) -> str:
    """Summarise a run: outcome, drive, extremes and changes at the receptors."""
    peaks = []
    for name, column in (("cold receptor", trace.cold_receptor_C), ("warm receptor", trace.warm_receptor_C)):
        change = column - column[0]
        low, high = float(change.min()), float(change.max())
        peaks.append(f"{name} {span(low, high, 'K', 2)}")
    lines = [
        headline(trace),
        f"  current   {_current(trace)}",
        f"  display   {span(float(trace.display_C.min()), float(trace.display_C.max()), '°C')}",
        f"  skin      {span(float(trace.skin_C.min()), float(trace.skin_C.max()), '°C')}",
        f"  change    {'; '.join(peaks)}",
    ]
    return "\n".join(lines)


def session_report(session: Session) -> list[Block]:
    """Report the verdict, a summary of the session, and one row per play."""
    columns = ("play", "icon", "start", "skin", "display", "baseline", "safety")
    rows = [
        (
            str(place),
            play.icon,
            f"{number(play.start_s, 2)} s",
            span(play.skin_min_C, play.skin_max_C, "°C"),
            span(play.display_min_C, play.display_max_C, "°C"),
            f"{number(play.drift_K, 2)} K",
            play.verdict,
        )
        for place, play in enumerate(session.plays[:MOST_SHOWN], 1)
    ]
    more = len(session.plays) - MOST_SHOWN
    return [
        Text("\n".join(summary_lines(session))),
        grid(columns, rows, ("play", "start", "baseline"), ("icon",)),
        *([Text(f"and {more} more plays; -o OUT.json lists all")] if more > 0 else []),
    ]


def summary_lines(session: Session) -> list[str]:
    """The summary of a session, line by line."""
    trace, plan = session.trace, session.plan
    plays = "1 play" if len(session.plays) == 1 else f"{len(session.plays)} plays"
    shuffled = "" if plan.seed is None else f", shuffled with seed {plan.seed}"
    lines = [
        f"{plays} in {number(session.duration_s, 2)} s on {trace.rig_name}, "
        f"{number(plan.gap_s, 2)} s between plays{shuffled}",
        f"safety {session.verdict} in {session.scenarios} scenarios, during the whole session and after it",
        *(f"  - {'NOT SAFE: ' if finding.severity == 'hard' else ''}{finding}" for finding in session.findings),
    ]
    for words, column in (("skin", trace.skin_C), ("display", trace.display_C), ("hot plate", trace.hot_plate_C)):
        lines.append(f"  {words:<10} {span(float(column.min()), float(column.max()), '°C')}")
    after = "more than 10 min" if session.recovery_s is None else f"{number(session.recovery_s)} s"
    lines += [
        *_dose_lines(session),
        f"  baseline   {number(session.baseline_drift_K, 2)} K at most; within 0.1 K again {after} after the end",
        f"  energy     {number(session.energy_J)} J into the module",
    ]
    return lines


def _dose_lines(session: Session) -> list[str]:
    """Thermal dose on the given rig and in the worst case, with the limits of a session."""
    lines = []
    for words, kind, value, unit in (
        ("dose", "thermal dose", session.dose_cem43_min, " min CEM43"),
        ("Henriques", "Henriques integral", session.henriques, ""),
    ):
        worst = session.worst(kind)
        if worst is not None:
            limit = f"{worst.value:.2g} in the worst case; the limit of a session is {worst.limit:g}"
            lines.append(f"  {words:<10} {value:.2g}{unit}, {limit}")
    return lines


def sweep_lines(frame: pd.DataFrame, names: Sequence[str], key: str) -> Iterator[str]:
    """At how many values each icon was reached, where people are best and worst, and a first reason for none."""
    from thermicon.perception.ranking.swept import ALL

    def setting(row: pd.Series[Any]) -> str:
        return f"{key} = {_value(row[key])}"

    for name in names:
        rows = frame[frame["icon"] == name]
        ran = rows[rows["duration_s"].notna()]
        judged = ran[ran["reached"].notna()]
        parts = [f"played at {len(ran)} of {len(rows)} values"]
        if len(judged):
            miss = judged["largest_miss_K"].abs()
            said = f"largest miss {span(float(miss.min()), float(miss.max()), 'K', 3)}"
            parts = [f"reached at {int(judged['reached'].sum())} of {len(rows)} values"]
            parts.append("everywhere within 1 mK" if miss.max() < 1e-3 else said)
        parts += [f"NOT SAFE at {unsafe}"] if (unsafe := int((~ran["safe"]).sum())) else []
        missing = len(rows) - len(ran)
        parts += [f"{missing} of {len(rows)} values {'is' if missing == 1 else 'are'} not possible"] * (missing > 0)
        yield f"{name}: {', '.join(parts)}"
    for column in ("felt_and_named", "felt_and_named_95", "named", "named_95"):
        words = column.removesuffix("_95").replace("_", " ") + " for 95 % of people" * column.endswith("_95")
        if column in frame and (rows := frame[(frame["icon"] == ALL) & frame[column].notna()]).size:
            ordered = rows.sort_values(column, kind="stable")
            ends = [ordered.iloc[place] for place in (0, -1)]
            low, high = (f"{percent(row[column])} {words} at {setting(row)}" for row in ends)
            yield f"{ALL}: from {low} to {high}"
    lost = frame[frame["duration_s"].isna() & frame["reason"].notna()]
    for _, row in lost[:1].iterrows():
        yield f"impossible, as at {setting(row)}: {row['reason']}"


def sweep_report(frame: pd.DataFrame, key: str, quantities: Sequence[str]) -> list[Grid]:
    """Report one row per icon and value: each quantity with its 95 % interval for a new laboratory, where it has one.

    Without quantities of perception, rows say what the rig does.

    >>> import pandas as pd
    >>> row = {"icon": "dip", "contact.area_cm2": 4.0, "named": 0.82, "named_low": 0.7, "named_high": 0.91}
    >>> [cell.text for cell in sweep_report(pd.DataFrame([row]), "contact.area_cm2", ["named"])[0].rows[0]]
    ['dip', '4', '82 % (70–91)']
    """
    from thermicon.perception.ranking.swept import ALL, OF_THE_SET

    if not quantities:
        played = [(str(row["icon"]), _value(row[key]), *_played(row)) for row in frame.to_dict("records")]
        columns: tuple[str, ...] = ("icon", key, "miss, K", "skin, °C", "safety")
        return [grid(columns, played, (key, "miss, K"), columns)]
    of_icons = not {*quantities} <= {*OF_THE_SET}
    rows = []
    for row in frame.to_dict("records"):
        cells = [_cell(row, quantity) for quantity in quantities]
        if {*cells} != {"–"} if row["icon"] == ALL else of_icons:
            rows.append((str(row["icon"]), _value(row[key]), *cells))
    columns = ("icon", key, *quantities)
    return [grid(columns, rows, (key,), columns)]


def _value(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def _played(row: Mapping[Any, Any]) -> tuple[str, str, str]:
    """The largest miss in K and the skin in °C of a run, and whether it is safe; dashes where there is none."""
    import pandas as pd

    if pd.isna(row["duration_s"]):
        return ("–", "–", "not possible")
    miss = "–" if pd.isna(row["largest_miss_K"]) else number(abs(row["largest_miss_K"]), 3)
    return (miss, span(row["skin_min_C"], row["skin_max_C"], "").strip(), str(row["safety"]))


def _cell(row: Mapping[Any, Any], quantity: str) -> str:
    from thermicon.perception.ranking.swept import MEASURES

    factor, digits, unit = PRINTED[quantity]
    value, *interval = (float(row.get(name, math.nan)) * factor for name in MEASURES[quantity])
    if math.isnan(value):
        return "–"
    known = interval and not any(map(math.isnan, interval))
    return f"{value:{digits}}{unit}" + (f" ({interval[0]:{digits}}–{interval[1]:{digits}})" if known else "")


@dataclass(frozen=True, slots=True)
class Comparison:
    """One pair of curves with a title, the outcomes of A and B, and a closing sentence."""

    title: str
    both: Aligned
    outcomes: tuple[str, str] = ("", "")
    after: str = ""


def compare_report(made: Comparison) -> list[Block]:
    """Report one table of differences with the meaning of A and B and the times of the comparison."""
    both, numbers = made.both, ("largest", "at", "rms", "mean")
    rows = []
    for _, row in differences(both).iterrows():
        written = [with_unit(float(row[name]), row["unit"]) for name in ("largest", "rms", "mean")]
        rows.append((quantity(row["column"]), written[0], f"{row['largest_s']:.2f} s", *written[1:]))
    sides = zip("AB", (both.name_a, both.name_b), made.outcomes, strict=True)
    heads = [f"{letter}  {name}{f': {outcome}' if outcome else ''}" for letter, name, outcome in sides]
    title = [made.title] if made.title else []
    return [
        Text("\n".join([*title, *heads])),
        grid(("B − A", *numbers), rows, numbers),
        Text(both.said),
        Text(made.after),
    ]
