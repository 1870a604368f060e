"""How large a change feels, and where the time of an onset goes: what the constants say of plain cues on the thenar.

A step of d′ = 1 is just noticeable, so that the peak d′ of a change is the number of just noticeable steps up to it.
"""

from __future__ import annotations

from dataclasses import dataclass

from thermicon.circuit import Rig

from ..observer.channels import CHANNELS, Channel
from ..observer.observer import Observer
from ..observer.variants import VARIABLES, Variable
from ..sensation.bench import Bench, Stimulus, ramp
from .onset_stages import OnsetStages, onset_stages

RIG, ICONS = "thenar", "six-icons"
CHANGES_K = (3.0, 10.0)
RATE_K_PER_S, HOLD_S = 1.0, 3.0


@dataclass(frozen=True, slots=True)
class Magnitude:
    """Peak sensations of one variant for a change at the display: d′ of `CHANGES_K`, K.

    `jnds` is the number of just noticeable steps from rest to the larger change.
    """

    channel: Channel
    variable: Variable
    peaks: tuple[float, ...]

    @property
    def jnds(self) -> int:
        """Whole steps of d′ = 1 up to the largest change."""
        return int(self.peaks[-1])


def magnitudes() -> tuple[Magnitude, ...]:
    """Peak d′ of a change by 3 and by 10 K from 32 °C at 1 K/s, held for 3 s, cold then warm of every variant.

    >>> [(each.channel, each.jnds > each.peaks[0]) for each in magnitudes()[:2]]
    [('cold', True), ('warm', True)]
    """
    bench = Bench(Rig.load(RIG), surface="display")
    played = {c: [_played(bench, c, size) for size in CHANGES_K] for c in CHANNELS}
    return tuple(
        Magnitude(channel, variable, tuple(_peak(each, channel, variable) for each in played[channel]))
        for variable in VARIABLES
        for channel in CHANNELS
    )


def stages_of_six() -> tuple[OnsetStages, ...]:
    """Stages of the onsets of the six icons on the thenar."""
    from thermicon.icons import load_library

    return onset_stages(load_library(ICONS), Rig.load(RIG))


def _played(bench: Bench, channel: Channel, size_K: float) -> Stimulus:
    return bench.play([ramp(channel, size_K, RATE_K_PER_S, HOLD_S)], size_K / RATE_K_PER_S + HOLD_S)


def _peak(played: Stimulus, channel: Channel, variable: Variable) -> float:
    felt = played.felt(Observer.load(variable=variable))[CHANNELS.index(channel)]
    return float((felt - felt[..., :1]).max())
