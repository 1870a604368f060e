"""``thermicon study``: the files of a whole experiment from one study file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thermicon.base.words.number_text import count_of, number

from ..loading import warn_of_rig
from ..messages import REFUSED, note, progress_bar
from ..report.gate_words import CAUTION
from .options import RigOptions, command_text, out

if TYPE_CHECKING:
    from ..study.build import Plan

LONG_S = 3600.0
LONG = (
    "{minutes} min each is long for one visit: take fewer trials.repetitions or trials.blocks, a shorter gap "
    "(timing.gap_s, or more timing.carry_over_d_prime), or part the icons or blocks into two studies"
)
"""Attention and answers suffer in sessions of more than an hour; ways to a shorter one."""
WORTH_DRAWS = 100
"""Laboratories that are simulated to say what answers could tell."""
KEPT = "give another folder with -o, such as -o study-2"


def study_command(
    file: Annotated[str, typer.Argument(metavar="STUDY.toml", help="A study file, or example for the shipped one.")],
    folder: Annotated[Path, out("DIR", "Folder for the files of the study.", "-o", "--output")],
) -> None:
    """Prepare an experiment: orders, pauses, judged drives, a PsychoPy script, and tables of events.

    Pauses are derived from simulated carry-over, orders from the content of the file. A study with a drive or a session
    that is not safe is refused with the reason; then nothing is written, and the exit code is 3.
    """
    from thermicon.circuit.delivery.export_folder import check_export_folder, publish

    from ..study.build import make_plan, read_materials
    from ..study.contents import files_of
    from ..study.judging import StudyRefused

    materials = read_materials(file)
    _check_free(folder)
    check_export_folder(folder, how=KEPT)
    warn_of_rig(materials.rig)
    try:
        plan = make_plan(materials, progress_bar, note)
        files = files_of(plan)
    except StudyRefused as refused:
        for reason in refused.reasons:
            note(f"refused: {reason}", always=True)
        note(CAUTION)
        note("nothing was written", always=True)
        raise typer.Exit(REFUSED) from None
    publish(files, folder, how=KEPT)
    for line in (*report_lines(plan), *worth_lines(plan)):
        typer.echo(line)
    note(f"wrote {len(files)} files into {folder}")
    note(CAUTION)
    if materials.study.stimuli.set is not None:
        rig = RigOptions(materials.study.stimuli.rig, materials.study.stimuli.rig_changes or None)
        command = command_text([materials.study.stimuli.set], rig, paths=True, command="pilot")
        note(f"Next, with the answers: {command} --answers FILE.csv")


def _check_free(folder: Path) -> None:
    """Raise OutputError for a folder that holds a study already; answers of participants are named."""
    from thermicon.base.files.atomic import OutputError

    if not (folder / "study.json").is_file():
        return
    people = len(list((folder / "data").glob("sub-*_answers.csv")))
    held = f"the answers of {people} participant{'s' if people > 1 else ''} (data/)" if people else "a study"
    raise OutputError(f"{folder} holds {held} already and was kept; {KEPT}")


def report_lines(plan: Plan) -> list[str]:
    """The plan and its verdicts, in lines for people."""
    from ..study.build import plays_of
    from ..study.contents import planned_s
    from ..study.study_file import labels_of

    study, judged, landing = plan.materials.study, plan.judged, plan.landing
    gap, labels = judged.gap, labels_of(study)
    plays = plays_of(study, len(plan.materials.chosen))
    people = count_of(len(labels), "participant")
    (before, after), left = gap.carried_by, number(gap.carry_over_d_prime, 2)
    kind = f"{study.trials.order} order" if study.trials else "QUEST+"
    minutes = number(planned_s(plan) / 60.0)
    cautions = list(judged.cautions)
    if planned_s(plan) > LONG_S:
        cautions.insert(0, LONG.format(minutes=minutes))
    lines = [
        study.title or study.name,
        f"  trials    {people}, {plays} plays each, {kind}, seed {plan.materials.seed}",
        f"  time      {minutes} min each, landing and breaks included, if answers come within the gap",
        f"  gap       {number(gap.gap_s)} s: {gap.reason}",
        f"            the icon before still changes it by d′ = {left} at most ({after} after {before})",
        *_gap_rows(plan),
        f"  landing   {number(landing.landing_s)} s{'' if landing.derived else ', given'}: skin that arrives "
        f"{number(landing.from_K)} K off is then {number(landing.left_K, 2)} K off "
        f"({number(landing.left_at_10_s_K, 2)} K after 10 s)",
        f"  drives    {_colours(plan)}",
    ]
    for label, session in judged.sessions.items():
        lines.append(
            f"  session   {label}: {session.verdict} in {session.scenarios} scenarios, baseline drift "
            f"{number(session.baseline_drift_K, 2)} K, dose {session.dose_cem43_min:.2g} min CEM43"
        )
    if not judged.sessions:
        lines.append("  session   judged by its drives alone, repeated in any order: a thermode has no current")
    elif len(judged.sessions) < len(judged.drift_K):
        lines.append(
            f"            of {len(judged.drift_K)} orders, those with the coldest and the warmest skin, the largest "
            "dose and the largest drift are run in all corners of uncertainty; the others on the rig as given alone"
        )
    if judged.after_breaks:
        colours = dict.fromkeys(blocks.colour for blocks in judged.after_breaks.values())
        blocks_from_rest = "with each block from rest, as after a long break"
        lines.append(f"            (orders without their breaks); {blocks_from_rest}: {' and '.join(colours)}")
    return [*lines, *(f"  caution   {text}" for text in cautions)]


def worth_lines(plan: Plan) -> list[str]:
    """What its answers could tell of the laboratory, where icons are named; and the measurement that tells most."""
    from thermicon.perception.pilot.plan import plan as planned

    from ..study.build import plays_of
    from ..study.study_file import labels_of

    study, icons = plan.materials.study, plan.materials.chosen
    people, plays = len(labels_of(study)), plays_of(study, len(icons))
    if not study.trials or len(icons) < 2 or people < 2:
        return []
    with progress_bar("simulating laboratories") as progress:
        expected = planned(
            icons, plan.materials.rig, participants=[people], trials=[plays], draws=WORTH_DRAWS, progress=progress
        )
    answers, measured = expected.designs[0].narrower, expected.worth[0]
    return [
        f"  worth     its answers make the 95 % of laboratories of the per cent named {answers:.1f} times narrower, at "
        f"most; {measured.data} {measured.narrower:.2f} times"
    ]


def _gap_rows(plan: Plan) -> list[str]:
    """Gaps beside the chosen one, which is marked: what carries over, and how long a participant would sit."""
    from ..study.contents import planned_s

    gap = plan.judged.gap
    known = {**dict(gap.tried), gap.gap_s: gap.carry_over_d_prime}
    shorter, longer = ([each for each in sorted(known) if sign * (each - gap.gap_s) > 0] for sign in (-1, 1))
    rows = ["                gap  carry-over  minutes"] if gap.tried else []
    for each in [*shorter[:1], gap.gap_s, *longer[1::2][:2]] if gap.tried else []:
        sat = replace(plan, judged=replace(plan.judged, gap=replace(gap, gap_s=each)))
        left, mark = number(known[each], 2), "*" if each == gap.gap_s else " "
        rows.append(f"          {mark} {number(each):>5} s  d′ {left:>7}  {number(planned_s(sat) / 60.0):>7}")
    return rows


def _colours(plan: Plan) -> str:
    """Numbers of green and amber drives, in any order with this gap."""
    colours = [one.verdict.colour for one in plan.judged.ready.prepared]
    counts = ", ".join(f"{colours.count(colour)} {colour}" for colour in ("green", "amber") if colour in colours)
    return f"{counts}, repeated in any order for the device {plan.materials.device.name}"
