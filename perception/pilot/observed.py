"""Condition the prediction on what a laboratory's own participants answered."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.circuit.program import own_version

from ..observer.channels import USUAL_NORM, check_norm
from ..observer.draws import PosteriorDraws
from ..observer.observer_model import ObserverModel
from ..progress import Progress
from .answers import AnswerScore, score_person, score_pooled
from .changes import ChangedConstant, changed
from .conditioning import Conditioned, condition
from .fit import Fit, compare
from .laboratory_file import Resampling, laboratory_draws, laboratory_texts
from .likelihood import person_log_likelihoods
from .playing import Stage, laboratories_for, stage
from .prediction import ChangedPrediction, Three, three
from .states import LaboratoryPrior
from .trials import Trials

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

DRAWS, LEAST_DRAWS = 1000, 20


@dataclass(frozen=True, slots=True)
class Observed:
    """What participants answered, how it fits the prediction, and what it makes of the prediction.

    Attributes
    ----------
    trials
        The answers.
    pooled, each
        Scores of all participants together, and of each.
    own
        Proportion correct of each participant in further trials of the set: mean and 95 %.
    fit, fit_after
        The answers beside what was predicted before, and beside what is predicted after they were seen.
    predictions
        The set, and then other sets, before and after.
    constants
        Constants that moved or narrowed, the most changed first.
    conditioned
        Laboratories behind all of it, and the effective sample size.
    """

    trials: Trials
    pooled: AnswerScore
    each: tuple[AnswerScore, ...]
    own: tuple[Three, ...]
    fit: Fit
    fit_after: Fit
    predictions: tuple[ChangedPrediction, ...]
    constants: tuple[ChangedConstant, ...]
    conditioned: Conditioned
    prior: LaboratoryPrior
    played: Stage
    rig: str
    rig_changes: tuple[str, ...]
    norm: str
    seed: int
    version: str

    @property
    def provenance(self) -> tuple[str, ...]:
        """What the conditioned draws were made from, a line each."""
        found, trials = self.conditioned, self.trials
        how = "weights" if not found.rounds else f"{found.rounds} rounds of fresh laboratories"
        return (
            f"conditioned on: {trials.source or 'answers'}, sha256 {trials.digest or 'unknown'}",
            f"participants: {len(trials.participants)}",
            f"trials: {trials.total}",
            f"icons: {len(trials.icons)}, on {', '.join((self.rig, *self.rig_changes))}, {self.norm} norm",
            f"effective draws: {found.effective:.0f} of {len(found.before)}, by {how}",
            f"seed of the laboratories: {self.seed}",
        )

    def draws(self) -> PosteriorDraws:
        """Draws of constants and memory in this laboratory, equally weighted; its offset is part of the thresholds."""
        found = self.conditioned
        played = found.confusions_after
        each = np.diagonal(played.pooled, axis1=1, axis2=2)
        predicted = np.column_stack([played.correct, played.bits, each])
        resampling = Resampling.of(found, self.provenance, ", ".join((self.rig, *self.rig_changes)))
        return laboratory_draws(self.prior, found.after, predicted, self.played, resampling)

    def files(self) -> tuple[str, str]:
        """Texts of the parameter file (TOML) and of the table of draws (CSV) of this laboratory."""
        return laboratory_texts(self.draws(), self.version, self.provenance)

    def to_dict(self) -> dict[str, Any]:
        """Every number as plain data."""
        trials, found = self.trials, self.conditioned
        return {
            "version": self.version,
            "rig": self.rig,
            "rig_changes": list(self.rig_changes),
            "norm": self.norm,
            "seed": self.seed,
            "trials_file": trials.source,
            "trials_sha256": trials.digest,
            "participants": len(trials.participants),
            "trials": trials.total,
            "icons": list(trials.icons),
            "never_presented": list(trials.never_presented),
            "single_trial": list(trials.single_trial),
            "warnings": list(trials.warnings),
            "counts": trials.pooled.astype(int).tolist(),
            "observed": self.pooled.to_dict(),
            "each": [
                {**score.to_dict(), "predicted": list(own)} for score, own in zip(self.each, self.own, strict=True)
            ],
            "fit_before": self.fit.to_dict(),
            "fit_after": self.fit_after.to_dict(),
            "draws": len(found.before),
            "effective_sample_size": found.effective,
            "rounds": found.rounds,
            "predictions": [each.to_dict() for each in self.predictions],
            "constants": [each.to_dict() for each in self.constants],
        }

    def to_json(self) -> str:
        """Every number as JSON text."""
        return json.dumps(self.to_dict(), ensure_ascii=False, indent=1)

    def __repr__(self) -> str:
        own = self.predictions[0]
        ends = [f"{100 * low:.1f}–{100 * high:.1f} %" for _, low, high in _intervals(own)]
        return f"Observed({self.trials!r}: {100 * self.pooled.proportion_correct:.0f} % correct; {' → '.join(ends)})"


def observed(
    trials: Trials,
    icons: IconSet,
    rig: Rig,
    *,
    others: Sequence[IconSet] = (),
    draws: int = DRAWS,
    seed: int = 0,
    norm: str = USUAL_NORM,
    tracking: str | None = None,
    observer: ObserverModel | Path | str | None = None,
    progress: Progress | None = None,
) -> Observed:
    """Compare answers with their prediction, and condition the prediction on them.

    Parameters
    ----------
    trials
        Answers to icons of the set, as `read_trials` reads them.
    icons
        The set, whose icons were all the answers that there were.
    rig
        The rig that played it.
    others
        Other sets whose prediction is wanted for the same laboratory.
    draws
        Draws of the posterior, each with a laboratory around it.
    seed
        Seed of the laboratories and their people.
    norm, tracking
        As in `rank`.
    observer
        A table of posterior draws, or a model that has one (None: the shipped draws).
    progress
        Called with (laboratories simulated, laboratories in all; the second may grow).

    Returns
    -------
    Observed
        The same numbers for the same arguments.

    Raises
    ------
    ValueError
        For fewer than 20 draws, an observer without draws, an unknown norm, a set of fewer than 2 or more than 64
        icons, and for answers to another set.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> from thermicon.perception.pilot.synthetic import synthetic_trials
    >>> icons, rig = read_cue("six-icons"), Rig.load("thenar")
    >>> answers = synthetic_trials(icons, rig, participants=2, trials=12, seed=3)
    >>> found = observed(answers, icons, rig, draws=20)
    >>> len(found.each), found.pooled.trials
    (2, 24)
    """
    names = tuple(icon.name for icon in icons)
    if trials.icons != names:
        raise ValueError(f"the answers are to other icons than those of the set ({', '.join(names[:6])})")
    if draws < LEAST_DRAWS:
        raise ValueError(f"an interval needs at least {LEAST_DRAWS} draws, not {draws}")
    prior = LaboratoryPrior.of(observer, check_norm(norm))
    number = laboratories_for(max(len(names), *(len(list(other)) for other in others), 2), draws)
    before, kept = prior.first(number, seed), max(number // 2, 2)
    step = counted(progress, number + kept + len(others) * (number + kept))
    main = stage(icons, rig, prior, seed=seed, tracking=tracking)
    found = condition(main, trials.counts, before, seed=seed, sample=kept, step=step)
    predictions = [ChangedPrediction.of(icons.title, found.confusions_before, found.confusions_after)]
    for other in others:
        also = stage(other, rig, prior, seed=seed, tracking=tracking)
        pair = also.confusions(before, step), also.confusions(found.after, step)
        predictions.append(ChangedPrediction.of(other.title, *pair))
    return Observed(
        trials=trials,
        pooled=score_pooled(trials),
        each=tuple(score_person(trials, person) for person in range(len(trials.participants))),
        own=_own(found, trials),
        fit=compare(trials, found.confusions_before, seed=seed),
        fit_after=compare(trials, found.confusions_after, seed=seed),
        predictions=tuple(predictions),
        constants=changed(
            prior.names, prior.values(before), prior.values(found.after), found.effective_after, prior.units
        ),
        conditioned=found,
        prior=prior,
        played=main,
        rig=rig.name,
        rig_changes=tuple(rig.changes),
        norm=norm,
        seed=seed,
        version=own_version(),
    )


def _intervals(prediction: ChangedPrediction) -> tuple[Three, Three]:
    return prediction.before.proportion_correct, prediction.after.proportion_correct


def _own(found: Conditioned, trials: Trials) -> tuple[Three, ...]:
    """Proportion correct of each participant in further trials: people of every laboratory, by their likelihood."""
    played = found.confusions_after
    each = person_log_likelihoods(played.probability, trials.counts)
    correct, rows = played.each_correct, []
    rng = np.random.default_rng(np.random.SeedSequence([0, 14]))
    for person in range(len(trials.participants)):
        weight = np.exp(each[:, :, person] - each[:, :, person].max())
        flat = (weight / weight.sum()).ravel()
        rows.append(three(correct.ravel()[rng.choice(flat.size, size=2000, p=flat)]))
    return tuple(rows)


def counted(progress: Progress | None, total: int) -> Callable[[], None]:
    """A function that reports one more step to `progress` each time it is called."""
    done = 0

    def step() -> None:
        nonlocal done, total
        done += 1
        total = max(total, done)
        if progress is not None:
            progress(done, total)

    return step
