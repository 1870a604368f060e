"""``thermicon compare``: the differences between two things of one kind."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermicon.base.files.table_text import TABLES
from thermicon.base.words.number_text import count_of, number
from thermicon.perception.criteria import MOST_ICONS

from ..figures.compare_figure import compare_figure
from ..files.outputs import check_separate
from ..files.trace_files import Curves, TraceFileError, align, curves_of, differences, quantity, read_curves
from ..loading import load_rig
from ..messages import note, progress_bar, usage
from ..report.run_report import Comparison, compare_report, outcome_text
from ..report.sets_report import sets_report
from ..report.terminal import show
from .options import FigureOptions, IconName, RigOptions, Theirs, flag, opt, pick, read_set, theirs_of

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Icon

    from ..report.blocks import Block

DEFAULT_SET, DEFAULT_ICON = "six-icons", "cooling-step"
NAMES = {"rig": "a rig", "icon": "an icon", "set": "an icon set", "table": "a trace or log"}
HOW = "a rig is a name or a .toml file, an icon FILE:ICON, a set a .cue file or a name, a trace or log .csv"

APPLIES = {
    "--file": (("rig",), "belongs to two rigs; two sets are A and B"),
    "--icon": (("rig", "set", "table"), "the two icons are A and B"),
    "--rig": (("icon", "set"), "the two rigs are A and B; traces and logs are compared as they are"),
    "--set": (("rig", "icon", "set"), "traces and logs are compared as they are"),
    "--column": (("table",), "belongs to tables"),
    "--align": (("table",), "belongs to a trace and a log, which have clocks of their own"),
}
"""The kinds that an option applies to, and what is said for others."""


def compare_command(
    first: Annotated[str, typer.Argument(metavar="A", help="A rig, FILE:ICON, a set, a trace or a log.")],
    second: Annotated[str, typer.Argument(metavar="B", help="A second one of the same kind.")],
    rig: RigOptions,
    figure: FigureOptions,
    file: Annotated[
        str | None, opt("FILE", "For two rigs: the icons to play.  [default: one icon of six-icons]")
    ] = None,
    icon: IconName = None,
    column: Theirs = None,
    align: Annotated[
        bool, flag("--align", "For a trace and a log: shift B in time to where it is most like A.")
    ] = False,
) -> None:
    """Compare two rigs, icons, sets, or a trace with a measured log, as a table of differences B minus A.

    Rigs are names or .toml files, icons are FILE:ICON, sets are .cue files or shipped names, traces and logs are
    tables with time_s and columns of a trace. Of two sets, the icons with the same name are compared; where no name is
    in both, how well people identify each set.
    """
    kind, both = kind_of_both(first, second), (first, second)
    given = (file, icon, rig.rig, rig.changes, column, align)
    for (option, (kinds, why)), value in zip(APPLIES.items(), given, strict=True):
        if value and kind not in kinds:
            raise usage(why, option)
    check_separate([first, second], [figure.figure])
    if kind == "rig":
        icons = pick(read_set([file or DEFAULT_SET]), icon or (DEFAULT_ICON if file is None else None))
        one, other = (load_rig(name, rig.changes, named=True) for name in both)
        compared = [_played(each.name, (each, each), (one, other), both) for each in icons]
    elif kind == "icon":
        one_icon, other_icon = _named(first, "A"), _named(second, "B")
        used = rig.load(one_icon, first)
        compared = [_played("", (one_icon, other_icon), (used, used), both)]
    elif kind == "set":
        compared = _sets(both, icon, rig)
        if not compared:
            if figure.figure is not None:
                raise usage("draws icons that both sets have, and these have none in common", "--figure")
            show(_as_wholes(both, rig))
            return
    else:
        compared = [_tables(both, icon, theirs_of(column), align)]
    figure.write(lambda: compare_figure([(each.title, each.both) for each in compared], figure.look.across(3)))
    if not any(differences(each.both)["largest"].any() for each in compared):
        typer.echo(f"{first} and {second} play alike: no difference in any curve")
        return
    show([block for each in compared for block in compare_report(each)])


def kind_of(text: str, option: str) -> str:
    """Return what an argument names, a rig, icon, set or table; a usage error if that is not clear."""
    from thermicon.circuit.rig.rig import rig_names
    from thermicon.icons.files.shipped import library_names

    suffix = Path(text).suffix.lower()
    file, colon, _ = text.rpartition(":")
    matches = {
        "rig": suffix == ".toml" or text in rig_names(),
        "set": suffix == ".cue" or text in library_names(),
        "table": suffix in TABLES,
        "icon": bool(colon) and (Path(file).suffix.lower() == ".cue" or file in library_names()),
    }
    kinds = [kind for kind, is_match in matches.items() if is_match]
    if len(kinds) == 1:
        return kinds[0]
    if kinds:
        both = " and ".join(NAMES[kind] for kind in kinds)
        raise usage(f"{text} is the name of {both}; give the one you mean as a file", option)
    if Path(text).exists():
        raise usage(f"{text}: its name does not show what it is; {HOW}", option)
    from thermicon.base.words.near_words import did_you_mean

    raise usage(f"{text} cannot be compared; {did_you_mean(text, (*rig_names(), *library_names()))} ({HOW})", option)


def kind_of_both(first: str, second: str) -> str:
    """Return the kind that both are; a usage error where they differ."""
    kinds = kind_of(first, "A"), kind_of(second, "B")
    if kinds[0] == kinds[1]:
        return kinds[0]
    raise usage(
        f"{first} is {NAMES[kinds[0]]} and {second} is {NAMES[kinds[1]]}; both must be of the same kind"
        f"{_cure(set(kinds))}",
        "B",
    )


def _cure(kinds: set[str]) -> str:
    if kinds == {"icon", "set"}:
        return ": write the one icon of the set as FILE:ICON"
    if "table" in kinds:
        return ": write a trace first with thermicon simulate FILE --icon NAME -o trace.csv"
    return f" ({HOW})"


def _named(text: str, option: str) -> Icon:
    """The icon that FILE:ICON names."""
    file, _, name = text.rpartition(":")
    if not name:
        raise usage(f"{text} ends with a colon; put the name of an icon behind it", option)
    return pick(read_set([file]), name)[0]


def _sets(names: tuple[str, str], icon: str | None, asked: RigOptions) -> list[Comparison]:
    """Compare the icons with the same name, or the one named; none where no name is in both."""
    sets = [read_set([name]) for name in names]
    one, other = ({each.name: each for each in pick(found, icon)} for found in sets)
    common = [name for name in one if name in other]
    alone = [f"{name} ({file})" for file, icons in zip(names, (one, other), strict=True) for name in icons
             if name not in common]  # fmt: skip
    if not common:
        return []
    if alone:
        note(f"only in one of the two sets: {', '.join(alone)}")
    rig = asked.load(sets[0], names[0])
    return [_played(name, (one[name], other[name]), (rig, rig), names) for name in common]


def _as_wholes(names: tuple[str, str], asked: RigOptions) -> list[Block]:
    """Rank two sets for the same people and draws, and compare them."""
    from thermicon.perception import rank

    sets = [read_set([name]) for name in names]
    for name, icons in zip(names, sets, strict=True):
        if not 2 <= len(icons) <= MOST_ICONS:
            raise TraceFileError(
                f"{name} has {count_of(len(icons), 'icon')}; sets of 2 to {MOST_ICONS:,} icons are compared as a whole"
            )
    rigs = [asked.load(icons, name) for icons, name in zip(sets, names, strict=True)]
    with progress_bar("ranking") as progress:
        one, other = (rank(icons, rig, progress=progress) for icons, rig in zip(sets, rigs, strict=True))
    first, second = (Path(name).stem for name in names)
    return sets_report((first, second) if first != second else names, (one, other))


def _played(title: str, icons: tuple[Icon, Icon], rigs: tuple[Rig, Rig], names: tuple[str, str]) -> Comparison:
    """Play two icons, the shorter with a tail at its baseline so that both are equally long, and compare."""
    traces = _equally_long(icons, rigs)
    outcomes = (outcome_text(traces[0]), outcome_text(traces[1]))
    # Without their folders, unless these are what the names differ in.
    first, second = (Path(name).name for name in names)
    shown = names if first == second else (first, second)
    curves = [curves_of(trace, name) for trace, name in zip(traces, shown, strict=True)]
    return Comparison(title, align(curves[0], curves[1]), outcomes)


def _equally_long(icons: tuple[Icon, Icon], rigs: tuple[Rig, Rig]) -> list[Trace]:
    from thermicon.circuit import simulate

    traces = [simulate(icon, rig) for icon, rig in zip(icons, rigs, strict=True)]
    ends = [float(trace.time_s[-1]) for trace in traces]
    for k in (0, 1):
        if ends[k] < max(ends):
            traces[k] = simulate(icons[k], rigs[k], tail_s=max(ends) - ends[k])
    return traces


def _tables(names: tuple[str, str], icon: str | None, theirs: dict[str, str], shift: bool) -> Comparison:
    """Compare the curves of two files, the second shifted in time where that is asked."""
    first, second = (read_curves(_predicted(path), icon, theirs) for path in names)
    for curves in (first, second):
        for said in curves.notes:
            note(f"note: {curves.name}: {said}")
    said = ""
    if shift:
        second, said = _shifted(first, second)
    return Comparison("", align(first, second), after=said)


def _predicted(path: str) -> str:
    """Return the predicted display of a drive of set-points, which is exported beside it; else the file itself."""
    beside = Path(path).with_suffix(".predicted.csv")
    if not beside.exists() or Path(path).suffix != ".csv":
        return path
    note(f"{path} holds set-points; what they are predicted to do is compared, {beside.name}")
    return str(beside)


def _shifted(first: Curves, second: Curves) -> tuple[Curves, str]:
    """Return B on the clock of A, by cross-correlation of the first column that both have, and a sentence on it."""
    from thermicon.circuit.fitting.overlay import SHIFTED_BY, best_shift_s

    common = [name for name in (*SHIFTED_BY, *first.columns) if name in first.columns and name in second.columns]
    if not common:
        raise TraceFileError(f"no column in both {first.name} and {second.name} to align them by")
    by = common[0]
    shift, alike = best_shift_s(first.time_s, first.columns[by], second.time_s, second.columns[by])
    if alike <= 0:
        raise TraceFileError(f"{second.name}: no shift makes its {by} like that of {first.name}; leave out --align")
    sentence = f"B was shifted by {number(shift, 3)} s, by the correlation of {quantity(by)} ({number(alike, 3)})"
    return replace(second, time_s=second.time_s + shift), sentence
