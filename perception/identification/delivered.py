"""The perceived difference between designed and delivered icons.

The device's change for the nominal person is scaled by each person's response to the icon, and added to it.
That is exact for what scales with the icon, and wrong by about a tenth otherwise, since skins differ in lag.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.circuit.delivery.delivered_drive import loss_limit

from ..observer.channels import CHANNELS, MEMORY_FORMS, Channel
from ..observer.observer import Observer
from ..observer.people import draw_people
from ..sensation.percept import Percept, perceive
from .episodes import dprimes_from_memory
from .population import RATE_HZ, ReceptorTemperatures, population_detection, run_end_s

if TYPE_CHECKING:
    from thermicon.circuit import Trace
    from thermicon.circuit.delivery.delivered_drive import DeliveredDrive

PEOPLE, SEED = 200, 0
"""The people of `rank` unless it is asked for others, so that both show the same number."""


@dataclass(frozen=True, slots=True)
class DeliveredChange:
    """A number for the design, and for what the device delivers."""

    designed: float
    delivered: float

    @property
    def drop(self) -> float:
        """By how much it falls; negative where it rises."""
        return self.designed - self.delivered


@dataclass(frozen=True, slots=True)
class PerceivedChange:
    """Effect of a device on one icon: probability of detection, and d′ from memory to each other icon by its name.

    `detection` is the mean of as many virtual `people`, or where there are none the nominal person's.
    """

    icon: str
    detection: DeliveredChange
    d_prime: tuple[tuple[str, DeliveredChange], ...]
    people: int = 0

    @property
    def detected_by(self) -> str:
        """Whose probability of detection it is."""
        if not self.people:
            return "the nominal person"
        return "1 virtual person" if self.people == 1 else f"{self.people} virtual people"

    def losses(self) -> tuple[str, ...]:
        """One sentence for every drop that exceeds the stated loss."""
        found = []
        if self.detection.drop > loss_limit("detection drop"):
            found.append(
                f"detection by {self.detected_by} falls from {self.detection.designed:.2f} to "
                f"{self.detection.delivered:.2f}, by more than the stated {loss_limit('detection drop'):g}"
            )
        share, least = loss_limit("relative d′ drop"), loss_limit("least d′ drop")
        for other, change in self.d_prime:
            if change.drop > max(share * change.designed, least):
                found.append(
                    f"d′ to {other} falls from {change.designed:.2f} to {change.delivered:.2f}, by more than the "
                    f"stated {share:.0%}"
                )
        return tuple(found)

    def to_dict(self) -> dict[str, object]:
        """Plain data for the sidecar file."""
        return {
            "observer": "nominal",
            "detected_by": self.detected_by,
            "detected_probability": asdict(self.detection),
            "d_prime": {other: asdict(change) for other, change in self.d_prime},
            "losses": list(self.losses()),
        }


def judge_delivered(
    names: Sequence[str], designed: Sequence[Trace], delivered: Sequence[Trace]
) -> tuple[PerceivedChange, ...]:
    """Compare designed and delivered icons of a set for a nominal person.

    Each icon is compared with the others as they were designed, and, delivered, with the others as they are delivered;
    all traces have the same rows.

    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import read_cue
    >>> icons, rig = read_cue("six-icons"), Rig.load("thenar")
    >>> traces = [simulate(icons[name], rig) for name in ("cooling-step", "warming-step")]
    >>> judge_delivered(["cooling-step", "warming-step"], traces, traces)[0].losses()
    ()
    """
    percepts = [[perceive(trace) for trace in traces] for traces in (designed, delivered)]
    before, after = (_d_primes(each, names) for each in percepts)
    found = []
    for k, name in enumerate(names):
        detection = DeliveredChange(*(each[k].detected_probability for each in percepts))
        apart = [DeliveredChange(*pair) for pair in zip(before[k].tolist(), after[k].tolist(), strict=True)]
        others = tuple((other, apart[j]) for j, other in enumerate(names) if j != k)
        found.append(PerceivedChange(name, detection, others))
    return tuple(found)


def detected_as_delivered(
    delivery: DeliveredDrive, designed: Trace, delivered: Trace, *, end_s: float | None = None, people: int = PEOPLE
) -> DeliveredChange:
    """Probability that a person drawn at random reports an icon, as designed (as in `rank`) and as delivered.

    Traces are on the nominal rig and the clock of the file; `end_s` is when the run of the set ends (None: 10 s after).
    """
    from thermicon.circuit.solver.simulate import duration_s

    icon, rig = delivery.icon, delivery.rig
    crowd, observer = draw_people(people, SEED), Observer.load()
    end = run_end_s([duration_s(icon, rig)]) if end_s is None else end_s
    as_designed = ReceptorTemperatures.simulated([icon], crowd, rig, observer, end, RATE_HZ, None)
    cold, warm = (
        met + _change(met - met[..., :1], channel, designed, delivered, as_designed.time_s + delivery.lead_s)
        for channel, met in zip(CHANNELS, as_designed.rungs_C, strict=True)
    )
    as_delivered = replace(as_designed, rungs_C=(cold, warm))
    before, after = (
        float(population_detection(each, crowd, observer).probability.mean()) for each in (as_designed, as_delivered)
    )
    return DeliveredChange(before, after)


def _change(met_K: Array, channel: Channel, designed: Trace, delivered: Trace, at_s: Array) -> Array:
    """The device's change (people, icons, n_time), K: the nominal person's, in proportion to each `met_K`."""
    before, after = (np.interp(at_s, t.time_s, getattr(t, f"{channel}_receptor_C")) for t in (designed, delivered))
    icon = before - before[0]
    size = float(icon @ icon)
    gain = (met_K @ icon)[..., None] / size if size > 0.0 else 1.0
    return np.asarray(gain * (after - before))


def _d_primes(percepts: Sequence[Percept], names: Sequence[str]) -> Array:
    felt = np.array([p.psi_cold for p in percepts]), np.array([p.psi_warm for p in percepts])
    return dprimes_from_memory(felt, felt, percepts[0].dt_s, Observer.load(), MEMORY_FORMS[0], (names, names))
