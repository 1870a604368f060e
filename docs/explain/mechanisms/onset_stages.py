"""When an icon is felt, by stages: skin and receptor, nerve, cord to brain, and decision."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from thermicon.circuit import Rig, simulate
from thermicon.perception.observer.channels import Channel
from thermicon.perception.observer.observer import Observer
from thermicon.perception.observer.parts import SPINAL_M_PER_S, SPINE_M
from thermicon.perception.sensation.percept import perceive

if TYPE_CHECKING:
    from thermicon.icons import Icon


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


def onset_stages(icons: Iterable[Icon], rig: Rig) -> tuple[OnsetStages, ...]:
    """Stages of every icon that a nominal person feels, in the order of the icons."""
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
