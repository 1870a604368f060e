"""Every trial of every participant, in order, with limits on their number checked before anything is simulated."""

from __future__ import annotations

from dataclasses import dataclass

from thermicon.circuit.safety.sessionplan import LONGEST_S, MOST_PLAYS

from .keys import Study
from .orders import orders_of
from .study_file import StudyError, labels_of


@dataclass(frozen=True, slots=True)
class Trial:
    """One play: `block` 0 is practice; `trial` counts the answers that are kept, from 1, and is 0 in practice."""

    place: int
    block: int
    trial: int
    icon: str

    def __post_init__(self) -> None:
        if (self.block == 0) != (self.trial == 0):
            raise ValueError(f"trial {self.trial} in block {self.block}: practice alone has neither number")


@dataclass(frozen=True, slots=True)
class Course:
    """All trials of one participant."""

    label: str
    trials: tuple[Trial, ...]

    def __repr__(self) -> str:
        return f"Course({self.label}: {len(self.trials)} plays in {len(self.blocks)} blocks)"

    @property
    def order(self) -> tuple[str, ...]:
        """Names of the icons in the order of play."""
        return tuple(trial.icon for trial in self.trials)

    @property
    def blocks(self) -> tuple[int, ...]:
        """Numbers of the blocks in order, 0 for practice."""
        return tuple(dict.fromkeys(trial.block for trial in self.trials))

    @property
    def breaks(self) -> int:
        """Number of breaks: one before every block but the first."""
        return len(set(self.blocks) - {0, 1})

    @property
    def sittings(self) -> tuple[tuple[str, ...], ...]:
        """Orders of play between breaks: practice goes over into the first block, every other block is one.

        >>> Course("A", (Trial(1, 0, 0, "a"), Trial(2, 1, 1, "b"), Trial(3, 2, 2, "a"))).sittings
        (('a', 'b'), ('a',))
        """
        numbers = dict.fromkeys(max(trial.block, 1) for trial in self.trials)
        return tuple(tuple(trial.icon for trial in self.trials if max(trial.block, 1) == number) for number in numbers)


def seed_of(study_hash: str) -> int:
    """The seed of all orders of a study, from its hash; 52 bits, which every reader of JSON keeps.

    >>> seed_of("ff" * 32)
    4503599627370495
    """
    return int(study_hash[:13], 16)


def check_counts(study: Study, icons: int) -> None:
    """Raise StudyError for fewer icons than two, and for more plays than a session may have.

    >>> from .study_file import parse_study, study_text
    >>> check_counts(parse_study(study_text("example"), "example"), 6)
    """
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


def courses_of(study: Study, icons: tuple[str, ...], seed: int) -> tuple[Course, ...]:
    """Return the trials of every participant; equal seeds give equal trials.

    >>> from .study_file import parse_study, study_text
    >>> courses_of(parse_study(study_text("example"), "example"), ("dip", "glow"), 1)[0]
    Course(01: 6 plays in 3 blocks)
    """
    trials, labels = study.trials, labels_of(study)
    if trials is None:
        raise ValueError("a threshold has no trials in a given order")
    count = len(icons)
    main = orders_of(trials.order, count, trials.repetitions, trials.blocks, len(labels), seed)
    first = orders_of("random", count, trials.practice, 1, len(labels), seed + 1) if trials.practice else None
    courses = []
    for who, label in enumerate(labels):
        blocks = [*(first[who] if first else ((),)), *main[who]]
        rows: list[Trial] = []
        for block, places in enumerate(blocks):
            for place in places:
                number = sum(row.block > 0 for row in rows) + 1 if block else 0
                rows.append(Trial(len(rows) + 1, block, number, icons[place]))
        courses.append(Course(label, tuple(rows)))
    return tuple(courses)
