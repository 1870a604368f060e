"""``thermicon sensitivity``: which constants carry the doubt about a set, and what to measure first."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.icons.number_text import percent

from ..figures.figure_look import SCREEN, Look
from ..files.outputs import FIGURE_SUFFIXES, TRACE_SUFFIXES, check_output, check_separate
from ..messages import check_draws, fail, load_observer, progress_bar
from ..report.options import check_norm_option
from ..report.tables import show, table
from .cues import read_set, warn_of_frames
from .sweep import write_study

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.perception.ranking.sensitivity import Sensitivity

SHOWN = 12
"""Constants in the table; a file has them all."""


@dataclass(frozen=True, slots=True)
class Request:
    """The options of ``sensitivity``."""

    people: int = 24
    seed: int = 0
    draws: int | None = None
    norm: str = "episodes"
    observer: Path | None = None


def sensitivity_file(
    file: str, rig: Rig, request: Request, output: Path | None, figure: Path | None, look: Look = SCREEN
) -> None:
    """Study the icons of a file on the rig: the table on stdout, other outputs on request."""
    from thermicon.perception.ranking.sensitivity import DRAWS, FEWEST_DRAWS, sensitivity

    check_norm_option(request.norm)
    if output is not None:
        check_output(output, TRACE_SUFFIXES, "a table of sensitivities")
    if figure is not None:
        check_output(figure, FIGURE_SUFFIXES, "a figure")
    check_separate([file], [output, figure])
    icons = read_set([file])
    if len(icons) < 2:
        fail(f"{file}: a sensitivity study needs at least two icons, since one alone is never confused")
    warn_of_frames([file], icons, rig)
    model = load_observer(request.observer, rig, "a sensitivity is read from draws of a posterior")
    draws = check_draws(model, request.draws, "--draws", DRAWS, FEWEST_DRAWS)
    with progress_bar("sensitivity") as progress:
        found = sensitivity(
            icons,
            rig,
            people=request.people,
            seed=request.seed,
            draws=draws,
            norm=request.norm,
            observer=model,
            progress=progress,
        )
    if not write_study(found, output, figure, look):
        show_sensitivity(found, icons.title)


def show_sensitivity(found: Sensitivity, title: str) -> None:
    """Print one row per constant that counts, the most important first, and what to measure first."""
    made = table(
        "constant",
        "95 % of draws",
        "correct",
        "bits",
        "correct low–high",
        numbers=("correct", "bits", "correct low–high"),
    )
    for effect in found.effects[:SHOWN]:
        unit = "" if effect.unit in ("", "1") else f" {effect.unit}"
        made.add_row(
            effect.constant,
            f"{effect.low:.3g} to {effect.high:.3g}{unit}",
            percent(effect.proportion_correct),
            percent(effect.information_bits),
            f"{percent(effect.at_low)} – {percent(effect.at_high)}",
        )
    heading = [title, ""] if title else []
    show(*heading, made, "", *sentences(found))


def sentences(found: Sensitivity) -> list[str]:
    """Return what to measure first, what the numbers are, and what they were computed from."""
    what_if = f" with {', '.join(found.rig_changes)}" if found.rig_changes else ""
    crowd = "1 virtual person" if found.people == 1 else f"{found.people} virtual people"
    lead = "Measure first, by the share of the variance of the proportion correct that would go:"
    return [
        lead if found.first else "No measurement would narrow the prediction noticeably.",
        *(f"  - {percent(each.proportion_correct)}: {each.measurement}" for each in found.first),
        "",
        "Shares of the variance between draws of the posterior; constants that trade off share theirs, so that shares "
        "need not add up to 100 %. Beside them the proportion correct expected at both ends of the interval. "
        f"{found.draws} draws for {crowd} on the {found.rig} rig{what_if} (seed {found.seed}, {found.norm} norm): "
        "contact and outermost layer of the skin vary too, unlike in the intervals of rank.",
    ]
