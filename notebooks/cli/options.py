"""Options that several commands share.

A group checks itself, loads what it names, and knows its words again. A command takes groups as arguments; `flat` lays
their options out beside its own for typer.
"""

from __future__ import annotations

import inspect
import shlex
from collections.abc import Callable, Sequence
from dataclasses import Field, dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_type_hints

import typer

from thermicon.base.files.atomic import complete_or_absent
from thermicon.perception.criteria import MOST_ICONS

from ..figures.style import SCREEN, Look, read_width_mm
from ..files.outputs import FIGURE_SUFFIXES, STDOUT, check_output
from ..loading import check_changes, check_draws, load_observer, load_rig, site_warnings
from ..messages import note, usage

if TYPE_CHECKING:
    import pandas as pd

    from thermicon.circuit import Rig
    from thermicon.icons import Icon, IconSet, SpatialIcon
    from thermicon.perception import Goal, Ranking
    from thermicon.perception.observer.observer_model import ObserverModel

MOST_PEOPLE, MOST_DRAWS, LARGEST_SEED = 100_000, 10_000, 2**32 - 1
LONGEST_TAIL_S = 86_400.0


def opt(metavar: str, what: str, least: Any = None, most: Any = None, name: str = "", **more: Any) -> Any:
    """An option with a value, of a number with its limits; it is called as its argument unless it has a name."""
    return typer.Option(*name.split(), metavar=metavar, min=least, max=most, help=what, **more)


def flag(name: str, what: str) -> Any:
    """An option without a value."""
    return typer.Option(name, help=what)


def out(ending: str, what: str, *names: str) -> Any:
    """An option that names a file to write; its path is checked as bad input, not as bad usage (`readable=False`)."""
    return typer.Option(*names, metavar=ending, readable=False, help=what)


A_FILE = "A cue file, or the name of a shipped set."
FileNames = Annotated[
    list[str], typer.Argument(metavar="FILE", help="Cue files, or names of shipped sets (six-icons).")
]
FileName = Annotated[str, typer.Argument(metavar="FILE", help=A_FILE)]
NoFile = Annotated[str | None, typer.Argument(metavar="FILE", show_default=False, help=A_FILE)]
IconName = Annotated[str | None, opt("NAME", "Only this icon of the file.", name="--icon")]
Tail = Annotated[float, opt("S", "Seconds simulated after the last corner.", 0.0, LONGEST_TAIL_S)]
Json = Annotated[Path | None, out("OUT", "Write every number as JSON; - prints it.", "--json")]
Table = Annotated[Path | None, out("OUT", "Write the table to .csv or .parquet; - prints it.", "-o", "--output")]
Theirs = Annotated[
    list[str] | None,
    opt("NAME=THEIRS", "What the table calls a column of ours, as in display_C=T1; several times.", name="--column"),
]
People = Annotated[int, opt("N", "Number of virtual people.", 1, MOST_PEOPLE)]
Seed = Annotated[int, opt("SEED", "Seed of everything that is drawn.", 0, LARGEST_SEED)]
Intervals = Annotated[
    int | None,
    opt(
        "N",
        "Draws of the posterior for intervals and goals; 0 for none.  [default: 128, or all there are]",
        0,
        MOST_DRAWS,
    ),
]


def command_text(files: Sequence[str], *groups: Options, paths: bool = False, command: str = "rank") -> str:
    """Return the command that reproduces a ranking, without its outputs: file names and non-default options.

    Files are named without their folders, or, with ``paths``, as they were given.
    """
    words = ["thermicon", command, *(name if paths else Path(name).name for name in files)]
    return shlex.join([*words, *(word for group in groups for word in group.words(paths=paths))])


def commands(files: Sequence[str], rig: Options, crowd: Options) -> Callable[..., str]:
    """What writes the command that comes next, by its name and words: for these files, or one, on this rig."""

    def command(name: str, *words: str, file: str | None = None) -> str:
        groups = (crowd, rig) if name in ("rank", "improve") else (rig,)
        own = files if file is None else [file]
        return " ".join(filter(None, [command_text(own, *groups, paths=True, command=name), shlex.join(words)]))

    return command


Goals = Annotated[
    list[str] | None,
    opt(
        "TEXT",
        'What is wanted, such as "90 % felt-and-named for 95 % of people, time <= 10 s, safety green".',
        name="--goal",
    ),
]


def goal_of(texts: list[str] | None) -> Goal | None:
    """The goal of all ``--goal`` together; None where none was given."""
    from thermicon.perception import Goal
    from thermicon.perception.selection.goal import other_word

    if not texts:
        return None
    if (offer := other_word(", ".join(texts))) is not None:
        note(offer)
    return Goal.parse(", ".join(texts))


FILES = ("rig", "observer")
"""Options of groups whose values are files, or names of what is shipped."""


class Options:
    """A group of options: a frozen dataclass whose fields carry their options."""

    def words(self, *, paths: bool = False) -> list[str]:
        """Words that repeat the group on a command line: options but defaults; paths as given, or names alone."""
        own: tuple[Field[Any], ...] = fields(self)  # type: ignore[arg-type]
        words: list[str] = []
        for field in own:
            value = getattr(self, field.name)
            for each in [] if value == field.default else value if isinstance(value, list) else [value]:
                shown = Path(each).name if field.name in FILES and not paths else str(each)
                words += [f"--{field.name.replace('_', '-')}", shown]
        return words


@dataclass(frozen=True)
class RigOptions(Options):
    """The rig, with changes of single keys."""

    rig: Annotated[
        str | None, opt("RIG", "A shipped rig or a .toml file.  [default: that of the set's site, or thenar]")
    ] = None
    set: Annotated[list[str] | None, opt("KEY=VALUE", "Change one key of the rig; may be given several times.")] = None

    def __post_init__(self) -> None:
        check_changes(self.changes)

    @property
    def changes(self) -> list[str]:
        """The changes, none where none was asked for."""
        return self.set or []

    @property
    def given(self) -> bool:
        """Whether a rig or a change was asked for."""
        return self.rig is not None or bool(self.set)

    def load(self, icons: IconSet | Icon | None = None, file: str = "", *, told: bool = False) -> Rig:
        """The rig with its changes, the usual one for icons of a file unless one is named; warnings go to stderr.

        ``told``: the command's own report says where rig and icons lie outside the data.
        """
        rig = load_rig(self.rig, self.changes, site=None if icons is None else icons.context.site)
        if icons is None:
            return rig
        for warning in site_warnings(file, icons, rig):
            note(f"warning: {warning}")
        if not told:
            from thermicon.perception.sensation.coverage import outside_setting

            for sentence in outside_setting(icons.context.baseline_C, rig):
                note(f"outside the data: {sentence}")
        return rig


@dataclass(frozen=True)
class ObserverOptions(Options):
    """Options about the virtual people who feel and remember icons."""

    seed: Seed = 0
    tracking: Annotated[
        Literal["replay", "display", "ideal"] | None,
        typer.Option(
            help="What every virtual person receives: same current, display or skin temperature.  [default: by control]"
        ),
    ] = None
    memory: Annotated[
        Literal["both", "episodes", "naming"],
        typer.Option(help="Form of memory; both: a laboratory has either."),
    ] = "both"
    observer: Annotated[
        Path | None,
        opt(
            "FILE",
            "Predict with another observer: draws that pilot --keep writes (.csv), or its records (.toml).",
            readable=False,
        ),
    ] = None

    @property
    def asked(self) -> dict[str, Any]:
        """Arguments of functions that predict."""
        return {"seed": self.seed, "tracking": self.tracking, "memory": self.memory}

    def load(self, rig: Rig, needs_draws: str = "") -> ObserverModel:
        """The observer; notes on stderr say what it cannot give. `needs_draws`: what cannot be done without draws."""
        return load_observer(self.observer, rig, needs_draws)


@dataclass(frozen=True)
class CrowdOptions(ObserverOptions):
    """Virtual people, and draws of the posterior for the intervals that another laboratory will find."""

    people: People = 200
    intervals: Intervals = None

    def __post_init__(self) -> None:
        if self.intervals == 1:
            raise usage("1 draw has no interval; give 2 or more, or 0 for none", "--intervals")

    @property
    def asked(self) -> dict[str, Any]:
        """Arguments of functions that predict for people."""
        return {"people": self.people, **super().asked}

    def draws(self, model: ObserverModel) -> int:
        """The number of draws: as many as were asked for, or the usual number, or as many as there are."""
        from thermicon.perception.identification.new_laboratory import DRAWS

        return check_draws(model, self.intervals, "--intervals", DRAWS)


@dataclass(frozen=True)
class FigureOptions(Options):
    """The figure, and how wide it is printed."""

    figure: Annotated[Path | None, out("OUT", "Draw the figure: .pdf, .svg or .png.")] = None
    paper: Annotated[
        str | None, opt("WIDTH", "Draw for print, so wide (85mm, 18cm, 7in): letters on the panels, no title.")
    ] = None

    def __post_init__(self) -> None:
        if self.figure is None and self.paper is not None:
            raise usage("belongs to a figure; name its file with --figure", "--paper")
        read_width_mm(self.paper or "85mm")
        if self.figure is not None:
            check_output(self.figure, FIGURE_SUFFIXES, "a figure")

    @property
    def look(self) -> Look:
        """The look of the figure."""
        return SCREEN if self.paper is None else Look(read_width_mm(self.paper))

    def write_set(self, ranking: Ranking) -> None:
        """Write the figure of a set: distances and confusions; nothing where none was asked for."""
        if self.figure is not None:
            from ..figures.set_figures import narrowest_mm, set_figure

            self.write(lambda: set_figure(ranking, self.look))
            if self.look.width_mm is not None and self.look.width_mm < (least := narrowest_mm(ranking.labels)):
                note(f"note: {len(ranking.labels)} icons can be read in a figure from --paper {least:.0f}mm on")

    def write(self, draw: Callable[[], Any]) -> None:
        """Draw a figure and write it to its file, and say so; nothing is drawn where none was asked for."""
        if self.figure is not None:
            from ..figures.print_figure import write_figure

            write_figure(draw(), self.figure, self.look)
            note(f"wrote {self.figure}")


class JoinError(Exception):
    """Files that cannot be joined: they prescribe different things, or two have an icon of the same name."""


def read_set(files: Sequence[str]) -> IconSet:
    """Read files and join their icons into one set.

    JoinError when they differ in site, control or baseline, or when two icons share a name.
    """
    from thermicon.icons import read_cue

    sets = [read_cue(file) for file in files]
    joined = sets[0]
    owner: dict[str, str] = {}
    for file, icons in zip(files, sets, strict=True) if len(sets) > 1 else ():
        if icons.context != joined.context:
            keys = ("site", "control", "baseline_C", "elements")
            both = [(key.removesuffix("_C"), getattr(icons.context, key), getattr(joined.context, key)) for key in keys]
            told = ", ".join(f"{key} {one}, not {other}" for key, one, other in both if one != other)
            raise JoinError(
                f"{file} has {told} as in {files[0]}, and one set has these in common: put the icons into one file, "
                "or take each file by itself"
            )
        members: tuple[Icon | SpatialIcon, ...] = icons.spatial or tuple(icons)
        for icon in members:
            if icon.name in owner:
                raise JoinError(
                    f"{file}: the icon {icon.name} is also in {owner[icon.name]}; "
                    f"names must differ within a set, so rename one of them"
                )
            owner[icon.name] = file
    if len(sets) > 1:
        titles = [icons.title or Path(file).name for file, icons in zip(files, sets, strict=True)]
        title = "; ".join(titles) if any(icons.title for icons in sets) else ""
        entries = tuple(entry for icons in sets for entry in icons.entries)
        spatial = tuple(icon for icons in sets for icon in icons.spatial)
        joined = replace(joined, title=title, entries=entries, spatial=spatial)
    return joined


def theirs_of(columns: Sequence[str] | None) -> dict[str, str]:
    """A table's names for our columns, by ``--column NAME=THEIRS``."""
    pairs = [column.partition("=") for column in columns or []]
    if wrong := [name for name, equals, own in pairs if not (name.strip() and equals and own.strip())]:
        raise usage(f"{wrong[0]!r} is not of the form NAME=THEIRS, for example display_C=T1", "--column")
    return {name.strip(): own.strip() for name, _, own in pairs}


def pick(icons: IconSet, name: str | None, most: int = MOST_ICONS) -> list[Icon]:
    """Return the icon of this name, or all of them; an unknown name is an error that lists the nearest.

    More than ``most`` icons, as a family may have, are a usage error.
    """
    if name is not None and "," in name:
        raise usage(f"takes one icon, not {name}; leave it out for all, or give the command for each", "--icon")
    if name is not None:
        return [icons[name]]
    if len(icons) > most:
        first = next(iter(icons)).name
        raise usage(
            f"there are {len(icons):,} icons, and at most {most:,} are allowed; name one, such as {first}", "--icon"
        )
    return list(icons)


def write_text(text: str, output: Path, more: str = "", encoding: str = "utf-8") -> None:
    """Write text to a file, complete or not at all, and say so, with what `more` there is to say; - is stdout."""
    if output == STDOUT:
        typer.echo(text, nl=False)
        return
    replaced = " (replaced what was there)" * output.exists()
    with complete_or_absent(output) as draft:
        draft.write_text(text, encoding=encoding, newline="\n")
    note(f"wrote {output}{more}{replaced}")


def write_frame(frame: pd.DataFrame, output: Path) -> None:
    """Write a table as ``.parquet`` or ``.csv``, by its suffix, and say so; - prints it."""
    if output == STDOUT or output.suffix != ".parquet":
        write_text(frame.to_csv(index=False, float_format="%.9g", lineterminator="\n"), output)
        return
    with complete_or_absent(output) as draft:
        frame.to_parquet(draft, index=False)
    note(f"wrote {output}")


def flat(function: Callable[..., None]) -> Callable[..., None]:
    """Return a command whose arguments are its own and, after them, the fields of its groups."""
    hints = get_type_hints(function, include_extras=True)
    groups: dict[str, Any] = {name: kind for name, kind in hints.items() if is_dataclass(kind)}
    own = [
        each.replace(annotation=hints[name], kind=inspect.Parameter.KEYWORD_ONLY)
        for name, each in inspect.signature(function).parameters.items()
        if name not in groups
    ]
    of_groups = [
        each.replace(annotation=get_type_hints(kind, include_extras=True)[name], kind=inspect.Parameter.KEYWORD_ONLY)
        for kind in groups.values()
        for name, each in inspect.signature(kind).parameters.items()
    ]

    def run(**given: Any) -> None:
        made = {
            name: kind(**{each.name: given.pop(each.name) for each in fields(kind)}) for name, kind in groups.items()
        }
        function(**given, **made)

    run.__doc__, run.__name__ = function.__doc__, function.__name__
    run.__signature__ = inspect.Signature([*own, *of_groups])  # type: ignore[attr-defined]
    return run
