"""``thermicon improve``: better icons by edits or by search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermicon.perception.selection.request import Objective

from ..files.outputs import FIGURE_SUFFIXES, TRACE_SUFFIXES, check_output, check_separate
from ..messages import usage
from ..report.set_report import objective_of
from .improving import Improvement, by_written_names
from .options import (
    CrowdOptions,
    FigureOptions,
    FileNames,
    Goals,
    Options,
    RigOptions,
    commands,
    flag,
    goal_of,
    opt,
    out,
    read_set,
)

if TYPE_CHECKING:
    from thermicon.icons import IconSet
    from thermicon.perception import Goal

USUAL_EVALUATIONS, MOST_CHOSEN = 2000, 64


@dataclass(frozen=True)
class ImproveOptions(Options):
    """What is asked of a set, and the files that the answer goes to."""

    choose: Annotated[int | None, opt("N", "Choose the best N icons.", 2, MOST_CHOSEN)] = None
    up_to: Annotated[int | None, opt("N", "Choose the best 2, 3, … N icons, as a table.", 2, MOST_CHOSEN)] = None
    goal: Goals = None
    edits: Annotated[
        bool,
        flag("--edits", "Find the cheapest edit of every pair that is not distinguishable; -o writes the edited set."),
    ] = False
    evaluations: Annotated[
        int | None,
        opt(
            "N",
            "Search the families of FILE: number of icons to try; more take longer and may find a better set.  "
            "[default: 2000]",
            10,
            1_000_000,
        ),
    ] = None
    objective: Annotated[
        Objective | None,
        typer.Option(
            help="What a choice or a search improves beside its goal.  [default: that of the goal, or worst (pair)]"
        ),
    ] = None
    must: Annotated[list[str] | None, opt("ICON", "An icon that must be chosen; may be given several times.")] = None
    output: Annotated[
        list[Path] | None,
        out(
            "OUT",
            "Write what was found: a set to .cue (of --up-to the largest that meets the goal), the table of --up-to to "
            ".csv or .parquet and its figure to .pdf, .svg or .png, a choice with its ranking to .json; - prints it.",
            "-o",
            "--output",
        ),
    ] = None

    def searches(self, icons: IconSet) -> bool:
        """Whether families are searched: where that is asked for, or nothing that takes their icons as they are."""
        as_they_are = self.choose is not None or self.up_to is not None or self.edits
        return self.evaluations is not None or (bool(icons.families) and not as_they_are)

    def check(self, files: Sequence[str], searched: bool, figure: Path | None) -> None:
        """Refuse questions that exclude each other, and outputs that the answer does not have."""
        if self.up_to is not None and (self.choose is not None or self.edits or searched):
            raise usage("is a question of its own: leave out --choose, --edits and --evaluations", "--up-to")
        if self.edits and searched:
            raise usage("edits icons as they are, which a search does not leave: leave out --evaluations", "--edits")
        if self.must and (self.choose is None or searched):
            raise usage(
                "needs --choose K, which chooses the best K icons; a search keeps all that are no families", "--must"
            )
        if self.objective is not None and not (self.choose or self.up_to or searched):
            raise usage("needs --choose K, --up-to K or a search of families", "--objective")
        table = (*TRACE_SUFFIXES, *FIGURE_SUFFIXES, ".cue")
        kinds = (".cue",) if searched else table if self.up_to is not None else (".cue", ".json")
        for path in self.output or []:
            check_output(path, kinds, "what this finds")
        check_separate(files, [*(self.output or []), figure])
        if searched and len(files) > 1:
            raise usage("one file is searched; join its families into one set", "FILE")

    def improved(self, goal: Goal | None) -> Objective:
        """What is improved beside the goal."""
        return self.objective or ("felt-and-named" if self.up_to is not None else objective_of(goal))


def improve_command(
    files: FileNames, asked: ImproveOptions, crowd: CrowdOptions, rig: RigOptions, figure: FigureOptions
) -> None:
    """Improve a set of icons: edit pairs, choose the best icons, or search the families of a set.

    Families are searched over their continuous parameters, unless --choose, --up-to or --edits without --evaluations
    asks for icons as they are; all other icons stay. Totals, numbers and single icons that a goal asks for are kept.
    What is found is the best for the model: test it with people.
    """
    goal = goal_of(asked.goal)
    icons = read_set(files)
    searched = asked.searches(icons)
    asked.check(files, searched, figure.figure)
    where = rig.load(icons, files[0])
    people = crowd.load(where)
    draws = crowd.draws(people.model)
    must = asked.must or []
    if icons.families and not searched:
        icons, must = by_written_names(icons, must, where)
    improvement = Improvement(
        icons, where, people, draws, goal, asked.improved(goal), asked.output or [], figure, commands(files, rig, crowd)
    )
    if asked.up_to is not None:
        improvement.by_table(asked.up_to)
    elif searched:
        improvement.by_search(asked.choose, asked.evaluations or USUAL_EVALUATIONS)
    else:
        improvement.by_choice(asked.choose, must, asked.edits)
