"""How large a change feels, and where the time of an onset goes: what the constants say of plain cues on the thenar.

Stages of an onset are skin and receptor, nerve, cord to brain, and decision. A step of d′ = 1 is just noticeable, so
that the peak d′ of a change is the number of just noticeable steps up to it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from thermicon.circuit import Rig

from ..observer.channels import CHANNELS, VARIABLES, Channel, Variable
from ..observer.observer import Observer
from ..observer.parts import SPINAL_M_PER_S, SPINE_M
from ..sensation.bench import Bench, Stimulus, ramp
from ..sensation.percept import perceive

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

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


@dataclass(frozen=True, slots=True)
class OnsetStages:
    """Onset of one icon by stages, s; `leg_s` is its onset with conduction as slow as at the leg and no cord."""

    icon: str
    channel: Channel
    receptor_s: float
    nerve_s: float
    cord_s: float
    decision_s: float
    leg_s: float

    @property
    def onset_s(self) -> float:
        """Time from the start of the cue to the report, s."""
        return self.receptor_s + self.nerve_s + self.cord_s + self.decision_s

    def __repr__(self) -> str:
        return f"OnsetStages({self.icon}: {self.onset_s:.2f} s by {self.channel}, {self.receptor_s:.2f} s at receptors)"


def onset_stages(icons: Iterable[Icon], rig: Rig) -> tuple[OnsetStages, ...]:
    """Stages of every icon that a nominal person feels, in the order of the icons.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import load_library
    >>> stages = onset_stages(load_library("six-icons"), Rig.load("thenar"))
    >>> len(stages), stages[0].channel
    (6, 'cold')
    """
    from thermicon.circuit import simulate

    whole, leg = Observer.load(), Observer.load(without=["delays"])
    stages = []
    for icon in icons:
        trace = simulate(icon, rig)
        felt, late = perceive(trace, whole), perceive(trace, leg)
        if felt.onset_s is None or felt.channel is None or late.onset_s is None:
            continue
        nerve = whole.path_m(trace.site) / whole.receptor(felt.channel).velocity_m_per_s
        cord = SPINE_M / SPINAL_M_PER_S[felt.channel]
        before = felt.onset_s - nerve - cord - whole.decision_s
        stages.append(OnsetStages(icon.name, felt.channel, before, nerve, cord, whole.decision_s, late.onset_s))
    return tuple(stages)
