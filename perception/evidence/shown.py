"""Every published experiment, run on every variant of the observer: what a validation report is made of."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from thermicon.circuit import Rig

from ..observer.channels import VARIABLES, Variable
from ..observer.people import OLD_YEARS
from ..progress import Progress, step_counter
from .experiments import limits, methods, rate_curve, reaction_times
from .experiments_timing import first_and_return, peak_lead
from .identified import Identified, Shown, named_pulses, show, show_pulses, six_icons
from .predicted import Predicted
from .radiant import whole_body_warmth
from .waves import LIBRARY, Likeness, likeness, skin_waves, wave_shapes, with_others

SIX = "six-icons"


@dataclass(frozen=True, slots=True)
class Evidence:
    """Predictions of all variants, confusions, and likeness of the waves at the skin."""

    predicted: tuple[Predicted, ...]
    six: tuple[Identified, ...]
    waves: tuple[Identified, ...]
    alike: tuple[Likeness, ...]

    def of(self, variable: Variable) -> tuple[Predicted, ...]:
        """Predictions of one variant."""
        return tuple(one for one in self.predicted if one.variable == variable)

    def find(self, variable: Variable, experiment: str, quantity: str, channel: str) -> Predicted:
        """One prediction; raises ValueError where it was not made."""
        for one in self.of(variable):
            if (one.experiment, one.quantity, one.channel) == (experiment, quantity, channel):
                return one
        raise ValueError(f"no prediction of {quantity!r} ({channel}) by {experiment!r}")


def collect_evidence(people: int, draws: int, seed: int, trials: int, progress: Progress | None = None) -> Evidence:
    """Run everything; `progress` is called with (steps done, steps in all)."""
    from thermicon.icons import load_library

    rig, six = Rig.load("thenar"), load_library(SIX)
    alike = likeness(skin_waves(rig))
    shown = show(six, rig, people, seed)
    waves = show(with_others(load_library(LIBRARY), six), rig, people, seed)
    sequences = show_pulses(people, seed)
    predicted: list[Predicted] = []
    named: dict[str, list[Identified]] = {SIX: [], "waves": []}
    total = len(VARIABLES) * (len(_experiments("temperature", people, draws, seed)) + 3)
    step = step_counter(progress, total)
    for variable in VARIABLES:
        for run in _experiments(variable, people, draws, seed):
            predicted += run()
            step()
        found = _named(named[SIX], shown, variable, draws)
        predicted += six_icons(found, trials, seed)
        step()
        predicted += wave_shapes(_named(named["waves"], waves, variable, draws), alike)
        step()
        predicted += named_pulses([each.identify(variable, draws) for each in sequences])
        step()
    return Evidence(tuple(predicted), tuple(named[SIX]), tuple(named["waves"]), alike)


def _experiments(
    variable: Variable, people: int, draws: int, seed: int
) -> Sequence[Callable[[], tuple[Predicted, ...]]]:
    return (
        partial(rate_curve, variable, draws=draws, seed=seed),
        partial(limits, "hand", variable, people=people, draws=draws, seed=seed),
        partial(limits, "forearm", variable, people=people, draws=draws, seed=seed),
        partial(_old, variable, people, seed),
        partial(reaction_times, variable, draws=draws, seed=seed),
        partial(methods, variable, draws=draws, seed=seed),
        partial(whole_body_warmth, variable, draws=draws, seed=seed),
        partial(peak_lead, variable, draws=draws, seed=seed),
        partial(first_and_return, variable, draws=draws, seed=seed),
    )


def _old(variable: Variable, people: int, seed: int) -> tuple[Predicted, ...]:
    """Limits of old people, under a name of their own; age is drawn with the people."""
    found = limits("hand", variable, people=people, age_years=OLD_YEARS, draws=0, seed=seed)
    return tuple(replace(one, experiment="limits on the hand, old") for one in found)


def _named(kept: list[Identified], shown: Shown, variable: Variable, draws: int) -> Identified:
    kept.append(shown.identify(variable, draws))
    return kept[-1]
