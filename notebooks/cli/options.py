"""Options that commands share, in groups: each checks itself, loads what it names, and knows its words again.

A command takes groups as arguments; `command` lays their options out beside its own for typer.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import Field, dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_type_hints

import typer

from thermicon.icons.atomic import complete_or_absent

from ..figures.style import SCREEN, Look, read_width_mm
from ..files.outputs import FIGURE_SUFFIXES, STDOUT, check_output
from ..messages import DEFAULT_RIG, check_changes, check_draws, load_observer, load_rig, note, usage

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.perception.observer.observer_model import ObserverModel

MOST_PEOPLE, MOST_DRAWS, LARGEST_SEED = 100_000, 10_000, 2**32 - 1
LONGEST_TAIL_S = 86_400.0


def rigs_like(incomplete: str) -> list[str]:
    """Shipped rigs that begin so, for the shell."""
    from thermicon.circuit.rig.rig import rig_names

    return [name for name in rig_names() if name.startswith(incomplete)]


def sets_like(incomplete: str) -> list[str]:
    """Shipped sets that begin so, for the shell."""
    from thermicon.icons.files.shipped import library_names

    return [name for name in library_names() if name.startswith(incomplete)]


def out(ending: str, what: str, *names: str) -> Any:
    """An option that names a file to write; its path is checked as bad input, not as bad usage (`readable=False`)."""
    return typer.Option(*names, metavar=ending, readable=False, help=what)


FileNames = Annotated[
    list[str],
    typer.Argument(metavar="FILE", autocompletion=sets_like, help="Cue files, or names of shipped sets (six-icons)."),
]
FileName = Annotated[
    str, typer.Argument(metavar="FILE", autocompletion=sets_like, help="A cue file, or the name of a shipped set.")
]
NoFile = Annotated[
    str | None,
    typer.Argument(
        metavar="FILE", autocompletion=sets_like, show_default=False, help="A cue file, or the name of a shipped set."
    ),
]
IconName = Annotated[str | None, typer.Option("--icon", metavar="NAME", help="Only this icon of the file.")]
Tail = Annotated[
    float, typer.Option(metavar="S", min=0.0, max=LONGEST_TAIL_S, help="Seconds simulated after the last corner.")
]
Json = Annotated[Path | None, out("OUT", "Write every number as JSON; - prints it.", "--json")]
Table = Annotated[Path | None, out("OUT", "Write the table to .csv or .parquet; - prints it.", "-o", "--output")]
People = Annotated[int, typer.Option(metavar="N", min=1, max=MOST_PEOPLE, help="Number of virtual people.")]
Seed = Annotated[int, typer.Option(metavar="SEED", min=0, max=LARGEST_SEED, help="Seed of everything that is drawn.")]
Intervals = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        min=0,
        max=MOST_DRAWS,
        help="Draws of the posterior for intervals and goals; 0 for none.  [default: 128, or all there are]",
    ),
]


class Options:
    """A group of options: a frozen dataclass whose fields carry their options."""

    def words(self, *, paths: bool = False) -> list[str]:
        """What repeats the group on a command line: options other than the default; paths as given, or names alone.

        >>> CrowdOptions(people=20, observer=Path("a/lab.csv")).words()
        ['--observer', 'lab.csv', '--people', '20']
        """
        own: tuple[Field[Any], ...] = fields(self)  # type: ignore[arg-type]
        given = ((field.name, getattr(self, field.name)) for field in own if getattr(self, field.name) != field.default)
        return [word for name, value in given for word in _option(name, value, paths)]


def _option(name: str, value: object, paths: bool) -> list[str]:
    words = []
    for each in value if isinstance(value, list) else [value]:
        shown = each.name if isinstance(each, Path) and not paths else str(each)
        words += [f"--{name.replace('_', '-')}", *([] if each is True else [shown])]
    return words


@dataclass(frozen=True)
class RigOptions(Options):
    """The rig, with changes of single keys."""

    rig: Annotated[
        str | None,
        typer.Option(metavar="RIG", autocompletion=rigs_like, help="A shipped rig or a .toml file.  [default: thenar]"),
    ] = None
    set: Annotated[
        list[str] | None,
        typer.Option(metavar="KEY=VALUE", help="Change one key of the rig; may be given several times."),
    ] = None

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

    def load(self, *, module_matters: bool = True) -> Rig:
        """The rig with its changes; its warnings go to stderr."""
        return load_rig(self.rig, self.changes, module_matters=module_matters)

    def words(self, *, paths: bool = False) -> list[str]:
        """As for any group; the usual rig is left out.

        >>> RigOptions("rigs/mine.toml", ["contact.area_cm2=4"]).words()
        ['--rig', 'mine.toml', '--set', 'contact.area_cm2=4']
        """
        name = None if self.rig == DEFAULT_RIG else self.rig if paths or self.rig is None else Path(self.rig).name
        return super(RigOptions, replace(self, rig=name)).words(paths=paths)


@dataclass(frozen=True)
class ObserverOptions(Options):
    """Who feels and remembers icons, and what of them is the same for all people."""

    seed: Seed = 0
    tracking: Annotated[
        Literal["replay", "display", "ideal"] | None,
        typer.Option(help="What is the same for all people: current, display or target.  [default: by control]"),
    ] = None
    norm: Annotated[Literal["episodes", "naming"], typer.Option(help="How icons are remembered.")] = "episodes"
    observer: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            readable=False,
            help="Predict with another observer: draws that pilot --keep writes (.csv), or its records (.toml).",
        ),
    ] = None

    @property
    def asked(self) -> dict[str, Any]:
        """Arguments of functions that predict."""
        return {"seed": self.seed, "tracking": self.tracking, "norm": self.norm}

    def load(self, rig: Rig, needs_draws: str = "") -> ObserverModel:
        """The observer; notes on stderr say what it cannot give. `needs_draws`: what cannot be done without draws."""
        return load_observer(self.observer, rig, needs_draws)


@dataclass(frozen=True)
class CrowdOptions(ObserverOptions):
    """Virtual people, and draws of the posterior for the intervals that another laboratory will find."""

    people: People = 200
    intervals: Intervals = None

    def __post_init__(self) -> None:
        check_intervals(self.intervals)

    @property
    def asked(self) -> dict[str, Any]:
        """Arguments of functions that predict for people."""
        return {"people": self.people, **super().asked}

    def draws(self, model: ObserverModel) -> int:
        """How many draws to use: as many as were asked for, or the usual number, or as many as there are."""
        from thermicon.perception.identification.laboratory import DRAWS

        return check_draws(model, self.intervals, "--intervals", DRAWS)


def check_intervals(draws: int | None) -> None:
    """Fail with a usage error for a single draw."""
    if draws == 1:
        raise usage("1 draw has no interval; give 2 or more, or 0 for none", "--intervals")


@dataclass(frozen=True)
class FigureOptions(Options):
    """The figure, and how wide it is printed."""

    figure: Annotated[Path | None, out("OUT", "Draw the figure: .pdf, .svg or .png.")] = None
    paper: Annotated[
        str | None,
        typer.Option(
            metavar="WIDTH", help="Draw for print, so wide (85mm, 18cm, 7in): letters on the panels, no title."
        ),
    ] = None

    def __post_init__(self) -> None:
        if self.figure is None and self.paper is not None:
            raise usage("belongs to a figure; name its file with --figure", "--paper")
        read_width_mm(self.paper or "85mm")
        self.check_place()

    def check_place(self) -> None:
        """Fail where the figure cannot be written."""
        if self.figure is not None:
            check_output(self.figure, FIGURE_SUFFIXES, "a figure")

    @property
    def look(self) -> Look:
        """How the figure is drawn."""
        return SCREEN if self.paper is None else Look(read_width_mm(self.paper))

    def write(self, drawn: Any) -> None:
        """Write a figure to its file, and say so; nothing where none was asked for."""
        if self.figure is not None:
            from ..figures.print_figure import write_figure

            write_figure(drawn, self.figure, self.look)
            note(f"wrote {self.figure}")


def write_text(text: str, output: Path, more: str = "", encoding: str = "utf-8") -> None:
    """Write text to a file, complete or not at all, and say so, with what `more` there is to say; - is stdout."""
    if output == STDOUT:
        typer.echo(text, nl=False)
        return
    with complete_or_absent(output) as draft:
        draft.write_text(text, encoding=encoding, newline="\n")
    note(f"wrote {output}{more}")


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
