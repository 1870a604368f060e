"""Perception of the designed and of the delivered icons: detection of each, and d′ to every other icon of the set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from thermicon.circuit.delivery.delivery_deviation import loss_limit

from ..arrays import Array
from ..observer.channels import USUAL_NORM, Norm, check_norm
from ..observer.observer import Observer
from ..sensation.percept import Percept, perceive
from .from_memory import dprimes_from_memory

if TYPE_CHECKING:
    from thermicon.circuit import Trace


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
    """Effect of a device on one icon: probability of detection, and d′ to each other icon for a nominal person.

    Attributes
    ----------
    icon
        Name of the icon.
    detection
        Probability of a report, designed and delivered.
    d_prime
        d′ from memory to each other icon, by its name, designed and delivered.
    people
        Number of virtual people whose mean the detection is; 0 where it is the nominal person's.

    See Also
    --------
    judge_delivered : Compares a set.
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

    def __repr__(self) -> str:
        worst = max(self.d_prime, key=lambda pair: pair[1].drop, default=None)
        pair = "" if worst is None else f", d′ to {worst[0]} {worst[1].designed:.3g} → {worst[1].delivered:.3g}"
        detected = f"detected {self.detection.designed:.3f} → {self.detection.delivered:.3f} by {self.detected_by}"
        return f"PerceivedChange({self.icon}: {detected}{pair})"

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
            "detected_probability": _pair(self.detection),
            "d_prime": {other: _pair(change) for other, change in self.d_prime},
            "losses": list(self.losses()),
        }


def judge_delivered(
    names: Sequence[str],
    designed: Sequence[Trace],
    delivered: Sequence[Trace],
    observer: Observer | None = None,
    norm: str = USUAL_NORM,
) -> tuple[PerceivedChange, ...]:
    """Compare designed and delivered icons of a set for a nominal person.

    Each icon is compared with the others as they were designed, and, delivered, with the others as they are delivered.

    Parameters
    ----------
    names
        Names of the icons.
    designed, delivered
        Their traces, all with the same rows.
    observer
        The person (None: the nominal one).
    norm
        How episodes are remembered: `episodes` or `naming`.

    Returns
    -------
    tuple of PerceivedChange
        For each icon, detection by this person and d′ to every other icon, designed and delivered.

    Raises
    ------
    ValueError
        For an unknown norm, and for traces without a uniform clock.

    Examples
    --------
    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import read_cue
    >>> icons, rig = read_cue("six-icons"), Rig.load("thenar")
    >>> traces = [simulate(icons[name], rig) for name in ("cooling-step", "warming-step")]
    >>> judge_delivered(["cooling-step", "warming-step"], traces, traces)[0].losses()
    ()
    """
    person, chosen = Observer.load() if observer is None else observer, check_norm(norm)
    percepts = [[perceive(trace, person) for trace in traces] for traces in (designed, delivered)]
    before, after = (_d_primes(each, names, person, chosen) for each in percepts)
    return tuple(
        PerceivedChange(
            name,
            DeliveredChange(percepts[0][k].detected_probability, percepts[1][k].detected_probability),
            tuple(
                (other, DeliveredChange(float(before[k, j]), float(after[k, j])))
                for j, other in enumerate(names)
                if j != k
            ),
        )
        for k, name in enumerate(names)
    )


def _d_primes(percepts: Sequence[Percept], names: Sequence[str], person: Observer, norm: Norm) -> Array:
    felt = np.array([p.psi_cold for p in percepts]), np.array([p.psi_warm for p in percepts])
    return dprimes_from_memory(felt, felt, percepts[0].dt_s, person, norm, (names, names))


def _pair(change: DeliveredChange) -> dict[str, float]:
    return {"designed": change.designed, "delivered": change.delivered}
