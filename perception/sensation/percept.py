"""The percept of a cue: two traces of sensation with their events.

The receptor clock starts with the cue; the percept clock is later by conduction; the response clock by decision too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.arrays import Array, held, own_arrays
from thermicon.base.results.drawn import Drawn

from ..criteria import FELT_FROM
from ..observer.channels import CHANNELS, Channel
from ..observer.observer import Observer
from .coverage import outside_data
from .detection import channel_name, detect
from .received import received, uniform_clock

if TYPE_CHECKING:
    from thermicon.circuit import Trace

    from ..plots.film import Film


@dataclass(frozen=True, slots=True, eq=False)
class Percept(Drawn):
    """Sensation over time in d′ units, and whether the nominal person reports it.

    Three clocks are distinguished: the receptor clock starts with the cue, the percept clock is later by conduction,
    the response clock by conduction and decision.

    Attributes
    ----------
    psi_cold, psi_warm
        Sensation of each channel (n_time,), d′, on the receptor clock.
    dt_s
        Step of the clock, s.
    onset_s, channel
        Median response time (s, on the response clock) of the trials that end in a report, and the channel that most
        reports go by; None where the icon is not felt, which is where fewer than half of the trials end in one.
    detected_probability
        Share of trials of this person that end in a report, beyond reports of nothing, 0–1.
    icon
        Name of the icon.
    conduction_s
        What the percept clock is later by, cold and warm, s.
    outside_data
        One sentence for each respect in which the trace lies outside the published data.

    Raises
    ------
    ValueError
        For sensations that are not two finite traces of one length, and for an onset or a channel that contradicts the
        probability.

    See Also
    --------
    perceive : Predicts a percept.
    """

    psi_cold: Array
    psi_warm: Array
    dt_s: float
    onset_s: float | None
    channel: Channel | None
    detected_probability: float
    icon: str | None = None
    conduction_s: tuple[float, float] = (0.0, 0.0)
    outside_data: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        own_arrays(self, "psi_cold", "psi_warm")
        for name, own in (("psi_cold", self.psi_cold), ("psi_warm", self.psi_warm)):
            if own.ndim != 1 or not np.isfinite(own).all():
                raise ValueError(f"{name} must be one trace of finite numbers, not shape {own.shape}")
        if self.psi_cold.shape != self.psi_warm.shape:
            raise ValueError(f"psi_cold has {self.psi_cold.size} samples and psi_warm {self.psi_warm.size}")
        if not self.dt_s > 0.0:
            raise ValueError(f"dt_s = {self.dt_s:g} s must be above 0")
        if not 0.0 <= self.detected_probability <= 1.0:
            raise ValueError(f"detected_probability = {self.detected_probability:g} must lie in 0 to 1")
        if {self.onset_s is not None, self.channel is not None, self.felt} != {self.felt}:
            raise ValueError(
                f"an onset and a channel belong to an icon that is felt (from p {FELT_FROM:g} on), not to onset_s = "
                f"{self.onset_s}, channel = {self.channel}, p {self.detected_probability:g}"
            )

    @property
    def time_s(self) -> Array:
        """Clock of the traces, s."""
        return self.dt_s * np.arange(self.psi_cold.size, dtype=np.float64)

    def peak_s(self, channel: Channel) -> float | None:
        """When the sensation of a channel is strongest, s on the receptor clock; None where it does not rise."""
        psi = self.psi_cold if channel == "cold" else self.psi_warm
        k = int(psi.argmax())
        if not psi[k] > psi[0]:
            return None
        if k == psi.size - 1:
            return self.dt_s * k
        before, top, after = (float(v) for v in psi[k - 1 : k + 2])
        bend = before - 2.0 * top + after
        return self.dt_s * (k + (0.5 * (before - after) / bend if bend < 0.0 else 0.0))

    def felt_peak_s(self, channel: Channel) -> float | None:
        """When the sensation of a channel is felt to peak, s on the percept clock; None where it does not rise."""
        peak = self.peak_s(channel)
        return None if peak is None else peak + self.conduction_s[channel == "warm"]

    @property
    def felt(self) -> bool:
        """Whether at least half of the trials of this person end in a report."""
        return self.detected_probability >= FELT_FROM

    @property
    def summary(self) -> str:
        """Whether the nominal person feels it, when and how surely, as in `felt at 1.05 s by cold, p 1.000`."""
        if not self.felt:
            return f"not felt, p {self.detected_probability:.3f}"
        return f"felt at {self.onset_s:.2f} s by {self.channel}, p {self.detected_probability:.3f}"

    def film(self, trace: Trace) -> Film:
        """Return the film of the run that this is the percept of, which a notebook shows; `save` writes it.

        >>> from thermicon.circuit import simulate
        >>> from thermicon.icons import load_library
        >>> trace = simulate(load_library("six-icons")["cold-to-warm"], "thenar")
        >>> perceive(trace).film(trace).title
        'cold-to-warm on the rig thenar: predicted'
        """
        if trace.time_s.size != self.psi_cold.size:
            raise ValueError(f"the percept has {self.psi_cold.size} rows, the trace {trace.time_s.size}: not its run")
        film: Film = self._room().Film(trace, self)
        return film

    def __repr__(self) -> str:
        beyond = ", outside the data" if self.outside_data else ""
        return (
            f"Percept({self.icon or 'unnamed'}, nominal person: {self.summary}, "
            f"peaks cold {self.psi_cold.max():.3g} d′, warm {self.psi_warm.max():.3g} d′, "
            f"{self.time_s[-1]:.3g} s, receptor clock{beyond})"
        )


@checked
def perceive(trace: Trace, observer: Observer | None = None, area_m2: float | None = None) -> Percept:
    """Predict what the nominal person feels of one simulated trace: receptor drive, sensation, detection.

    Parameters
    ----------
    trace
        A trace of `simulate`, with a uniform clock; its site decides thresholds and nerve path, the observer
        where in its skin the receptors lie. The response window is
        the length of the trace: simulate a tail, such as 10 s, to include the return.
    observer
        The person, of temperature or of heat flow; None: the nominal one.
    area_m2
        Area of contact, m²; None: that of the trace.

    Returns
    -------
    Percept
        Sensation of both channels, and the probability, time and channel of a report by this person.

    Raises
    ------
    ValueError
        For a trace of fewer than two rows or without a uniform clock.

    Examples
    --------
    >>> from thermicon.circuit import Rig, simulate
    >>> from thermicon.icons import read_cue
    >>> trace = simulate(read_cue("six-icons")["cooling-step"], Rig.load("thenar"), tail_s=10.0)
    >>> percept = perceive(trace)
    >>> percept.felt, percept.channel, 0.7 < percept.onset_s < 1.0
    (True, 'cold', True)
    """
    person = Observer.load() if observer is None else observer
    area = trace.area_m2 if area_m2 is None else area_m2
    dt, (at_cold, at_warm) = uniform_clock(trace.time_s)[0], received(trace, person)
    cold, warm = perceive_many(at_cold, at_warm, dt, person, area_m2=area, site=trace.site)
    path = person.path_m(trace.site)
    found = detect(cold, warm, dt, person, path_m=path)
    felt = float(found.onset_s)
    return Percept(
        psi_cold=cold,
        psi_warm=warm,
        dt_s=dt,
        onset_s=None if np.isnan(felt) else felt,
        channel=channel_name(int(found.channel)),
        detected_probability=float(found.probability),
        icon=trace.icon,
        conduction_s=(float(person.delay_s("cold", path)), float(person.delay_s("warm", path))),
        outside_data=outside_data(trace),
    )


def perceive_many(
    cold_received: ArrayLike,
    warm_received: ArrayLike,
    dt_s: float,
    observer: Observer,
    *,
    area_m2: float | None = None,
    site: str | None = None,
    threshold_cold: ArrayLike = 1.0,
    threshold_warm: ArrayLike = 1.0,
) -> tuple[Array, Array]:
    """Sensations (cold, warm) of many traces, shape (..., n_time) like what the receptors receive (`receptor_column`).

    The threshold multipliers are one number or one for each leading index.
    """
    felt, each = [], zip(CHANNELS, (cold_received, warm_received), (threshold_cold, threshold_warm), strict=True)
    for channel, at_receptors, threshold in each:
        psi = observer.drive(at_receptors, dt_s, channel)
        # In place: memory as large as the input is what takes long in a large batch.
        observer.sensation(psi, channel, area_m2=area_m2, site=site, threshold=threshold, out=psi)
        felt.append(psi)
    return felt[0], felt[1]


def on_one_clock(percepts: Sequence[Percept]) -> tuple[Array, Array, float]:
    """Sensations (percepts, n_time), cold and warm, and their step in s; shorter ones are held at their end."""
    dt = percepts[0].dt_s
    for percept in percepts:
        if not math.isclose(percept.dt_s, dt, rel_tol=1e-9):
            raise ValueError(f"percepts are on clocks of {dt:g} s and {percept.dt_s:g} s: simulate all at one rate")
    n = max(percept.psi_cold.size for percept in percepts)
    cold = np.stack([held(percept.psi_cold, n) for percept in percepts])
    warm = np.stack([held(percept.psi_warm, n) for percept in percepts])
    return cold, warm, dt
