"""A study file at the door: read, checked as a whole, and identified by the hash of everything that decides a study."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Mapping
from importlib import resources
from pathlib import Path

from pydantic import ValidationError

from thermicon.circuit.inputs import InputError, Place, key_faults, read_text, read_toml
from thermicon.icons.near_words import did_you_mean, nearest_words

from .keys import TABLES, Study, Table

LIMIT_MB = 1.0
SHIPPED = "example-study.toml"
SHIPPED_NAMES = ("example", "example.toml", SHIPPED)
"""What the shipped study answers to where no file has that name."""

UNITS = {"_s": "s", "_K": "K", "_K_per_s": "K/s"}


class StudyError(InputError):
    """A study that cannot be made; the text says what, where, the value, the limit and the cure."""


def study_text(source: str | Path) -> str:
    """Return the text of a study file, or of the shipped example, which answers to `example`.

    Raises StudyError for a file that is missing or is not UTF-8 text.
    """
    path = Path(source)
    if not path.exists() and str(source) in SHIPPED_NAMES:
        return resources.files("thermicon.notebooks").joinpath("data", SHIPPED).read_text(encoding="utf-8")
    return read_text(path, "study file", LIMIT_MB, StudyError)


def parse_study(text: str, where: str) -> Study:
    """Return a checked study, or raise StudyError with all faults at once, a line each.

    >>> parse_study(study_text("example"), "example").trials.order
    'balanced'
    """
    document = read_toml(text, where, StudyError)
    try:
        study = Study.model_validate(document)
    except ValidationError as problem:
        findings = key_faults(problem, _nearest, _unit_of, _shape)
    else:
        findings = _faults(study)
        if not findings:
            return study
    raise StudyError("\n".join(f"{where}: {finding}" for finding in findings))


def labels_of(study: Study) -> tuple[str, ...]:
    """Labels of the participants, in order."""
    people = study.participants
    if people.labels is not None:
        return tuple(people.labels)
    count = people.count or 0
    width = max(2, len(str(count)))
    return tuple(f"{k:0{width}d}" for k in range(1, count + 1))


def study_hash(study: Study, contents: Mapping[str, str]) -> str:
    """SHA-256 of everything that decides a study: its keys, with defaults, and the content of what it names."""
    whole = {"study": study.model_dump(mode="json"), "contents": dict(contents)}
    text = json.dumps(whole, sort_keys=True, ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def _faults(study: Study) -> list[str]:
    """What is wrong between keys, a sentence each with the cure."""
    people, stimuli, threshold, run = study.participants, study.stimuli, study.threshold, study.run
    labels = Counter(label.casefold() for label in people.labels or ())
    keys = Counter((run.start_key, run.stop_key, run.abort_key))
    found = [
        ((people.count is None) == (people.labels is None), "participants: give either count or labels"),
        *(
            (times > 1, f"participants.labels: {label} appears {times} times; each participant has one label")
            for label, times in labels.items()
        ),
        *(
            (times > 1, f"stimuli.icons: {icon} appears {times} times; trials.repetitions says how often it is played")
            for icon, times in Counter(stimuli.icons).items()
        ),
        ((study.trials is None) == (threshold is None), "give either [trials], for naming icons, or [threshold]"),
        (
            study.trials is not None and stimuli.set is None,
            'stimuli.set is missing; add a cue file or the name of a shipped set, as in set = "six-icons"',
        ),
        (
            threshold is not None and bool(stimuli.set is not None or stimuli.icons),
            "stimuli: a threshold is measured with steps of its own; leave out set and icons",
        ),
        *((times > 1, f"run: {key} is the key for two things; give each its own") for key, times in keys.items()),
    ]
    if threshold is not None and not threshold.least_K < threshold.most_K:
        least, most = f"threshold.least_K = {threshold.least_K:g} K", f"threshold.most_K = {threshold.most_K:g} K"
        found.append((True, f"{least} is not below {most}"))
    return [sentence for wrong, sentence in found if wrong]


def _unit_of(key: str) -> str:
    return next((unit for end, unit in reversed(UNITS.items()) if key.endswith(end)), "")


def _nearest(place: Place) -> str:
    """The known key nearest to an unknown one, also where it stands in the wrong table."""
    known: type[Table] = TABLES.get(str(place[0]), Study) if len(place) > 1 else Study
    word = str(place[-1])
    if not nearest_words(word, known.model_fields, cutoff=0.55):
        for name, table in TABLES.items():
            if word in table.model_fields:
                return f"it belongs to [{name}]"
    return did_you_mean(word, known.model_fields)


def _shape(key: str) -> str:
    last = key.rpartition(".")[2]
    if last == "marker":
        return "must be none, serial:PORT, parallel:ADDRESS or ni:LINES"
    if last.endswith("_key"):
        return "must be the name of a key in small letters, such as space, escape or q"
    return "must have letters and digits alone, since it becomes part of file names"
