"""Stages of the onset of an icon from skin to decision."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from thermicon.circuit import Rig, simulate
from thermicon.icons import Icon
from thermicon.perception.observer.channels import CHANNELS, Channel
from thermicon.perception.observer.constants import Both
from thermicon.perception.observer.mechanisms.conduction import SPINAL_M_PER_S, SPINE_M
from thermicon.perception.observer.observer import Observer
from thermicon.perception.sensation.percept import perceive

LEG_M_PER_S: dict[Channel, float] = {"cold": 2.1, "warm": 0.5}
"""Conduction at the leg (Fowler et al. 1988)."""


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
    whole = Observer.load()
    stages = []
    for icon in icons:
        trace = simulate(icon, rig)
        path_m = whole.path_m(trace.site)
        # Nerves conduct so fast that the whole delay is that of a leg's nerve of the path alone.
        delays_s = (path_m / LEG_M_PER_S[channel] - SPINE_M / SPINAL_M_PER_S.of(channel) for channel in CHANNELS)
        leg = replace(whole, velocity_m_per_s=Both(*(path_m / delay_s for delay_s in delays_s)))
        felt, late = perceive(trace, whole), perceive(trace, leg)
        if felt.onset_s is None or felt.channel is None or late.onset_s is None:
            continue
        nerve = path_m / whole.velocity_m_per_s.of(felt.channel)
        cord = SPINE_M / SPINAL_M_PER_S.of(felt.channel)
        before = felt.onset_s - nerve - cord - whole.decision_s
        stages.append(OnsetStages(icon.name, felt.channel, before, nerve, cord, whole.decision_s, late.onset_s))
    return tuple(stages)
