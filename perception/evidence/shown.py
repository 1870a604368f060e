"""Every published experiment run on every variant of the observer."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from thermicon.circuit import Rig

from ..kernels.parallel import Progress, step_counter
from ..observer.channels import VARIABLES, Variable
from ..observer.mechanisms.age import OLD_YEARS
from .experiments import first_and_return, limits, peak_lead, rate_curve, reaction_times
from .identified import WAVES, Likeness, VariantConfusions, likeness, show, six_icons, wave_shapes
from .predicted import Predicted
from .pulses import short_pulses
from .radiant import whole_body_warmth

SIX = "six-icons"


@dataclass(frozen=True, slots=True)
class ShownEvidence:
    """Predictions of all variants, confusions, and likeness of the waves at the skin."""

    predicted: tuple[Predicted, ...]
    six: tuple[VariantConfusions, ...]
    waves: tuple[VariantConfusions, ...]
    alike: tuple[Likeness, ...]

    def find(self, variable: Variable, experiment: str, quantity: str, channel: str, where: str = "") -> Predicted:
        """One prediction, whose conditions contain `where`; raises ValueError where it was not made."""
        for one in self.predicted:
            same = (one.variable, one.experiment, one.quantity, one.channel)
            if same == (variable, experiment, quantity, channel) and where in one.conditions:
                return one
        raise ValueError(f"no experiment {experiment!r} predicts {quantity!r} ({channel})")


def collect_evidence(people: int, draws: int, seed: int, trials: int, progress: Progress | None) -> ShownEvidence:
    """Run everything; `progress` is called with (steps done, steps in all)."""
    from thermicon.icons import IconSet, load_library

    rig, six, waves = Rig.load("thenar"), load_library(SIX), load_library(WAVES)
    both = IconSet(waves.name, waves.title, waves.context, waves.metadata, (*waves.entries, *six.entries))
    alike = likeness(rig)
    shown, shown_waves = show(six, rig, people, seed), show(both, rig, people, seed)
    predicted: list[Predicted] = []
    six_named, waves_named = [], []
    step = step_counter(progress, len(VARIABLES) * (len(_experiments("temperature", people, draws, seed)) + 2))
    for variable in VARIABLES:
        for run in _experiments(variable, people, draws, seed):
            predicted += run()
            step()
        six_named.append(shown.identify(variable, draws))
        predicted += six_icons(six_named[-1], trials, seed)
        step()
        waves_named.append(shown_waves.identify(variable, draws))
        predicted += wave_shapes(waves_named[-1], alike)
        step()
    return ShownEvidence(tuple(predicted), tuple(six_named), tuple(waves_named), alike)


def _experiments(
    variable: Variable, people: int, draws: int, seed: int
) -> Sequence[Callable[[], tuple[Predicted, ...]]]:
    drawn = {"draws": draws, "seed": seed}
    return (
        partial(rate_curve, variable, **drawn),
        partial(limits, "hand", variable, people=people, **drawn),
        partial(limits, "forearm", variable, people=people, **drawn),
        partial(_old, variable, people, seed),
        partial(reaction_times, variable, **drawn),
        partial(whole_body_warmth, variable, **drawn),
        partial(peak_lead, variable, **drawn),
        partial(first_and_return, variable, **drawn),
        partial(short_pulses, variable, people, draws, seed),
    )


def _old(variable: Variable, people: int, seed: int) -> tuple[Predicted, ...]:
    """Limits of old people, under a name of their own; age is drawn with the people."""
    found = limits("hand", variable, people=people, age_years=OLD_YEARS, draws=0, seed=seed)
    return tuple(replace(one, experiment="limits on the hand, old") for one in found)
