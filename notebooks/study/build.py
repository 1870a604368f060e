"""The plan of a study from its file."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from thermicon.base.words.near_words import did_you_mean
from thermicon.base.words.number_text import count_of
from thermicon.circuit import Device, Rig
from thermicon.circuit.delivery.formats import FormatError, load_format
from thermicon.circuit.delivery.pack import check_names
from thermicon.circuit.solver.simulate import duration_s
from thermicon.icons import Icon, IconSet, read_cue
from thermicon.icons.model.context import Context, Metadata
from thermicon.icons.model.statements import Hold, Ramp, Return

from .judging import JudgedStudy, Progress, judge_drives, judge_sessions
from .schedule import Schedule, Trial, check_counts, check_session_time, courses_of, seed_of
from .study_file import (
    MOST_ASKED,
    Stimuli,
    Study,
    StudyError,
    Threshold,
    labels_of,
    parse_study,
    study_hash,
    study_text,
)
from .timing import Landing, find_gap, find_landing

ProgressBar = Callable[..., AbstractContextManager[Progress | None]]

FELT, UNFELT = "felt", "not-felt"
"""Answers in a threshold run."""

MOST_SUGGESTED = 2000
"""In a larger set, the names of families are suggested in place of those of their members."""


@dataclass(frozen=True, slots=True)
class Materials:
    """A checked study with everything that it names, read: `text` is that of its file."""

    study: Study
    text: str
    icons: IconSet
    chosen: tuple[Icon, ...]
    rig: Rig
    device: Device
    sha256: str

    @property
    def seed(self) -> int:
        """The seed of all orders."""
        return seed_of(self.sha256)


@dataclass(frozen=True, slots=True)
class Plan:
    """Everything that a study's folder is written from."""

    materials: Materials
    judged: JudgedStudy
    landing: Landing
    courses: tuple[Schedule, ...]

    @property
    def durations_s(self) -> dict[str, float]:
        """How long each drive plays."""
        return {one.delivery.icon.name: one.delivery.file_s for one in self.judged.ready.prepared}


def read_materials(source: str | Path) -> Materials:
    """Read a study file and what it names, beside it or shipped; every fault is raised before anything is simulated."""
    text = study_text(source)
    study = parse_study(text, str(source))
    folder = Path(source).parent
    stimuli = study.stimuli
    if study.threshold:
        rig = _rig_of(stimuli, folder, None)
        icons = level_icons(study.threshold, rig)
    else:
        icons = read_cue(_beside(stimuli.set or "", folder))
        rig = _rig_of(stimuli, folder, icons.context.site)
    device, form = Device.load(_beside(stimuli.device, folder)), load_format(stimuli.format)
    try:
        form.check(device)
    except FormatError as problem:
        raise StudyError(f"{source}: stimuli.device: {problem}") from None
    for name in stimuli.icons:
        if icons.find(name) is None:
            known = [icon.name for icon in (icons if len(icons) <= MOST_SUGGESTED else icons.entries)]
            raise StudyError(f"{source}: stimuli.icons: there is no icon {name}; {did_you_mean(name, known)}")
    check_counts(study, len(stimuli.icons) or len(icons))
    if not stimuli.icons and len(icons) > MOST_ASKED:
        raise StudyError(
            f"{source}: the set has {len(icons):,} icons, and a person can be asked for {MOST_ASKED}; name some"
        )
    chosen = tuple(icons[name] for name in stimuli.icons) if stimuli.icons else tuple(icons)
    check_names([icon.name for icon in chosen], form)
    contents = {
        "icons": icons.content_hash,
        "rig": rig.document,
        "device": json.dumps(asdict(device), sort_keys=True, default=str),
    }
    return Materials(study, text, icons, chosen, rig, device, study_hash(study, contents))


def _rig_of(stimuli: Stimuli, folder: Path, site: str | None) -> Rig:
    """The rig of a study with its changes; unless one is named, the usual one for a site."""
    rig = Rig.of(None if stimuli.rig is None else _beside(stimuli.rig, folder), site)
    return rig.with_set(list(stimuli.rig_changes)) if stimuli.rig_changes else rig


def _beside(name: str, folder: Path) -> str:
    """A file that stands beside the study; any other name as it is."""
    place = folder / name
    return str(place) if place.is_file() else name


def make_plan(materials: Materials, bar: ProgressBar, say: Callable[[str], None] = lambda _: None) -> Plan:
    """Derive the pauses, order the trials, and judge drives and sessions; raises StudyRefused, StudyError, InputError.

    `say` receives the plan before the verdicts, which take most of the time.
    """
    study, rig, icons = materials.study, materials.rig, materials.chosen
    held = materials.device.kind.regulated
    mean_s = sum(duration_s(icon, rig) for icon in icons) / len(icons)
    plays = plays_of(study, len(icons))
    check_session_time(plays, mean_s, study.timing.gap_s or 0.0)
    with bar("gap") as progress:
        gap = find_gap(icons, rig, study.timing, held, progress)
    check_session_time(plays, mean_s, gap.gap_s)
    landing = find_landing(icons[0], rig, study.timing, held)
    courses = courses_of(study, tuple(icon.name for icon in icons), materials.seed)
    minutes = (landing.landing_s + plays * mean_s + (plays - 1) * gap.gap_s) / 60.0
    say(
        f"planned: {count_of(len(labels_of(study)), 'participant', 'participants')}, {plays} plays each, about "
        f"{minutes:.0f} min each, gap {gap.gap_s:g} s: {gap.reason}; judging drives and sessions …"
    )
    whole_min = math.ceil((plays * mean_s + (plays - 1) * gap.gap_s) / 60.0)
    if rig.thermode is not None and 60.0 * whole_min > rig.limits.session_s:
        # Its session is judged by its gate alone: doses then add up over all of it.
        rig = rig.with_(**{"safety.session_min": float(whole_min)})
    with bar("drives", "judging all together") as progress:
        ready, gap = judge_drives(icons, rig, study, gap, materials.device, progress)
    check_session_time(plays, mean_s, gap.gap_s)
    orders = courses
    if study.threshold is not None:  # the worst that can come: the greatest step in every trial
        numbers = range(1, study.threshold.trials + 1)
        orders = (Schedule("any", tuple(Trial(1, number, icons[-1].name) for number in numbers)),)
    with bar("sessions", "summing up") as progress:
        judged = judge_sessions(orders, icons, rig, held, gap.gap_s, progress)
    return Plan(materials, JudgedStudy(ready, gap, *judged), landing, courses)


def plays_of(study: Study, icons: int) -> int:
    """Number of plays of one participant."""
    if study.threshold is not None:
        return study.threshold.trials
    assert study.trials is not None
    return icons * (study.trials.repetitions * study.trials.blocks + study.trials.practice)


def levels_K(threshold: Threshold) -> tuple[float, ...]:
    """Changes in K, from the smallest to the greatest, rounded to 1 mK."""
    spaced = np.geomspace(threshold.least_K, threshold.most_K, threshold.levels)
    return tuple(round(float(change), 3) for change in spaced)


def level_icons(threshold: Threshold, rig: Rig) -> IconSet:
    """Return the steps as a set of icons for the display, from the skin's rest, named after their place."""
    verb, rate = threshold.direction, threshold.rate_K_per_s
    context, icons = Context("display", rig.skin.rest_C, rig.site), []
    for place, change_K in enumerate(levels_K(threshold), 1):
        hold = (Hold(threshold.hold_s),) if threshold.hold_s else ()
        body = (Ramp(verb, by_K=change_K, rate_K_per_s=rate), *hold, Return(rate))
        known = Metadata(means=f"a change of {change_K:g} K", by="thermicon")
        icons.append(Icon(f"{verb}-{place:02d}", body, context, known))
    return IconSet(f"steps-{verb}", "Steps for a threshold", context, Metadata(), tuple(icons))
