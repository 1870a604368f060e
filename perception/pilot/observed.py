"""The prediction conditioned on the answers or measurements of a laboratory's own participants."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar, Unpack

import numpy as np

from thermicon.base.checks.arguments import InputError, checked
from thermicon.base.numbers.program import own_version
from thermicon.base.results.drawn import Drawn, Tabled
from thermicon.circuit.rig.rig import AnyRig, Rig
from thermicon.icons import IconSet
from thermicon.icons.files.shipped import Icons, set_of

from ..experiments.measure import Setting
from ..identification.pairs import pair_scores
from ..kernels.parallel import Progress, step_counter
from ..observer.channels import MEMORY_FORMS, MemoryForm, forms_in
from ..observer.draws import PosteriorDraws
from ..observer.observer_model import EVERYBODY, Crowd, CrowdWords
from .conditioning import Conditioned, MeasuredValues, Namings, condition
from .evened import evened
from .laboratory_file import laboratory_draws, laboratory_texts
from .measurements_file import Measurements
from .pair_posterior import known_scores
from .playing import Confusions, Stage, laboratories_for, stage
from .prediction import ChangedConstant, ChangedPrediction, Fit, MeasurementFit, SetPrediction, changed
from .states import LaboratoryPrior
from .trials import Trials

DRAWS, LEAST_DRAWS = 1000, 20
D = TypeVar("D", Namings, MeasuredValues)
F = TypeVar("F", Fit, MeasurementFit)


@dataclass(frozen=True, slots=True, eq=False)
class Observed(Drawn, Tabled, Generic[D, F]):
    """Answers or measurements of participants, their fit to the prediction, and the prediction after them.

    Attributes
    ----------
    data
        The answers (`data.trials`) with scores of all together (`data.pooled`) and of each (`data.each`), or the
        values (`data.measurements`).
    fit, fit_after
        The data beside what was predicted before, and beside what is predicted after they were seen (None: they have
        no usable likelihood, and `unusable` says why).
    predictions
        The set, and then other sets, before and after.
    constants
        Constants that moved or narrowed, the most changed first.
    conditioned
        Laboratories behind all of it, and the effective sample size.
    """

    data: D
    fit: F
    fit_after: F | None
    predictions: tuple[ChangedPrediction, ...]
    constants: tuple[ChangedConstant, ...]
    conditioned: Conditioned
    confusions_after: Confusions
    prior: LaboratoryPrior
    played: Stage
    rig: str
    rig_changes: tuple[str, ...]
    memory: str
    seed: int
    version: str

    @property
    def unusable(self) -> str:
        """Why the data could not sharpen the prediction, what they say alone, and the cure; empty where they did."""
        why, noun = self.conditioned.unusable, self.data.noun
        return why and (
            f"The likelihood of the {noun} cannot be used: {why}. The prediction is not sharpened by them, and the "
            f"{noun} alone are given: {self.data.alone}. Check the table for numbers that cannot be, or use more "
            "draws, or another seed."
        )

    @property
    def forms(self) -> dict[MemoryForm, tuple[float, float | None]]:
        """Share of the laboratories with each form of memory that counts, before and after (None: not sharpened)."""
        found: dict[MemoryForm, tuple[float, float | None]] = {}
        for form in forms_in(self.prior.choice):
            shares = (
                (some.form == MEMORY_FORMS.index(form)) for some in (self.conditioned.before, self.conditioned.after)
            )
            first, then = (float(share.mean()) if share.size else None for share in shares)
            found[form] = (first or 0.0, then)
        return found

    @property
    def provenance(self) -> tuple[str, ...]:
        """The origin of the conditioned draws, one line each."""
        found = self.conditioned
        how = "weights" if not found.rounds else f"{found.rounds} rounds of fresh laboratories"
        return (
            *self.data.provenance(f"on {self._where}, memory: {self.memory}"),
            f"effective draws: {found.effective:.0f} of {len(found.before)}, by {how}",
            f"seed of the laboratories: {self.seed}",
        )

    @property
    def _where(self) -> str:
        return ", ".join((self.rig, *self.rig_changes))

    def draws(self) -> PosteriorDraws:
        """Draws of constants and memory in this laboratory, equally weighted; its offset is part of the thresholds.

        A ValueError where the data have no usable likelihood.
        """
        if self.unusable:
            raise ValueError(f"there are no draws of this laboratory. {self.unusable}")
        # Draws of a laboratory do not know its pairs, which is why they are taken out.
        found, icons = self.conditioned, self.played.icons
        after = self.confusions_after.without_scores(
            known_scores(icons, found.scores, icons, len(found.after), self.seed)
        )
        details = self.data.details(found.simulated_after, found.scores)
        predicted = np.column_stack([after.felt_and_named, after.correct, after.bits, details])
        return laboratory_draws(self.prior, self.conditioned, predicted, self.played, self.provenance, self._where)

    def files(self) -> tuple[str, str]:
        """Texts of the parameter file (TOML) and of the table of draws (CSV) of this laboratory."""
        return laboratory_texts(self.draws(), self.version, self.provenance)

    def to_dict(self) -> dict[str, Any]:
        """Every number as plain data."""
        found = self.conditioned
        return {
            "version": self.version,
            "rig": self.rig,
            "rig_changes": list(self.rig_changes),
            "memory": self.memory,
            "seed": self.seed,
            **self.data.to_dict(),
            "fit_before": _plain(self.fit),
            "fit_after": None if self.fit_after is None else _plain(self.fit_after),
            "unusable": self.unusable or None,
            "draws": len(found.before),
            "effective_sample_size": found.effective,
            "rounds": found.rounds,
            "forms_of_memory": {form: {"before": first, "after": then} for form, (first, then) in self.forms.items()},
            "predictions": [
                {"title": each.before.title, **asdict(each), "narrower": each.narrower} for each in self.predictions
            ],
            "constants": [asdict(each) for each in self.constants],
        }

    def rows(self) -> list[dict[str, Any]]:
        """One row for each set before the data were seen, and one after."""
        pairs = ((each, when) for each in self.predictions for when in ("before", "after"))
        shown = [(getattr(each, when), when) for each, when in pairs]
        return [prediction.row(when) for prediction, when in shown if prediction is not None]

    def to_json(self) -> str:
        """Every number as JSON text."""
        return json.dumps(self.to_dict(), ensure_ascii=False, indent=1)

    def __repr__(self) -> str:
        own = self.predictions[0]
        ends = [each.proportion_correct for each in (own.before, own.after) if each is not None]
        spans = " → ".join(f"{100 * low:.1f}–{100 * high:.1f} %" for _, low, high in ends)
        if self.unusable:
            return f"Observed({self.data!r}: {spans} before. {self.unusable})"
        return f"Observed({self.data!r}: {spans})"


def _changed(prior: LaboratoryPrior, found: Conditioned) -> tuple[ChangedConstant, ...]:
    """Constants that the data changed."""
    before, after = prior.values(found.before), prior.values(found.after)
    return changed(prior.names, before, after, found.effective_after, prior.units)


def _plain(fit: Fit | MeasurementFit) -> dict[str, Any]:
    """A fit as plain data, with what a condition is beside what was measured under it."""
    own = asdict(fit)
    for each in own.get("conditions", ()):
        each |= each.pop("condition")
    return own


@checked
def observed(
    trials: Trials | Measurements,
    icons: Icons,
    rig: AnyRig = None,
    *,
    crowd: Crowd = EVERYBODY,
    others: Sequence[IconSet | str | Path] = (),
    draws: int = DRAWS,
    progress: Progress | None = None,
    **words: Unpack[CrowdWords],
) -> Observed[Any, Any]:
    """Compare answers or measurements with their prediction, and condition the prediction on them.

    Parameters
    ----------
    trials
        Answers to icons of the set, as `read_trials` reads them, or thresholds, reaction times and ratings, as
        `read_measurements` reads them.
    icons
        The set whose prediction is wanted; its icons were all the answers that there were.
    rig
        The rig, or its name or file, that plays it, and on which the answers were given or the values measured;
        None: as in `rank`.
    crowd
        Who feels and remembers the icons.
    others
        Other sets whose prediction is wanted for the same laboratory.
    draws
        Draws of the posterior, each with a laboratory around it.
    progress
        Called with (laboratories simulated, laboratories in all; the second may grow).
    **words
        Single words of the crowd, such as ``people=50``.

    Returns
    -------
    Observed
        The same numbers for the same arguments.

    Raises
    ------
    ValueError
        For fewer than 20 draws, an observer without draws, a set of fewer than 2 or more than 64
        icons, for answers to another set, and for measurements on a rig at a site whose skin is not known.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> icons, rig = read_cue("six-icons"), Rig.load("thenar")
    >>> answers = Trials(tuple(icon.name for icon in icons), ("P1", "P2"), np.tile(2.0 * np.eye(6), (2, 1, 1)))
    >>> found = observed(answers, icons, rig, draws=20)
    >>> len(found.data.each), found.data.pooled.trials
    (2, 24)
    """
    if "people" in words:
        raise InputError("observed: people are the participants; leave it out")
    icons, crowd = set_of(icons), crowd.but(**words)
    rig, names, seed = Rig.of(rig, icons.context.site), tuple(icon.name for icon in icons), crowd.seed
    if isinstance(trials, Trials) and trials.icons != names:
        raise ValueError(f"the answers are to other icons than those of the set ({', '.join(names[:6])})")
    if draws < LEAST_DRAWS:
        raise ValueError(f"an interval needs at least {LEAST_DRAWS} draws, not {draws}")
    prior, further = LaboratoryPrior.of(crowd.observer, crowd.memory), [set_of(each) for each in others]
    number = laboratories_for(max(len(names), *(len(list(other)) for other in further), 2), draws)
    before, kept = prior.first(number, seed), max(number // 2, 2)
    step = step_counter(progress, (1 + len(others)) * (number + kept))
    main = stage(icons, rig, prior, seed=seed, tracking=crowd.tracking)
    data: Any = Namings(trials, main) if isinstance(trials, Trials) else MeasuredValues(trials, prior, Setting.of(rig))
    found: Conditioned = condition(data, before, seed=seed, kept=kept, step=step)

    def both(played: Stage) -> tuple[Confusions, Confusions]:
        first, then = (evened(some, played.confusions(some, step)) for some in (before, found.after))
        pairs = (
            pair_scores(len(played.icons), number, seed),
            known_scores(names, found.scores, played.icons, kept, seed),
        )
        return first.with_scores(pairs[0]), then.with_scores(pairs[1][: len(found.after)])

    pairs = [(found.simulated, found.simulated_after) if isinstance(trials, Trials) else both(main)]
    pairs += [both(stage(other, rig, prior, seed=seed, tracking=crowd.tracking)) for other in further]
    sharpened = not found.unusable
    return Observed(
        data=data,
        fit=data.compare(found.simulated, seed),
        fit_after=data.compare(found.simulated_after, seed) if sharpened else None,
        predictions=tuple(
            ChangedPrediction(
                SetPrediction.of(each.title, first), SetPrediction.of(each.title, then) if sharpened else None
            )
            for each, (first, then) in zip((icons, *further), pairs, strict=True)
        ),
        constants=_changed(prior, found) if sharpened else (),
        conditioned=found,
        confusions_after=pairs[0][1],
        prior=prior,
        played=main,
        rig=rig.name,
        rig_changes=rig.changes,
        memory=crowd.memory,
        seed=seed,
        version=own_version(),
    )
