"""The observer model: a nominal observer and the distributions around it.

Another than the shipped one is a table of posterior draws (.csv), or the records of one observer (.toml), which has no
draws and so no intervals for a new laboratory.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, Self, TypedDict, Unpack

from thermicon.base.checks.arguments import checked
from thermicon.base.files.inputs import InputError
from thermicon.base.files.records import RecordError, RecordTable

from .channels import CHANNELS, VARIABLES, MemoryChoice, MemoryForm, forms_in
from .draws import PosteriorDraws
from .observer import DATA, Observer, read_records, variant_records
from .people import People, draw_people

SHIPPED = "shipped"


@dataclass(frozen=True, slots=True)
class ObserverModel:
    """The observer of a file with its people and its posterior.

    `name` is that of the file, or `shipped`, and `digest` the SHA-256 of its text in hexadecimal. `nominal` is the most
    probable observer of the shipped posterior, the first draw of another. `records` are those of the observer, from
    which intervals of memory are read, `posterior` the draws of the constants (None: the file has none), `age_years`
    the age of all people (None: 20 to 30 years, as in the evidence).

    >>> ObserverModel.load().people(3, seed=1).memory.shape
    (3,)
    """

    name: str
    digest: str
    nominal: Observer = field(compare=False)
    records: RecordTable = field(compare=False)
    posterior: PosteriorDraws | None = field(compare=False)
    age_years: float | None = None

    @classmethod
    def of(cls, observer: ObserverModel | Path | str | None) -> ObserverModel:
        """A model as it is, that of a file, or, for None, the shipped one."""
        return observer if isinstance(observer, ObserverModel) else cls.load(observer)

    @classmethod
    def load(cls, path: Path | str | None = None) -> Self:
        """The shipped model, or that of a file: draws kept by ``thermicon pilot`` (.csv), or one observer's records.

        Raises `RecordError` for a file that cannot be read, is incomplete, or was made from other evidence.
        """
        if path is None:
            digest = hashlib.sha256((DATA / "observer.toml").read_bytes()).hexdigest()
            return cls(SHIPPED, digest, Observer.load(), variant_records(), PosteriorDraws.load())
        file, draws = Path(path), None
        try:
            if file.suffix.lower() == ".csv":
                draws = PosteriorDraws.load(file)
                if draws.variable != VARIABLES[0]:
                    raise RecordError(f"{file.name}: draws of {draws.variable}, not of {VARIABLES[0]}, the default")
                records, nominal = draws.table(0), draws.observer(0)
            else:
                records = read_records(file)
                nominal = Observer.from_table(records)
        except ValueError as wrong:  # a RecordError says in which file
            raise wrong if isinstance(wrong, RecordError) else RecordError(f"{file.name}: {wrong}") from None
        return cls(file.name, hashlib.sha256(file.read_bytes()).hexdigest(), nominal, records, draws)

    def form_shares(self, memory: MemoryChoice) -> dict[MemoryForm, float]:
        """The share of laboratories with each form of memory that counts: even; of a kept one, the form it has itself.

        Its other draws have constants of their own, with which theirs goes.

        >>> ObserverModel.load().form_shares("both")
        {'episodes': 0.5, 'naming': 0.5}
        """
        forms, held = forms_in(memory), None if self.posterior is None else self.posterior.forms
        if held is None or len(forms) == 1:
            return dict.fromkeys(forms, 1.0 / len(forms))
        return {held[0]: 1.0}

    def most_draws(self, wanted: int) -> int:
        """As many draws as are wanted, or as many as there are."""
        return 0 if self.posterior is None else min(wanted, len(self.posterior))

    def draw_count(self, asked: int | None, usual: int) -> int:
        """How many draws an interval is made of: those asked for, the usual number, or as many as there are."""
        if asked is not None and (asked < 0 or asked == 1):
            raise ValueError(f"an interval needs at least two draws of the parameters, or 0 for none, not {asked}")
        if self.posterior is None or asked is None:
            return self.most_draws(usual)
        if asked > len(self.posterior):
            raise ValueError(f"{asked} draws of the parameters were asked for; {self.name} has {len(self.posterior)}")
        return asked

    def some_draws(self, count: int) -> list[Observer]:
        """Observers of so many evenly spaced draws; none where there are no draws."""
        held = self.posterior
        return [] if held is None else [held.observer(k) for k in held.spaced(count)]

    @property
    def drawn(self) -> PosteriorDraws:
        """The posterior draws; a ValueError for an observer without them."""
        if self.posterior is None:
            raise ValueError(f"{self.name} has no posterior draws, from which an interval for a new laboratory is made")
        return self.posterior

    def people(self, n: int, seed: int = 0) -> People:
        """Virtual people who differ as this model says; person i is the same whatever n is."""
        return draw_people(n, seed, age_years=self.age_years, observer=self.nominal)

    def aged(self, age_years: float) -> ObserverModel:
        """The same model for people of an age, 18 to 100 years: their thresholds are higher."""
        for channel in CHANNELS:
            self.nominal.age_factor(age_years, channel)
        return replace(self, age_years=age_years)

    @property
    def key(self) -> str:
        """The identity of the model for hashes; empty for the shipped one, whose data belong to the program."""
        own = "" if self.name == SHIPPED else self.digest
        return own if self.age_years is None else f"{own} people of {self.age_years:g} years"

    def __repr__(self) -> str:
        draws = "no posterior draws" if self.posterior is None else f"{len(self.posterior)} posterior draws"
        return f"ObserverModel({self.name}, {draws})"


Tracking = Literal["replay", "display", "ideal"]
AnyObserver = ObserverModel | Path | str


class CrowdWords(TypedDict, total=False):
    """The words of a `Crowd` as keywords of a function."""

    people: int
    seed: int
    tracking: Tracking | None
    memory: MemoryChoice
    observer: AnyObserver | None


@checked
@dataclass(frozen=True, slots=True)
class Crowd:
    """Virtual people who feel and remember icons: the argument `crowd` of `rank` and others, or its fields by name.

    Attributes
    ----------
    people
        Number of virtual people; `plan` and `observed` have the participants of every laboratory instead.
    seed
        Seed of the people and of all noise.
    tracking
        What every virtual person receives: `replay` (the same current), `display` (the same display temperature) or
        `ideal` (the same skin temperature); None: by the control of each icon.
    memory
        Form of memory: `episodes` (compared in logarithms), `naming` (as ratings, each trial named directly), or
        `both`: shares are the mean over both, and each laboratory has one of them with even odds.
    observer
        Another observer with its posterior, or the file of one; None: the shipped one. One without draws gives no
        intervals for a new laboratory.

    Raises
    ------
    InputError
        For fewer than one person, a negative seed, and words that there are not.

    Examples
    --------
    >>> Crowd(people=50).but(seed=3)
    Crowd(people=50, seed=3, tracking=None, memory='both', observer=None)
    """

    people: int = 200
    seed: int = 0
    tracking: Tracking | None = None
    memory: MemoryChoice = "both"
    observer: AnyObserver | None = None

    def __post_init__(self) -> None:
        if self.people < 1:
            raise InputError(f"at least one person is needed, not {self.people}")
        if self.seed < 0:
            raise InputError(f"a seed is 0 or more, not {self.seed}")

    def but(self, **words: Unpack[CrowdWords]) -> Crowd:
        """The same crowd with some words changed."""
        return replace(self, **words)

    @property
    def model(self) -> ObserverModel:
        """The observer with its people and its posterior."""
        return ObserverModel.of(self.observer)


EVERYBODY = Crowd()
"""Who feels icons unless anything else is asked for."""
