"""What the constants were inferred from, and what they say: rows left out, what mechanisms are worth, onsets.

Everything but onsets comes from the shipped results of the inference; nothing is fitted here. A row is left
out together with its whole experiment, so that its prediction rests on the other nine.
Stages of an onset are skin and receptor, nerve, cord to brain, and decision.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from statistics import median
from typing import TYPE_CHECKING

from thermicon.circuit import Rig

from ..observer.channels import Channel
from ..observer.observer import Observer
from ..observer.parts import SPINAL_M_PER_S, SPINE_M
from ..sensation.percept import perceive
from .results import AblatedRow, Constant, PredictedRow, load_ablation, load_constants, load_predictions
from .rows import load_evidence

if TYPE_CHECKING:
    from thermicon.icons import Icon

RIG, ICONS = "thenar", "six-icons"


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


@dataclass(frozen=True, slots=True)
class Conditioning:
    """The evidence behind the constants, and what the constants say of onsets."""

    rows: tuple[PredictedRow, ...]
    constants: tuple[Constant, ...]
    offsets: tuple[Constant, ...]
    ablation: tuple[AblatedRow, ...]
    stages: tuple[OnsetStages, ...]

    @property
    def missed(self) -> tuple[PredictedRow, ...]:
        """Rows outside of their interval, the worst first."""
        return tuple(sorted((r for r in self.rows if not r.covered), key=lambda r: -abs(r.score)))

    @property
    def unmoved(self) -> tuple[Constant, ...]:
        """Constants that the evidence did not move."""
        return tuple(each for each in self.constants if not each.moved)

    @property
    def at_edge(self) -> tuple[Constant, ...]:
        """Constants at an edge of their prior."""
        return tuple(each for each in self.constants if each.at_edge)

    def median_half_width(self, *, log: bool) -> float:
        """Median of the half widths of the rows on one scale."""
        return median(each.half_width for each in self.rows if each.log == log)

    def __repr__(self) -> str:
        inside = len(self.rows) - len(self.missed)
        return (
            f"Conditioning({inside} of {len(self.rows)} rows covered when left out; {len(self.constants)} constants, "
            f"{len(self.unmoved)} not moved, {len(self.at_edge)} at an edge of the prior)"
        )


@lru_cache(maxsize=1)
def load_conditioning() -> Conditioning:
    """The shipped evidence, with onsets of the six icons.

    >>> load_conditioning()
    Conditioning(49 of 54 rows covered when left out; 42 constants, 9 not moved, 4 at an edge of the prior)
    """
    from thermicon.icons import load_library

    constants = load_constants()
    # The spread between laboratories is a constant; the offset of a single one, in SDs of it, is not.
    return Conditioning(
        rows=load_predictions(),
        constants=tuple(each for each in constants if each.unit != "SD"),
        offsets=tuple(each for each in constants if each.unit == "SD"),
        ablation=tuple(sorted(load_ablation(), key=lambda run: run.difference)),
        stages=onset_stages(load_library(ICONS), Rig.load(RIG)),
    )


def experiment_title(key: str) -> str:
    """Title of an experiment of the evidence by its key.

    >>> experiment_title("wrist"), experiment_title("E3")
    ('Forced choice at the wrist', 'Method of limits on the forearm')
    """
    return load_evidence().experiments[key].title


def suspected(row: PredictedRow) -> str:
    """The mechanism behind a miss; nothing where the row is covered."""
    if row.covered:
        return ""
    return load_evidence().suspected.get((row.experiment, row.statistic, row.channel), "none named yet")


def onset_stages(icons: Iterable[Icon], rig: Rig) -> tuple[OnsetStages, ...]:
    """Stages of every icon that a nominal person feels, in the order of the icons."""
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
