"""The schedule of a study: every trial with its planned time.

Limits on their number are checked before anything is simulated.
"""

import csv
import io
import itertools
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

from thermicon.circuit.safety.session_plan import LONGEST_S, MOST_PLAYS

from .orders import orders_of
from .study_file import Study, StudyError, labels_of


@dataclass(frozen=True, slots=True)
class Trial:
    """One play: `block` 0 is practice; `trial` counts the answers that are kept, from 1, and is 0 in practice."""

    block: int
    trial: int
    icon: str


@dataclass(frozen=True, slots=True)
class Schedule:
    """All trials of one participant."""

    label: str
    trials: tuple[Trial, ...]

    @property
    def order(self) -> tuple[str, ...]:
        """Names of the icons in the order of play."""
        return tuple(trial.icon for trial in self.trials)

    @property
    def breaks(self) -> int:
        """Number of breaks: one before every block but the first."""
        return len({trial.block for trial in self.trials} - {0, 1})

    @property
    def sittings(self) -> tuple[tuple[str, ...], ...]:
        """Orders of play between breaks: practice goes over into the first block, every other block is one."""
        numbers = dict.fromkeys(max(trial.block, 1) for trial in self.trials)
        return tuple(tuple(trial.icon for trial in self.trials if max(trial.block, 1) == number) for number in numbers)


def seed_of(study_hash: str) -> int:
    """The seed of all orders of a study, from its hash; 52 bits, which every reader of JSON keeps."""
    return int(study_hash[:13], 16)


def check_counts(study: Study, icons: int) -> None:
    """Raise StudyError for fewer icons than two, and for more plays than a session may have."""
    trials = study.trials
    if trials is None:
        return
    if icons < 2:
        raise StudyError(f"{icons} icon cannot be confused with another; a study of naming needs 2 or more")
    plays = icons * (trials.repetitions * trials.blocks + trials.practice)
    if plays > MOST_PLAYS:
        raise StudyError(
            f"trials: {icons} icons × ({trials.blocks} blocks × {trials.repetitions} repetitions + {trials.practice} "
            f"practice) are {plays:,} plays for each participant; a session has at most {MOST_PLAYS:,}: take fewer "
            f"repetitions, or split the study into sessions"
        )


def check_session_time(plays: int, mean_s: float, gap_s: float) -> None:
    """Raise StudyError where a participant would sit longer than a session may last."""
    total = plays * mean_s + (plays - 1) * gap_s
    if total > LONGEST_S:
        raise StudyError(
            f"{plays} plays of {mean_s:.3g} s with gaps of {gap_s:g} s last {total / 60:.0f} min for each participant; "
            f"the limit of a session is {LONGEST_S / 60:g} min: take fewer repetitions, or split the study into "
            f"sessions"
        )


def courses_of(study: Study, icons: tuple[str, ...], seed: int) -> tuple[Schedule, ...]:
    """Return the trials of every participant, none for a threshold; equal seeds give equal trials."""
    trials, labels = study.trials, labels_of(study)
    if trials is None:
        return ()
    count = len(icons)
    main = orders_of(trials.order, count, trials.repetitions, trials.blocks, len(labels), seed)
    first = orders_of("random", count, trials.practice, 1, len(labels), seed + 1) if trials.practice else None
    courses = []
    for who, label in enumerate(labels):
        blocks = [*(first[who] if first else ((),)), *main[who]]
        kept = itertools.count(1)
        played = [(block, place) for block, places in enumerate(blocks) for place in places]
        rows = tuple(Trial(block, next(kept) if block else 0, icons[place]) for block, place in played)
        courses.append(Schedule(label, rows))
    return tuple(courses)


@dataclass(frozen=True, slots=True)
class Pace:
    """The times between plays in s, as planned: landing of the hand, least gap, break between blocks."""

    landing_s: float
    gap_s: float
    break_s: float


@dataclass(frozen=True, slots=True)
class PlannedPlay:
    """When a play begins and ends in s from the start of the session, with answers that take no longer than the gap."""

    onset_s: float
    end_s: float


def planned_plays(course: Schedule, durations_s: Mapping[str, float], pace: Pace) -> tuple[PlannedPlay, ...]:
    """Return the planned times of a participant's plays; practice goes over into the first block without a break."""
    now, last, plays = 0.0, None, []
    for trial in course.trials:
        if last is None:
            now = pace.landing_s
        elif trial.block != last and last:
            now += pace.break_s + pace.landing_s
        else:
            now += pace.gap_s
        plays.append(PlannedPlay(now, now + durations_s[trial.icon]))
        now, last = plays[-1].end_s, trial.block
    return tuple(plays)


def planned_events(
    course: Schedule, plays: Sequence[PlannedPlay], files: Mapping[str, str], markers: Mapping[str, int]
) -> bytes:
    """The planned events of a participant as a table; answers are not known."""
    rows = [
        {
            "onset": f"{play.onset_s:.3f}", "duration": f"{play.end_s - play.onset_s:.3f}", "trial_type": trial.icon,
            "stim_file": files[trial.icon], "block": str(trial.block), "trial": str(trial.trial), "response": "n/a",
            "response_time": "n/a", "marker": str(markers[trial.icon]),
        }
        for trial, play in zip(course.trials, plays, strict=True)
    ]  # fmt: skip
    return table(list(event_columns()), rows, "\t")


def table(columns: Sequence[str], rows: Iterable[Mapping[str, str]], delimiter: str = ",") -> bytes:
    """A table as UTF-8 text with a header."""
    text = io.StringIO()
    writer = csv.DictWriter(text, list(columns), delimiter=delimiter, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode("utf-8")


def json_bytes(content: object) -> bytes:
    """Content as JSON text with an end of line."""
    return (json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode("utf-8")


def event_columns() -> dict[str, dict[str, Any]]:
    """The meaning of each column of a table of events, as BIDS describes it."""
    text = resources.files("thermicon.notebooks").joinpath("data", "study-events.json").read_text(encoding="utf-8")
    columns: dict[str, dict[str, Any]] = json.loads(text)
    return columns


def events_description(title: str, markers: Mapping[str, int], choices: Mapping[str, str]) -> bytes:
    """The description of the columns of events, and of the markers."""
    columns = {name: {**about} for name, about in event_columns().items()}
    columns["trial_type"]["Levels"] = {name: choices.get(name, name) for name in markers}
    columns["marker"]["Levels"] = {str(code): name for name, code in markers.items()} | columns["marker"]["Levels"]
    return json_bytes({"TaskName": title, **columns})
