"""``thermicon sweep``: one or two keys of the rig over a range, and every number of a run at each value."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermicon.icons.atomic import complete_or_absent
from thermicon.icons.number_text import percent, span

from ..files.outputs import STDOUT, TRACE_SUFFIXES, check_output, check_separate
from ..messages import Progress, fail, note, progress_bar, usage
from ..report.sweep_report import sweep_report
from ..report.terminal import show
from .cues import pick, read_set, warn_of_site
from .options import FigureOptions, FileName, IconName, Intervals, People, RigOptions, Seed, Table, Tail, write_text

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Icon, IconSet

    from ..figures.style import Look
    from ..report.varied import Vary


@dataclass(frozen=True, slots=True)
class Measured:
    """What people perceive of a set: quantities by name, people, draws for intervals (0: none), and seed."""

    icons: IconSet
    what: tuple[str, ...]
    people: int = 60
    intervals: int = 64
    seed: int = 0


def sweep(
    icons: Iterable[Icon],
    rig: Rig,
    key: str,
    values: Sequence[float | str],
    *,
    second: tuple[str, Sequence[float | str]] | None = None,
    tail_s: float = 0.0,
    measured: Measured | None = None,
    progress: Progress | None = None,
) -> pd.DataFrame:
    """Play every icon at every value of a key of the rig.

    Parameters
    ----------
    icons
        Icons to play; those that `measured` measures must be among its set.
    rig
        Rig to change.
    key
        Dotted key of the rig file, `site` or `people.age_years`.
    values
        Its values, in the unit of the rig file; names of shipped rigs for `site`.
    second
        A second key and its values; every combination of both keys is played.
    tail_s
        Time in s that is simulated after the last corner.
    measured
        What people perceive is predicted too, and how; None: only the rig is simulated.
    progress
        Called with the number of runs done and their total.

    Returns
    -------
    pandas.DataFrame
        One row per icon and value (or combination). Columns: icon, the key or keys, the fields of
        `thermicon.circuit.safety.verdict.Summary`, what the receptors see, what is measured, and `reason`; with
        `measured` a last row of each value is that of the whole set. Where the rig is impossible or cannot play
        the icon, the row has only the reason.

    Raises
    ------
    InputError
        For a key that no rig has, a site that is not shipped, and an age outside 18 to 100 years.
    ValueError
        For an age where nothing is measured.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import load_library
    >>> step = load_library("six-icons")["cooling-step"]
    >>> frame = sweep([step], Rig.load("thenar"), "driver.current_limit_A", [0.5, 1.5])
    >>> frame["reached"].tolist()
    [False, True]
    """
    import pandas as pd

    from thermicon.circuit.safety.verdict import Summary
    from thermicon.perception.ranking.swept import AGE, ALL, MEASURES, SITE, check_conditions

    varied = [(key, values), *([second] if second is not None else [])]
    for name, numbers in varied:
        for value in numbers if name in (SITE, AGE) else numbers[:1]:
            check_conditions({name: value}, rig)
        if name == AGE and measured is None:
            raise ValueError(f"{AGE} changes what people perceive only; say what to measure, such as correct")
    keys = [name for name, _ in varied]
    combinations = list(itertools.product(*(numbers for _, numbers in varied)))
    played: list[Icon] = list(icons)
    rows: list[dict[str, Any]] = []
    for combination in combinations:
        changes: dict[str, float | str] = dict(zip(keys, combination, strict=True))
        rows += [{"icon": icon.name, **changes, **_run(icon, rig, changes, tail_s)} for icon in played]
        if measured is not None:
            _measure(rows, [icon.name for icon in played], rig, changes, measured)
        if progress is not None:
            progress(len(rows), (len(played) + (measured is not None)) * len(combinations))
    summary = [field.name for field in fields(Summary) if field.name != "reason"]
    perceived = [] if measured is None else [name for each in measured.what for name in MEASURES[each]]
    frame = pd.DataFrame(rows, columns=["icon", *keys, *perceived, *summary, *RECEPTORS, "reason"])
    words = dict.fromkeys(("icon", "safety", "reason", SITE), "string") | {"reached": "boolean", "safe": "boolean"}
    kinds: dict[str, Any] = {name: words.get(name, "float64") for name in frame.columns}
    order = {name: place for place, name in enumerate([*(icon.name for icon in played), ALL])}
    return frame.astype(kinds).sort_values("icon", key=lambda names: names.map(order), kind="stable", ignore_index=True)


RECEPTORS = tuple(
    f"{channel}_receptor_{what}"
    for channel in ("cold", "warm")
    for what in ("peak_change_K", "attack_K_per_s", "delay_s")
)
"""Columns for what the receptors see: largest change, steepest rate towards it, lag of its half behind the skin's."""


def _run(icon: Icon, rig: Rig, changes: Mapping[str, float | str], tail_s: float) -> dict[str, Any]:
    import numpy

    from thermicon.circuit import InputError, simulate
    from thermicon.circuit.safety.verdict import summarise
    from thermicon.perception.ranking.swept import rig_under

    try:
        with numpy.errstate(all="ignore"):  # what overflows ends as a reason
            trace = simulate(icon, rig_under(rig, changes), tail_s=tail_s)
    except (InputError, ValueError, ArithmeticError) as problem:
        return {"reason": "; ".join(str(problem).splitlines())}
    return {**summarise(trace).to_dict(), **_receptors(trace)}


def _measure(
    rows: list[dict[str, Any]], names: Sequence[str], rig: Rig, changes: Mapping[str, float | str], measured: Measured
) -> None:
    """Add what people perceive to the last rows, those of the icons, and a row of the whole set."""
    from thermicon.circuit import InputError
    from thermicon.perception.ranking.swept import ALL, measured_rows

    try:
        found = measured_rows(
            measured.icons, rig, changes, measured.what,
            people=measured.people, parameters=measured.intervals, seed=measured.seed,
        )  # fmt: skip
    except (InputError, ValueError, ArithmeticError) as problem:
        rows.append({"icon": ALL, **changes, "reason": "; ".join(str(problem).splitlines())})
        return
    for row in rows[-len(names) :]:
        row.update(found[row["icon"]])
    rows.append({"icon": ALL, **changes, **found[ALL]})


def _receptors(trace: Trace) -> dict[str, float | None]:
    from thermicon.perception.observer.observer import CHANNELS
    from thermicon.perception.sensation.features import attack_K_per_s, delay_s, peak_change_K

    seen = [(what(trace, channel)) for channel in CHANNELS for what in (peak_change_K, attack_K_per_s, delay_s)]
    return dict(zip(RECEPTORS, seen, strict=True))


def sweep_command(
    file: FileName,
    vary: Annotated[
        list[str],
        typer.Option(
            metavar="KEY=LOW:HIGH:N",
            help="A key of the rig, or people.age_years, and N values from LOW to HIGH, Nlog for equal ratios; or "
            "values with commas, such as site=thenar,fingertip. Give it twice for a grid.",
        ),
    ],
    rig: RigOptions,
    figure: FigureOptions,
    output: Table = None,
    icon: IconName = None,
    measure: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,NAME",
            help="Also predict what people perceive: correct, correct_95 (what 95 % of people reach), detected, onset, "
            "d_prime, bits.",
        ),
    ] = None,
    people: People = 60,
    intervals: Intervals = 64,
    seed: Seed = 0,
    tail: Tail = 0.0,
) -> None:
    """Vary one or two keys of the rig and write, for every icon, misses, extremes, receptor changes and safety.

    Two keys make a grid: every combination of their values is played, and the table has one row per icon and
    combination. Values are in the unit that the key ends with. With --measure every value is ranked as by rank, for
    --people and with --intervals, and a last row of each is that of the whole set; intervals are those of a new
    laboratory, 95 %.
    """
    from thermicon.perception.ranking.swept import AGE

    from ..report.varied import read_measures, read_varied

    varied = read_varied(vary)
    what = () if measure is None else read_measures(measure, intervals or 0)
    if not what and any(each.key == AGE for each in varied):
        raise usage(f"{AGE} changes what people perceive only; add --measure correct", "--vary")
    if output is None and figure.figure is None and not what:
        raise usage("give -o OUT for the table, --figure, or --measure to print what people perceive", "-o")
    if output is not None:
        check_output(output, TRACE_SUFFIXES, "a sweep")
    check_separate([file], [output, figure.figure])
    icons, where = pick(whole := read_set([file]), icon), rig.load()
    warn_of_site(file, whole, where)
    first, *others = varied
    with progress_bar("sweep") as progress:
        frame = sweep(
            icons,
            where,
            first.key,
            first.values,
            second=(others[0].key, others[0].values) if others else None,
            tail_s=tail,
            measured=Measured(whole, what, people, intervals or 0, seed) if what else None,
            progress=progress,
        )
    keys, points = [each.key for each in varied], "combinations" if others else "values"
    if frame["duration_s"].isna().all():
        count = math.prod(len(each.values) for each in varied)
        reason = frame["reason"].iloc[0]
        fail(f"--vary {' and '.join(keys)}: none of the {count} {points} can be played; the first: {reason}")
    for line in (
        *(headline(frame[frame["icon"] == each.name], points) for each in icons),
        *_measured_lines(frame, keys, what),
        *_impossible(frame, keys),
    ):
        note(line)
    if figure.figure is not None:
        figure.write(_figure(frame, varied, figure.look, what))
    if output is not None:
        write_frame(frame, output)
    elif what:
        show(sweep_report(frame, keys, what))


def _figure(frame: pd.DataFrame, varied: Sequence[Vary], look: Look, what: Sequence[str]) -> Figure:
    """Lines over one key, heat maps over two: of what is measured, else of what the rig does."""
    from thermicon.perception.ranking.swept import ALL, MEASURES

    columns = [MEASURES[name] for name in what]
    if len(varied) == 1 and columns:
        from ..figures.sweep_figure import measure_figure

        return measure_figure(frame, varied[0].key, columns, ALL, log=varied[0].log, across=look.across(2))
    if len(varied) == 1:
        from ..figures.sweep_figure import sweep_figure

        return sweep_figure(frame, varied[0].key, log=varied[0].log, across=look.across(3))
    from ..figures.sweep_figure import MOST_ROWS, sweep_map

    if (count := frame["icon"].nunique()) > MOST_ROWS:
        note(f"the figure shows the first {MOST_ROWS} of {count} icons; --icon NAME selects another one")
    if columns:
        from ..figures.sweep_figure import LABELS, SHADES

        maps = [(value, LABELS[value].replace(" (%)", ""), SHADES) for value, *_ in columns]
        return sweep_map(frame, varied[0].key, varied[1].key, maps)
    return sweep_map(frame, varied[0].key, varied[1].key)


def write_frame(frame: pd.DataFrame, output: Path) -> None:
    """Write a table as ``.parquet`` or ``.csv``, by its suffix, and say so; - prints it."""
    if output == STDOUT or output.suffix != ".parquet":
        write_text(frame.to_csv(index=False, float_format="%.9g", lineterminator="\n"), output)
        return
    with complete_or_absent(output) as draft:
        frame.to_parquet(draft, index=False)
    note(f"wrote {output}")


def headline(rows: pd.DataFrame, points: str = "values") -> str:
    """Report at how many points one icon was reached, and how large its misses are."""
    ran = rows[rows["duration_s"].notna()]
    judged = ran[ran["reached"].notna()]
    if len(judged):
        miss = judged["largest_miss_K"].abs()
        low, high = float(miss.min()), float(miss.max())
        miss_text = "everywhere within 1 mK" if high < 1e-3 else f"largest miss {span(low, high, 'K', 3)}"
        parts = [f"reached at {int(judged['reached'].sum())} of {len(rows)} {points}", miss_text]
    else:
        parts = [f"played at {len(ran)} of {len(rows)} {points}"]
    if unsafe := int((~ran["safe"]).sum()):
        parts.append(f"NOT SAFE at {unsafe}")
    if len(ran) < len(rows):
        parts.append(f"impossible at {len(rows) - len(ran)}")
    return f"{rows['icon'].iloc[0]}: {', '.join(parts)}"


def _measured_lines(frame: pd.DataFrame, keys: Sequence[str], what: Sequence[str]) -> list[str]:
    """Proportion correct of the set where it is lowest and highest, and so what 95 % of people reach, if measured."""
    from thermicon.perception.ranking.swept import ALL

    lines = []
    for column, words in (("correct", "correct"), ("correct_95", "correct for 95 % of people")):
        if column not in what:
            continue
        rows = frame[(frame["icon"] == ALL) & frame[column].notna()]
        if rows.empty:
            continue
        ordered = rows.sort_values(column, kind="stable")
        low, high = (
            f"{percent(row[column])} {words} at {', '.join(_setting(key, row[key]) for key in keys)}"
            for row in (ordered.iloc[0], ordered.iloc[-1])
        )
        lines.append(f"{ALL}: from {low} to {high}")
    return lines


def _setting(key: str, value: float | str) -> str:
    return f"{key} = {value if isinstance(value, str) else f'{value:g}'}"


def _impossible(frame: pd.DataFrame, keys: Sequence[str]) -> list[str]:
    """Return the first reason why a point could not be played, as a line; none where all could."""
    lost = frame[frame["duration_s"].isna() & frame["reason"].notna()]
    return [
        f"impossible, as at {', '.join(_setting(key, row[key]) for key in keys)}: {row['reason']}"
        for _, row in lost[:1].iterrows()
    ]
