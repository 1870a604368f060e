"""``thermicon compare``: two rigs, icons, sets, or a trace and a log, as one table of differences and one figure."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermicon.icons.number_text import number, percent

from ..figures.differences import Aligned, align, differences, quantity, with_unit
from ..files.outputs import check_separate
from ..files.trace_files import Curves, LogError, curves_of, read_curves
from ..messages import DEFAULT_RIG, load_rig, note, usage
from ..report.compare_inputs import Request, check_request, kind_of_both
from ..report.set_matrix import FEWEST, show_matrix
from ..report.tables import show, table
from .cues import pick, read_set
from .options import FigureOptions, IconName, RigOptions
from .simulate import headline

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Icon, IconSet
    from thermicon.perception.selection.robust import SetComparison

DEFAULT_SET, DEFAULT_ICON = "six-icons", "cooling-step"
MOST_IN_A_SET = 30
"""Larger sets are compared icon by icon alone; `thermicon.perception.selection.robust.compare_sets` takes them."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """One pair of curves with a title, the outcomes of A and B, and a closing sentence."""

    title: str
    both: Aligned
    outcomes: tuple[str, str] = ("", "")
    after: str = ""


def compare_command(
    first: Annotated[str, typer.Argument(metavar="A", help="A rig, FILE:ICON, a set, a trace or a log.")],
    second: Annotated[str, typer.Argument(metavar="B", help="A second one of the same kind.")],
    rig: RigOptions,
    figure: FigureOptions,
    file: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="For two rigs: the icons to play.  [default: one icon of six-icons]"),
    ] = None,
    icon: IconName = None,
    align: Annotated[
        bool, typer.Option("--align", help="For a trace and a log: shift B in time to where it is most like A.")
    ] = False,
    rigs: Annotated[
        str | None, typer.Option(metavar="R,R", help="For two sets: score both on each of these rigs, as a table.")
    ] = None,
) -> None:
    """Compare two rigs, icons, sets, or a trace with a measured log, as a table of differences B minus A.

    Rigs are names or .toml files, icons are FILE:ICON, sets are .cue files or shipped names, traces and logs are
    .csv or .parquet files with time_s and columns of a trace. Two sets without a common name of an icon are compared by
    what is predicted for them.
    """
    several = tuple(name.strip() for name in (rigs or "").split(",") if name.strip())
    request = Request(file, icon, rig.rig, tuple(rig.changes), align, several)
    kind = kind_of_both(first, second)
    check_request(kind, request)
    if kind == "set" and (request.rigs or (request.icon is None and not _common(first, second))):
        _matrix(first, second, request, figure.figure)
        return
    check_separate([first, second], [figure.figure])
    made = {"rig": _rigs, "icon": _icons, "set": _sets, "table": _tables}[kind](first, second, request)
    if figure.figure is not None:
        from ..figures.compare_figure import compare_figure

        pairs = [(each.title, each.both) for each in made]
        figure.write(compare_figure(pairs, across=figure.look.across(3)))
    for place, each in enumerate(made):
        if place:
            show("")
        show_comparison(each)


def show_comparison(made: Comparison) -> None:
    """Print one table of differences with the meaning of A and B and the times of the comparison."""
    both = made.both
    rows = table("B − A", "largest", "at", "rms", "mean", numbers=("largest", "at", "rms", "mean"))
    for _, row in differences(both).iterrows():
        written = [with_unit(float(row[name]), row["unit"]) for name in ("largest", "rms", "mean")]
        rows.add_row(quantity(row["column"]), written[0], f"{row['largest_s']:.2f} s", *written[1:])
    sides = zip("AB", (both.name_a, both.name_b), made.outcomes, strict=True)
    heads = [f"{letter}  {name}{f': {outcome}' if outcome else ''}" for letter, name, outcome in sides]
    after = ["", made.after] if made.after else []
    show(*([made.title] if made.title else []), *heads, "", rows, "", both.said, *after)


def _rigs(first: str, second: str, request: Request) -> list[Comparison]:
    file = request.file or DEFAULT_SET
    icons = pick(read_set([file]), request.icon or (DEFAULT_ICON if request.file is None else None))
    rigs = [load_rig(name, request.changes) for name in (first, second)]
    return [_played(icon.name, (icon, icon), (rigs[0], rigs[1]), (first, second)) for icon in icons]


def _icons(first: str, second: str, request: Request) -> list[Comparison]:
    rig, icons = load_rig(request.rig, request.changes), []
    for option, text in (("A", first), ("B", second)):
        file, _, name = text.rpartition(":")
        if not name:
            raise usage(f"{text} ends with a colon; put the name of an icon behind it", option)
        icons.append(pick(read_set([file]), name)[0])
    return [_played("", (icons[0], icons[1]), (rig, rig), (first, second))]


def _common(first: str, second: str) -> list[str]:
    """Names of icons that both sets have, in the order of the first."""
    names = [[icon.name for icon in read_set([name])] for name in (first, second)]
    known = set(names[1])
    return [name for name in names[0] if name in known]


def _matrix(first: str, second: str, request: Request, figure: Path | None) -> None:
    """Print scores of both sets, on each rig; for sets whose icons have other names, and for several rigs."""
    if figure is not None:
        raise usage("curves are compared of icons with the same name on one rig: leave it out", "--figure")
    if request.rigs and request.rig is not None:
        raise usage("the rigs are those of --rigs", "--rig")
    sets = dict(zip(_short((first, second)), (read_set([first]), read_set([second])), strict=True))
    for name, icons in sets.items():
        if not FEWEST <= len(icons) <= MOST_IN_A_SET:
            raise LogError(f"{name}: sets of {FEWEST} to {MOST_IN_A_SET} icons are compared, this one has {len(icons)}")
    names = request.rigs or (request.rig or DEFAULT_RIG,)
    show_matrix(sets, {Path(name).name: load_rig(name, request.changes) for name in names})
    if len(names) == 1:
        one, other = sets.values()
        sentence = compare_identification(one, other, load_rig(names[0], request.changes))
        if sentence:
            show("", f"A {next(iter(sets))}, B {list(sets)[1]}", sentence)


def _sets(first: str, second: str, request: Request) -> list[Comparison]:
    sets = [read_set([name]) for name in (first, second)]
    names = [[icon.name for icon in icons] for icons in sets]
    known = set(names[1])
    common = [name for name in names[0] if name in known]
    if request.icon is not None:
        common = [pick(icons, request.icon)[0].name for icons in sets][:1]
    alone = [f"{name} ({file})" for k, file in enumerate((first, second)) for name in names[k] if name not in common]
    if alone and request.icon is None:
        note(f"only in one of the two sets: {', '.join(alone)}")
    rig = load_rig(request.rig, request.changes)
    pairs = [(pick(sets[0], name)[0], pick(sets[1], name)[0]) for name in common]
    made = [_played(pair[0].name, pair, (rig, rig), (first, second)) for pair in pairs]
    sentence = compare_identification(sets[0], sets[1], rig) if request.icon is None else None
    return [*made[:-1], replace(made[-1], after=sentence or "")]


def _played(title: str, icons: tuple[Icon, Icon], rigs: tuple[Rig, Rig], names: tuple[str, str]) -> Comparison:
    """Play two icons, the shorter with a tail at its baseline so that both are equally long, and compare."""
    traces = _equally_long(icons, rigs)
    outcomes = (headline(traces[0]).partition(": ")[2], headline(traces[1]).partition(": ")[2])
    curves = [curves_of(trace, name) for trace, name in zip(traces, _short(names), strict=True)]
    return Comparison(title, align(curves[0], curves[1]), outcomes)


def _short(names: tuple[str, str]) -> tuple[str, str]:
    """Return the names without their folders, unless the folders are what they differ in."""
    first, second = (Path(name).name for name in names)
    return names if first == second else (first, second)


def _equally_long(icons: tuple[Icon, Icon], rigs: tuple[Rig, Rig]) -> list[Trace]:
    from thermicon.circuit import simulate

    traces = [simulate(icon, rig) for icon, rig in zip(icons, rigs, strict=True)]
    ends = [float(trace.time_s[-1]) for trace in traces]
    for k in (0, 1):
        if ends[k] < max(ends):
            traces[k] = simulate(icons[k], rigs[k], tail_s=max(ends) - ends[k])
    return traces


def _tables(first: str, second: str, request: Request) -> list[Comparison]:
    read: list[Curves] = [read_curves(path, request.icon) for path in (first, second)]
    for curves in read:
        if curves.ignored:
            note(f"{curves.name}: ignored columns that no trace has: {', '.join(curves.ignored)}")
    if not request.align:
        return [Comparison("", align(read[0], read[1]))]
    shifted, sentence = _shifted(read[0], read[1])
    return [Comparison("", align(read[0], shifted), after=sentence)]


def _shifted(first: Curves, second: Curves) -> tuple[Curves, str]:
    """Return B on the clock of A, by cross-correlation of the first column that both have, and a sentence on it."""
    from thermicon.circuit.fitting.overlay import SHIFTED_BY, best_shift_s

    common = [name for name in (*SHIFTED_BY, *first.columns) if name in first.columns and name in second.columns]
    if not common:
        raise LogError(f"no column in both {first.name} and {second.name} to align them by")
    by = common[0]
    shift, alike = best_shift_s(first.time_s, first.columns[by], second.time_s, second.columns[by])
    if alike <= 0:
        raise LogError(f"{second.name}: no shift makes its {by} like that of {first.name}; leave out --align")
    sentence = f"B was shifted by {number(shift, 3)} s, by the correlation of {quantity(by)} ({number(alike, 3)})"
    return replace(second, time_s=second.time_s + shift), sentence


def compare_identification(first: IconSet, second: IconSet, rig: Rig) -> str | None:
    """Return one sentence on which set is identified better; None if one has a single icon or very many."""
    from thermicon.perception.selection.robust import compare_sets

    if any(not 2 <= len(icons) <= MOST_IN_A_SET for icons in (first, second)):
        return None
    return comparison_line(compare_sets(first, second, rig))


def comparison_line(found: SetComparison) -> str:
    """Report how often A is identified better than B, and by how much.

    >>> from thermicon.perception.selection.robust import SetComparison
    >>> comparison_line(SetComparison(0.93, 0.02, 0.41, 100))
    'predicted: the icons of A are easier to distinguish than those of B in 93 % of 100 draws of person, contact, room \
and rig; the d′ of its worst pair is larger by 0.4 (median)'
    """
    share, better = (found.probability, "A") if found.probability >= 0.5 else (1.0 - found.probability, "B")
    other = "B" if better == "A" else "A"
    drawn = f"{found.draws} draws of person, contact, room and rig"
    if share < 0.5 + 2.0 * found.standard_error:
        return f"predicted: no difference between A and B in how well their icons are distinguished, within {drawn}"
    gain = abs(found.gain)
    return (
        f"predicted: the icons of {better} are easier to distinguish than those of {other} in {percent(share)} of "
        f"{drawn}; "
        f"the d′ of its worst pair is larger by {number(gain)} (median)"
    )
