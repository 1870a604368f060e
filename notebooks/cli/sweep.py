"""``thermicon sweep``: the numbers of a run at each value of one key of the rig."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from thermicon.base.checks.arguments import InputError, checked
from thermicon.perception.ranking.swept import AGE, ALL, MEASURES, OF_95, SITE

from ..files.outputs import TRACE_SUFFIXES, check_output, check_separate
from ..messages import Progress, fail, note, progress_bar, usage
from ..report.following import after_sweep
from ..report.run_report import sweep_lines, sweep_report
from ..report.terminal import show
from .options import (
    MOST_DRAWS,
    FigureOptions,
    FileName,
    IconName,
    People,
    RigOptions,
    Seed,
    Table,
    Tail,
    command_text,
    opt,
    pick,
    read_set,
    write_frame,
)

if TYPE_CHECKING:
    import pandas as pd

    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Icon, IconSet

MOST_VALUES, MOST_CURVED, MOST_NARROW = 10_000, 6, 2
"""Values of a sweep, icons whose curves its figure draws, and icons up to which one for a column has curves."""
FORM = (
    "give KEY=LOW:HIGH:N, for example contact.area_cm2=4:16:7, LOW:HIGH:Nlog for equal ratios, or values such as "
    "site=thenar,fingertip"
)
RECEPTORS = tuple(
    f"{channel}_receptor_{what}"
    for channel in ("cold", "warm")
    for what in ("peak_change_K", "attack_K_per_s", "delay_s")
)
"""Columns for what the receptors see: largest change, steepest rate towards it, lag of its half behind the skin's."""


@dataclass(frozen=True, slots=True)
class Measured:
    """Perception in a sweep: quantities by name, people, draws for intervals (0: none), and seed."""

    icons: IconSet
    what: tuple[str, ...]
    people: int = 60
    intervals: int = 64
    seed: int = 0


@checked
def sweep(
    icons: IconSet | Icon | Iterable[Icon] | str | Path,
    rig: Rig | str | Path | None,
    key: str,
    values: Sequence[float | str],
    *,
    tail_s: float = 0.0,
    measured: Measured | None = None,
    progress: Progress | None = None,
) -> pd.DataFrame:
    """Play every icon at every value of a key of the rig.

    Parameters
    ----------
    icons
        Icons to play, or the name or file of a set; those that `measured` measures must be among its set.
    rig
        Rig to change, or its name or file; None: the usual one for the icons.
    key
        Dotted key of the rig file, `site` or `people.age_years`.
    values
        Its values, in the unit of the rig file; names of shipped rigs for `site`.
    tail_s
        Time in s that is simulated after the last corner.
    measured
        What people perceive is predicted too, and how; None: only the rig is simulated.
    progress
        Called with the number of runs done and their total.

    Returns
    -------
    pandas.DataFrame
        One row per icon and value. Columns: icon, the key, the fields of
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

    from thermicon.circuit import Rig
    from thermicon.circuit.safety.verdict import Summary
    from thermicon.icons.files.shipped import icons_of
    from thermicon.perception.ranking.swept import check_conditions

    played = icons_of(icons)
    rig = Rig.of(rig, played[0].context.site if played else None)
    for value in values if key in (SITE, AGE) else values[:1]:
        check_conditions({key: value}, rig)
    if key == AGE and measured is None:
        raise ValueError(f"{AGE} changes what people perceive only; say what to measure, such as felt_and_named")
    rows: list[dict[str, Any]] = []
    for value in values:
        runs = [{"icon": icon.name, key: value, **_run(icon, rig, {key: value}, tail_s)} for icon in played]
        rows += runs if measured is None else _with_people(runs, rig, {key: value}, measured)
        if progress is not None:
            progress(len(rows), (len(played) + (measured is not None)) * len(values))
    summary = [field.name for field in fields(Summary) if field.name != "reason"]
    perceived = [] if measured is None else [name for each in measured.what for name in MEASURES[each]]
    frame = pd.DataFrame(rows, columns=["icon", key, *perceived, *summary, *RECEPTORS, "reason"])
    words = dict.fromkeys(("icon", "safety", "reason", SITE), "string") | {"reached": "boolean", "safe": "boolean"}
    kinds: dict[str, Any] = {name: words.get(name, "float64") for name in frame.columns}
    order = {name: place for place, name in enumerate([*(icon.name for icon in played), ALL])}
    return frame.astype(kinds).sort_values("icon", key=lambda names: names.map(order), kind="stable", ignore_index=True)


def _run(icon: Icon, rig: Rig, change: Mapping[str, float | str], tail_s: float) -> dict[str, Any]:
    from thermicon.circuit.safety.verdict import summarise

    trace = _trace(icon, rig, change, tail_s)
    return {"reason": trace} if isinstance(trace, str) else {**summarise(trace).to_dict(), **_receptors(trace)}


def _trace(icon: Icon, rig: Rig, change: Mapping[str, float | str], tail_s: float) -> Trace | str:
    """The run under a change, or the reason for none."""
    import numpy

    from thermicon.circuit import InputError, simulate
    from thermicon.perception.ranking.swept import rig_under

    try:
        with numpy.errstate(all="ignore"):  # what overflows ends as a reason
            return simulate(icon, rig_under(rig, change), tail_s=tail_s)
    except (InputError, ValueError, ArithmeticError) as problem:
        return "; ".join(str(problem).splitlines())


def swept_curves(
    icons: Sequence[Icon], rig: Rig, key: str, values: Sequence[float | str], tail_s: float
) -> dict[str, dict[float | str, Trace]]:
    """The traces of icons at values evenly apart, by icon and value; what cannot be played is left out."""
    from thermicon.icons.pictures.draw import MOST_DRAWN, evenly

    drawn = [values[place] for place in evenly(len(values), MOST_DRAWN)] if key != AGE else []
    curves = {}
    for icon in icons:
        runs = {value: _trace(icon, rig, {key: value}, tail_s) for value in drawn}
        if traces := {value: run for value, run in runs.items() if not isinstance(run, str)}:
            curves[icon.name] = traces
    return curves


def _with_people(
    runs: Sequence[dict[str, Any]], rig: Rig, change: Mapping[str, float | str], measured: Measured
) -> list[dict[str, Any]]:
    """The rows of one value with what people perceive, and a row of the whole set."""
    from thermicon.circuit import InputError
    from thermicon.perception.ranking.swept import measured_rows

    try:
        found = measured_rows(
            measured.icons, rig, change, measured.what,
            people=measured.people, parameters=measured.intervals, seed=measured.seed,
        )  # fmt: skip
    except (InputError, ValueError, ArithmeticError) as problem:
        return [*runs, {"icon": ALL, **change, "reason": "; ".join(str(problem).splitlines())}]
    return [*({**run, **found[run["icon"]]} for run in runs), {"icon": ALL, **change, **found[ALL]}]


def _receptors(trace: Trace) -> dict[str, float | None]:
    from thermicon.perception.observer.observer import CHANNELS
    from thermicon.perception.sensation.features import attack_K_per_s, delay_s, peak_change_K

    seen = [what(trace, channel) for channel in CHANNELS for what in (peak_change_K, attack_K_per_s, delay_s)]
    return dict(zip(RECEPTORS, seen, strict=True))


def sweep_command(
    file: FileName,
    vary: Annotated[
        list[str],
        opt(
            "KEY=LOW:HIGH:N",
            "A key of the rig, or people.age_years, and N values from LOW to HIGH, Nlog for equal ratios; or "
            "values with commas, such as site=thenar,fingertip.",
        ),
    ],
    rig: RigOptions,
    figure: FigureOptions,
    output: Table = None,
    icon: IconName = None,
    measure: Annotated[
        str | None,
        opt(
            "NAME,NAME",
            "Also predict what people perceive: felt-and-named, named, both also with _95 (what 95 % of people reach), "
            "detected, onset, d_prime, bits.",
        ),
    ] = None,
    people: People = 60,
    intervals: Annotated[int, opt("N", "Draws of the posterior for intervals; 0 for none.", 0, MOST_DRAWS)] = 64,
    seed: Seed = 0,
    tail: Tail = 0.0,
) -> None:
    """Vary a key of the rig and write, for every icon, misses, extremes, receptor changes and safety.

    Without -o a short table is printed. Values are in the unit that the key ends with.

    With --measure every value is ranked as by rank, for --people and with --intervals, and a last row of each is that
    of the whole set; intervals are those of a new laboratory, 95 %.
    """
    if len(vary) > 1:
        raise usage("one key is varied at a time; for another one, give a second sweep, with --set", "--vary")
    key, values = read_vary(vary[0])
    what = () if measure is None else read_measures(measure, intervals or 0)
    if not what and key == AGE:
        raise usage(f"{AGE} changes what people perceive only; add --measure felt-and-named", "--vary")
    if output is not None:
        check_output(output, TRACE_SUFFIXES, "a sweep")
    check_separate([file], [output, figure.figure])
    icons = pick(whole := read_set([file]), icon)
    where = rig.load(whole, file, told=True)
    measured = Measured(whole, what, people, intervals or 0, seed) if what else None
    from ..figures.sweep_figure import sweep_figure

    with progress_bar("sweep") as progress:
        frame = sweep(icons, where, key, values, tail_s=tail, measured=measured, progress=progress)
    if frame["duration_s"].isna().all():
        reason = frame["reason"].iloc[0]
        fail(f"--vary {key}: none of the {len(values)} values can be played; the first: {reason}")
    for line in (*outside_lines(key, values, whole, where), *sweep_lines(frame, [each.name for each in icons], key)):
        note(line)
    drawn = [] if figure.look.narrow and len(icons) > MOST_NARROW else icons[:MOST_CURVED]
    if len(drawn) < len(icons) and figure.figure is not None:
        note(f"note: the figure has the curves of {len(drawn)} of {len(icons)} icons; --icon chooses one")
    figure.write(lambda: sweep_figure(frame, figure.look, swept_curves(drawn, where, key, values, tail)))
    if output is not None:
        write_frame(frame, output)
    else:
        rank = command_text([file], rig, paths=True)
        following = after_sweep(frame, key, what[0], rank) if what else rank
        show([*sweep_report(frame, key, what), f"Next: {following}"])


def outside_lines(key: str, values: Sequence[float | str], icons: IconSet, rig: Rig) -> list[str]:
    """One line where values of a key are such as no experiment had, with the first of them."""
    from thermicon.perception.ranking.swept import rig_under
    from thermicon.perception.sensation.coverage import outside_age, outside_setting

    beyond: list[str] = []
    for value in values:
        if key == AGE:
            beyond += outside_age(float(value))
            continue
        with suppress(InputError):  # a rig that cannot be is a row with its reason
            beyond += outside_setting(icons.context.baseline_C, rig_under(rig, {key: value}))
    if not beyond:
        return []
    return [f"outside the data: {len(beyond)} of {len(values)} values of {key}; the first: {beyond[0]}"]


def read_measures(text: str, intervals: int) -> tuple[str, ...]:
    """Read ``--measure``, beside the draws for intervals; what cannot be is a usage error."""
    from thermicon.perception.selection.goal import other_word, quantity_of, word_of

    if (offer := other_word(text)) is not None:
        note(offer)
    names = tuple(quantity_of(name.strip()) for name in text.split(","))
    for name in names:
        if name not in MEASURES:
            raise usage(f"{name!r} is not one of {', '.join(map(word_of, MEASURES))}", "--measure")
    if len(set(names)) < len(names):
        raise usage(f"{text!r}: the same quantity is given twice", "--measure")
    if intervals == 1:
        raise usage("1 draw has no interval; give 2 or more, or 0 for none", "--intervals")
    if intervals == 0 and (reached := [name for name in names if name in OF_95]):
        raise usage(f"{reached[0]} is about people and model together, and needs 2 draws or more", "--intervals")
    return names


def read_vary(text: str) -> tuple[str, tuple[float | str, ...]]:
    """Read ``--vary``: a key and its values; another form is a usage error.

    >>> read_vary("contact.area_cm2=4:9:3"), read_vary("contact.resistance_m2K_per_W=1e-4:1e-2:3log")[1]
    (('contact.area_cm2', (4.0, 6.5, 9.0)), (0.0001, 0.001, 0.01))
    """

    def no(why: str) -> typer.BadParameter:
        return usage(f"{text!r}: {why}", "--vary")

    def read(word: str) -> float:
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise no(f"{word!r} is not a number; {FORM}")
        return value

    key, _, rest = (part.strip() for part in text.partition("="))
    listed = ":" not in rest and "," in rest
    parts = [part.strip() for part in rest.split("," if listed else ":")]
    if not key or not all(parts) or not (listed or len(parts) == 3):
        raise no(FORM)
    if listed:
        values = tuple(parts) if key == SITE else tuple(map(read, parts))
        if len(set(values)) < len(values):
            raise no("the same value is given twice")
        return key, values
    if key == SITE:
        raise no("sites are names; give them as site=thenar,fingertip")
    low, high, log, number = read(parts[0]), read(parts[1]), parts[2].endswith("log"), parts[2].removesuffix("log")
    if not number.isdecimal():
        raise no(f"{parts[2]!r} is not a number of values; {FORM}")
    if not 2 <= int(number) <= MOST_VALUES:
        raise no(f"{number} {'value is' if int(number) == 1 else 'values are'} outside 2 to {MOST_VALUES}")
    if low == high:
        raise no(f"both ends are {low:g}; a sweep needs two different ends")
    if log and not (low > 0 and high > 0):
        raise no("equal ratios need both ends above 0; leave out log for equal steps")
    shares = [k / (int(number) - 1) for k in range(int(number))]
    values = tuple(low * (high / low) ** share if log else low + (high - low) * share for share in shares)
    return key, tuple(float(f"{value:.12g}") for value in values)
