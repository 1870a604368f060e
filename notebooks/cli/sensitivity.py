"""``thermicon sensitivity``: which uncertain parameters change the prediction for a set most."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from thermicon.icons.number_text import percent

from ..files.outputs import FIGURE_SUFFIXES, STDOUT, TRACE_SUFFIXES, check_output, check_separate, complete_or_absent
from ..text.messages import fail, note, progress_bar, usage
from ..text.tables import show, table
from .cues import read_set, warn_of_frames
from .sweep import write_frame

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.perception import Sensitivity

HOW = {
    "reference area": "the area of the published thresholds; measure thresholds on your own display instead",
    "slope of sensation": "amplitude difference thresholds, at several amplitudes",
    "memory noise": "let people name a few icons from memory and count",
    "share of the scatter of ratings": "let people name icons that differ in intensity alone, from memory",
    "transducer exponent": "how fast the share of reports rises with the size of a change near threshold",
    "gain noise": "the scatter of one person's repeated thresholds, beyond that of the criterion",
    "criterion of speeded answers": "false alarms and reaction times of the same people",
    "limit": "coolings of warm skin and warmings of cool skin, at several starting temperatures",
    "lapse rate": "errors on two icons that are unmistakable",
    "contact resistance": "skin or interface thermistor under your display, then fit the rig to its log",
    "spread of thresholds between people": "thresholds of a dozen people on your own display",
    "onset uncertainty": "how well people distinguish two onsets in time",
}
"""How to measure a parameter whose name does not say it."""


@dataclass(frozen=True, slots=True)
class Request:
    """The options of ``sensitivity``."""

    people: int = 24
    seed: int = 0
    samples: int = 64
    norm: str = "episodes"


def sensitivity_file(file: str, rig: Rig, request: Request, output: Path | None, figure: Path | None) -> None:
    """Study the icons of a file on the rig: the table on stdout, other outputs on request."""
    from thermicon.perception import NORMS, sensitivity

    if request.norm not in NORMS:
        raise usage(f"{request.norm!r} is not one of {', '.join(NORMS)}", "--norm")
    if output is not None:
        check_output(output, TRACE_SUFFIXES, "a table of sensitivities")
    if figure is not None:
        check_output(figure, FIGURE_SUFFIXES, "a figure")
    check_separate([file], [output, figure])
    icons = read_set([file])
    if len(icons) < 2:
        fail(f"{file}: a sensitivity study needs at least two icons, since one alone is never confused")
    warn_of_frames([file], icons, rig)
    with progress_bar("sensitivity") as progress:
        found = sensitivity(
            icons,
            rig,
            people=request.people,
            seed=request.seed,
            samples=request.samples,
            norm=request.norm,
            progress=progress,
        )
    if output is not None and output != STDOUT:
        with complete_or_absent(output) as draft:
            write_frame(found.to_frame(), draft)
        note(f"wrote {output}")
    if figure is not None:
        drawn: Any = found.plot().figure
        with complete_or_absent(figure) as draft:
            drawn.savefig(draft, dpi=130)
        note(f"wrote {figure}")
    if output == STDOUT:
        typer.echo(found.to_frame().to_csv(index=False, float_format="%.9g"), nl=False)
    else:
        show_sensitivity(found, icons.title)


def show_sensitivity(found: Sensitivity, title: str) -> None:
    """Print one row per parameter, the most important first, and what to measure first."""
    made = table(
        "parameter", "interval", "correct", "bits", "correct low–high", numbers=("correct", "bits", "correct low–high")
    )
    for effect in found.effects:
        parameter = effect.parameter
        unit = "" if parameter.unit == "1" else f" {parameter.unit}"
        low, high = effect.proportion_correct_ends
        made.add_row(
            parameter.name,
            f"{parameter.low:.3g}–{parameter.high:.3g}{unit}",
            percent(effect.proportion_correct),
            percent(effect.information_bits),
            f"{percent(low)} – {percent(high)}",
        )
    heading = [title, ""] if title else []
    show(*heading, made, "", *sentences(found))


def how(name: str) -> str:
    """Describe how a lab would measure a parameter; nothing where the name says it.

    >>> how("memory noise (max)")
    ': let people name a few icons from memory and count'
    """
    found = HOW.get(name.split(" (")[0])
    return f": {found}" if found else ""


def sentences(found: Sensitivity) -> list[str]:
    """Return what to measure first, what the numbers are, and what they were computed from."""
    kind = (
        "Shares of the variance of the proportion correct and of the bits, interactions included (total Sobol indices)"
    )
    what_if = f" with {', '.join(found.rig_changes)}" if found.rig_changes else ""
    crowd = "1 virtual person" if found.people == 1 else f"{found.people} virtual people"
    lead = "Measure these first; all others influence the prediction less:"
    return [
        lead if found.first else "None of these parameters influences the prediction.",
        *(f"  - {name}{how(name)}" for name in found.first),
        "",
        f"{kind}; beside them the proportion correct at the low and at the high end of each interval. "
        f"{found.runs} predictions for {crowd} on the {found.rig} rig{what_if} (seed {found.seed}, {found.norm} norm), "
        f"{percent(found.proportion_correct)} correct and {found.information_bits:.2f} bits with all at their values.",
    ]
