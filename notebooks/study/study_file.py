"""The schema of a study file: its keys with their bounds.

A study is identified by the hash of everything that decides it.
"""

import hashlib
import json
from collections import Counter
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from thermicon.base.files.inputs import LONGEST_NAME, InputError, Place, key_faults, one_line, read_text, read_toml
from thermicon.base.words.near_words import did_you_mean, nearest_words

Line = Annotated[str, AfterValidator(one_line)]
Name = Annotated[Line, Field(min_length=1, max_length=LONGEST_NAME)]
Label = Annotated[Line, Field(pattern=r"^[A-Za-z0-9]+$", min_length=1, max_length=30)]
"""Letters and digits alone: it becomes part of file names, where BIDS takes nothing else."""
Key = Annotated[Line, Field(pattern=r"^[a-z0-9]+$", max_length=20)]
"""The name of a key as PsychoPy calls it: space, escape, q."""

MOST_PARTICIPANTS, MOST_BLOCKS, MOST_REPETITIONS = 500, 100, 500
MOST_ASKED = 30
"""Icons that a person can be asked to name."""
Order = Literal["balanced", "williams", "random"]


class StudyTable(BaseModel):
    """A table of the file: unknown keys, wrong types and NaN are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Stimuli(StudyTable):
    """The stimuli of a study, and the rig that they are played on."""

    set: Name | None = None
    icons: Annotated[list[Name], Field(max_length=MOST_ASKED)] = []
    rig: Name | None = None
    rig_changes: Annotated[list[Line], Field(max_length=100)] = []
    device: Name = "ni-analogue-output"
    format: Literal["psychopy"] = "psychopy"


class Participants(StudyTable):
    """The participants of a study: a count, or labels."""

    count: Annotated[int | None, Field(ge=1, le=MOST_PARTICIPANTS)] = None
    labels: Annotated[list[Label] | None, Field(min_length=1, max_length=MOST_PARTICIPANTS)] = None


class StudyTrials(StudyTable):
    """Trials of each icon, and their order."""

    repetitions: Annotated[int, Field(ge=1, le=MOST_REPETITIONS)]
    blocks: Annotated[int, Field(ge=1, le=MOST_BLOCKS)] = 1
    practice: Annotated[int, Field(ge=0, le=20)] = 1
    order: Order = "balanced"


class Timing(StudyTable):
    """Pauses, and what they are derived from."""

    gap_s: Annotated[float | None, Field(ge=0, le=600)] = None
    carry_over_d_prime: Annotated[float, Field(gt=0, le=5)] = 1.0
    wait_for_skin: bool = False
    landing_s: Annotated[float | None, Field(ge=0, le=1800)] = None
    landing_from_K: Annotated[float, Field(gt=0, le=10)] = 2.5
    landing_within_K: Annotated[float, Field(ge=0.01, le=2)] = 0.1
    break_s: Annotated[float, Field(ge=0, le=3600)] = 60.0
    answer_s: Annotated[float, Field(ge=0, le=600)] = 0.0


class StudyRun(StudyTable):
    """The texts of the script, its keys and its line."""

    question: Annotated[Line | None, Field(min_length=1)] = None
    start_key: Key = "space"
    stop_key: Key = "q"
    abort_key: Key = "escape"
    marker: Annotated[Line, Field(pattern=r"^(none|serial:.+|parallel:.+|ni:.+)$")] = "none"


class Threshold(StudyTable):
    """A threshold measured by QUEST+ in place of trials in a given order."""

    direction: Literal["cool", "warm"]
    least_K: Annotated[float, Field(ge=0.02, le=10)] = 0.1
    most_K: Annotated[float, Field(ge=0.05, le=15)] = 4.0
    levels: Annotated[int, Field(ge=3, le=30)] = 12
    rate_K_per_s: Annotated[float, Field(gt=0, le=20)] = 2.0
    hold_s: Annotated[float, Field(ge=0, le=30)] = 3.0
    trials: Annotated[int, Field(ge=5, le=500)] = 40
    catch_share: Annotated[float, Field(ge=0, le=0.5)] = 0.2
    target: Annotated[float, Field(ge=0.4, le=0.8)] = 0.5


class Study(StudyTable):
    """A whole study file."""

    format: Literal[1]
    name: Label
    title: Annotated[Line, Field(max_length=LONGEST_NAME)] = ""
    stimuli: Stimuli
    participants: Participants
    trials: StudyTrials | None = None
    threshold: Threshold | None = None
    timing: Timing = Timing()
    run: StudyRun = StudyRun()


TABLES: dict[str, type[StudyTable]] = {
    "stimuli": Stimuli, "participants": Participants, "trials": StudyTrials, "timing": Timing, "run": StudyRun,
    "threshold": Threshold,
}  # fmt: skip
"""Tables of a study file by their keys, in the order of the reference."""

LIMIT_MB = 1.0
SHIPPED = "example-study.toml"
SHIPPED_NAMES = ("example", "example.toml", SHIPPED)
"""What the shipped study answers to where no file has that name."""

UNITS = {"_s": "s", "_K": "K", "_K_per_s": "K/s"}


class StudyError(InputError):
    """A study that cannot be made; the text says what, where, the value, the limit and the cure."""


def study_text(source: str | Path) -> str:
    """Return the text of a study file, or of the shipped example, which answers to `example`."""
    path = Path(source)
    if not path.exists() and str(source) in SHIPPED_NAMES:
        return resources.files("thermicon.notebooks").joinpath("data", SHIPPED).read_text(encoding="utf-8")
    return read_text(path, "study file", LIMIT_MB, StudyError)


def parse_study(text: str, where: str) -> Study:
    """Return a checked study, or raise StudyError with all faults at once, a line each.

    >>> parse_study(study_text("example"), "example").trials.order
    'balanced'
    """
    document = read_toml(text, where, "study file", ("stimuli",), StudyError)
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
    """Contradictions between keys, each in a sentence with the cure."""
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
    known: type[StudyTable] = TABLES.get(str(place[0]), Study) if len(place) > 1 else Study
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
