"""``thermicon compare``: two rigs, icons, sets, or a trace and a log, as one table of differences and one figure."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermicon.icons.number_text import number

from ..files.outputs import check_separate
from ..files.trace_files import Curves, LogError, align, curves_of, quantity, read_curves
from ..messages import DEFAULT_RIG, load_rig, note, usage
from ..report.blocks import Text
from ..report.compare_report import Comparison, compare_report, comparison_line, matrix_report
from ..report.terminal import show
from .cues import pick, read_set
from .options import FigureOptions, IconName, RigOptions
from .simulate import headline

if TYPE_CHECKING:
    from thermicon.circuit import Rig, Trace
    from thermicon.icons import Icon, IconSet

DEFAULT_SET, DEFAULT_ICON = "six-icons", "cooling-step"
FEWEST, MOST_IN_A_SET = 2, 30
"""Larger sets are compared icon by icon alone; `thermicon.perception.selection.appraise.compare_sets` takes them."""
TABLES = (".csv", ".parquet")
NAMES = {"rig": "a rig", "icon": "an icon", "set": "an icon set", "table": "a trace or log"}
HOW = "a rig is a name or a .toml file, an icon FILE:ICON, a set a .cue file or a name, a trace or log .csv or .parquet"

APPLIES = {
    "--file": (("rig",), "belongs to two rigs; two sets are A and B"),
    "--icon": (("rig", "set", "table"), "the two icons are A and B"),
    "--rig": (("icon", "set"), "the two rigs are A and B; traces and logs are compared as they are"),
    "--set": (("rig", "icon", "set"), "traces and logs are compared as they are"),
    "--rigs": (("set",), "belongs to two sets"),
    "--align": (("table",), "belongs to a trace and a log, which have clocks of their own"),
}
"""The kinds that an option applies to, and what is said for others."""


@dataclass(frozen=True, slots=True)
class Request:
    """Options of ``compare``: the file with icons for two rigs, one icon only, the rig with its changes, alignment."""

    file: str | None = None
    icon: str | None = None
    rig: str | None = None
    changes: tuple[str, ...] = ()
    align: bool = False
    rigs: tuple[str, ...] = ()


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
    show([block for each in made for block in compare_report(each)])


def kind_of(text: str, option: str) -> str:
    """Return what an argument names, a rig, icon, set or table; a usage error if that is not clear.

    >>> [kind_of(text, "A") for text in ("thenar", "my.toml", "six-icons:double-dip", "my.cue", "log.csv")]
    ['rig', 'rig', 'icon', 'set', 'table']
    """
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
    from thermicon.icons.near_words import did_you_mean

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


def check_request(kind: str, request: Request) -> None:
    """Fail with a usage error for an option that does not apply to this kind."""
    given = (request.file, request.icon, request.rig, request.changes, request.rigs, request.align)
    for (option, (kinds, why)), value in zip(APPLIES.items(), given, strict=True):
        if value not in (None, (), False) and kind not in kinds:
            raise usage(why, option)


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
    told = matrix_report(sets, {Path(name).name: load_rig(name, request.changes) for name in names})
    if len(names) == 1:
        one, other = sets.values()
        sentence = compare_identification(one, other, load_rig(names[0], request.changes))
        told += [Text(f"A {next(iter(sets))}, B {list(sets)[1]}\n{sentence}")] if sentence else []
    show(told)


def _sets(first: str, second: str, request: Request) -> list[Comparison]:
    sets, common = [read_set([name]) for name in (first, second)], _common(first, second)
    names = [[icon.name for icon in icons] for icons in sets]
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
    from thermicon.perception.selection.appraise import compare_sets

    if any(not 2 <= len(icons) <= MOST_IN_A_SET for icons in (first, second)):
        return None
    return comparison_line(compare_sets(first, second, rig))
