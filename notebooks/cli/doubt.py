"""``thermicon rank --doubt``: which constants carry the doubt about a set, and what to measure first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.icons.number_text import count_of, percent

from ..files.outputs import STDOUT
from ..messages import check_draws, fail, progress_bar, usage
from ..report.blocks import Block, Bullets, Heading, Text, grid
from ..report.terminal import show
from .cues import read_set, warn_of_frames
from .options import CrowdOptions, RigOptions, write_text

if TYPE_CHECKING:
    from thermicon.perception.ranking.sensitivity import Sensitivity

    from .ranking import SetFigureOptions

SHOWN = 12
"""Constants in the table; a file has them all."""


def doubt_about(
    files: Sequence[str],
    crowd: CrowdOptions,
    rig: RigOptions,
    figure: SetFigureOptions,
    json: Path | None,
    unused: Mapping[str, object],
) -> None:
    """Study the icons of files on the rig: the table on stdout, other outputs on request."""
    for option, value in unused.items():
        if value:
            raise usage("belongs to a ranking; leave it out, or --doubt", option)
    if figure.figure is not None and figure.picture is None:
        raise usage("with --doubt there is one figure: name a .pdf, .svg or .png file", "--figure")
    from thermicon.perception.ranking.sensitivity import DRAWS, FEWEST_DRAWS, sensitivity

    if crowd.intervals is not None and crowd.intervals < FEWEST_DRAWS:
        raise usage(f"{crowd.intervals} draws are too few for --doubt: give {FEWEST_DRAWS} or more", "--intervals")
    icons = read_set(files)
    if len(icons) < 2:
        fail(f"{files[0]}: --doubt needs at least two icons, since one alone is never confused")
    where = rig.load()
    warn_of_frames(files, icons, where)
    model = crowd.load(where, "what carries the doubt is read from draws of a posterior")
    draws = check_draws(model, crowd.intervals, "--intervals", DRAWS, FEWEST_DRAWS)
    with progress_bar("doubt") as progress:
        found = sensitivity(
            icons,
            where,
            people=crowd.people,
            seed=crowd.seed,
            norm=crowd.norm,
            draws=draws,
            observer=model,
            progress=progress,
        )
    if json is not None:
        write_text(dumps(asdict(found), ensure_ascii=False, indent=1) + "\n", json)
    if figure.figure is not None:
        figure.write(found.plot().figure)
    if json != STDOUT:
        show(doubt_report(found, icons.title))


def doubt_report(found: Sensitivity, title: str) -> list[Block]:
    """Report one row per constant that counts, the most important first, and what to measure first."""
    numbers = ("correct", "bits", "correct low–high")
    rows = [
        (
            effect.constant,
            f"{effect.low:.3g} to {effect.high:.3g}{'' if effect.unit in ('', '1') else f' {effect.unit}'}",
            percent(effect.proportion_correct),
            percent(effect.information_bits),
            f"{percent(effect.at_low)} – {percent(effect.at_high)}",
        )
        for effect in found.effects[:SHOWN]
    ]
    what_if = f" with {', '.join(found.rig_changes)}" if found.rig_changes else ""
    crowd = count_of(found.people, "virtual person", "virtual people")
    lead = "Measure first, by the share of the variance of the proportion correct that would go:"
    return [
        *([Heading(title, 1)] if title else []),
        grid(("constant", "95 % of draws", *numbers), rows, numbers),
        Text(lead if found.first else "No measurement would narrow the prediction noticeably."),
        Bullets(tuple(f"{percent(each.proportion_correct)}: {each.measurement}" for each in found.first)),
        Text(
            "Shares of the variance between draws of the posterior; constants that trade off share theirs, so that "
            "shares need not add up to 100 %. Beside them the proportion correct expected at both ends of the "
            f"interval. {found.draws} draws for {crowd} on the {found.rig} rig{what_if} (seed {found.seed}, "
            f"{found.norm} norm): contact and outermost layer of the skin vary too, unlike in the intervals of rank."
        ),
    ]
