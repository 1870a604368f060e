"""Tables of a study as BIDS writes them: events with a description of every column, participants, the data set."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from .schedule import Course

BIDS_VERSION = "1.10.0"


@dataclass(frozen=True, slots=True)
class Pace:
    """The times between plays in s, as planned: landing of the hand, least gap, break between blocks."""

    landing_s: float
    gap_s: float
    break_s: float


@dataclass(frozen=True, slots=True)
class PlannedPlay:
    """When a play begins and ends in s from the start of the session, with answers that take no longer than the gap."""

    place: int
    onset_s: float
    end_s: float


def planned_plays(course: Course, durations_s: Mapping[str, float], pace: Pace) -> tuple[PlannedPlay, ...]:
    """Return the planned times of a participant's plays; a block begins with the landing of the hand.

    Practice goes over into the first block, the hand on the display.

    >>> from .schedule import Trial
    >>> course = Course("01", (Trial(1, 1, 1, "dip"), Trial(2, 2, 2, "dip")))
    >>> [play.onset_s for play in planned_plays(course, {"dip": 8.0}, Pace(60.0, 30.0, 100.0))]
    [60.0, 228.0]
    """
    now, last, plays = 0.0, None, []
    for trial in course.trials:
        if last is None:
            now = pace.landing_s
        elif trial.block != last and last:
            now += pace.break_s + pace.landing_s
        else:
            now += pace.gap_s
        plays.append(PlannedPlay(trial.place, now, now + durations_s[trial.icon]))
        now, last = plays[-1].end_s, trial.block
    return tuple(plays)


def planned_events(
    course: Course, plays: Sequence[PlannedPlay], files: Mapping[str, str], markers: Mapping[str, int]
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
    return table(list(EVENT_COLUMNS), rows, "\t")


def table(columns: Sequence[str], rows: Iterable[Mapping[str, str]], delimiter: str = ",") -> bytes:
    r"""A table as UTF-8 text with a header.

    >>> table(["a"], [{"a": "1"}])
    b'a\n1\n'
    """
    text = io.StringIO()
    writer = csv.DictWriter(text, list(columns), delimiter=delimiter, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode("utf-8")


def json_bytes(content: object) -> bytes:
    """Content as JSON text with an end of line."""
    return (json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode("utf-8")


EVENT_COLUMNS = {
    "onset": {"Description": "Start of the play, from the start of the session", "Units": "s"},
    "duration": {"Description": "Duration of the drive, or of the silence of a catch trial", "Units": "s"},
    "trial_type": {"Description": "Name of the icon that was played"},
    "stim_file": {"Description": "Drive that was played, in the folder stimuli; its sidecar has the name of the icon"},
    "block": {"Description": "Number of the block; 0 is practice, which does not count"},
    "trial": {"Description": "Number of the trial in the file of answers; 0 in practice"},
    "response": {"Description": "Name of the icon that was answered; n/a where no answer came"},
    "response_time": {"Description": "Time of the answer, from the start of the play", "Units": "s"},
    "marker": {"Description": "Code that was put on the marker line at the onset"},
}


def events_description(title: str, markers: Mapping[str, int], choices: Mapping[str, str]) -> bytes:
    """The description of the columns of events, and of the markers."""
    levels = {name: choices.get(name, name) for name in markers}
    columns: dict[str, dict[str, object]] = {name: {**about} for name, about in EVENT_COLUMNS.items()}
    columns["trial_type"]["Levels"] = levels
    columns["marker"]["Levels"] = {str(code): name for name, code in markers.items()} | {
        "100 + code": "answer with that code",
        "240": "start of a block",
        "241": "start of practice",
        "255": "aborted",
    }
    return json_bytes({"TaskName": title, **columns})


def dataset_description(title: str, version: str) -> bytes:
    """What BIDS wants to know of a data set."""
    return json_bytes(
        {
            "Name": title,
            "BIDSVersion": BIDS_VERSION,
            "DatasetType": "raw",
            "GeneratedBy": [{"Name": "thermicon", "Version": version}],
        }
    )


def participants_table(labels: Sequence[str]) -> bytes:
    """The participants, one a row."""
    return table(["participant_id"], [{"participant_id": f"sub-{label}"} for label in labels], "\t")
