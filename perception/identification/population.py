"""Many people and many icons: receptor temperatures → responses → pairwise d′ → confusions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..arrays import Array
from ..observer.channels import Norm
from ..observer.observer import Observer
from ..observer.people import People
from ..sensation.detection import Detection, detect
from ..sensation.percept import perceive_many, uniform_clock
from .confusion import NAMED_SAMPLES, SAMPLES, Confusion, confuse, name_directly
from .episodes import Episodes, episode_distances
from .task import USUAL, Task

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

TAIL_S, RATE_HZ = 10.0, 100.0
"""Time after the longest icon, s, and rows of a run a second, as in `rank`."""


def run_end_s(durations_s: Iterable[float], rate_Hz: float = RATE_HZ) -> float:
    """End of a run of icons that last so long: `TAIL_S` after the longest, on a whole row, s."""
    return math.ceil((max(durations_s) + TAIL_S) * rate_Hz - 1e-6) / rate_Hz


PROBES = ("cold_receptor_C", "warm_receptor_C")
"""What people are simulated for: a batch of these alone can be superposed."""


@dataclass(frozen=True, slots=True)
class ReceptorTemperatures:
    """Temperatures at the receptors of every person: °C, shape (people, icons, n_time); clock in s, area in m².

    `names` are those of the icons, for messages.
    """

    cold_C: Array
    warm_C: Array
    time_s: Array
    site: str
    area_m2: float
    names: tuple[str, ...]

    @classmethod
    def simulated(
        cls, icons: Sequence[Icon], rigs: Sequence[Rig], rig: Rig, end_s: float, rate_Hz: float, tracking: str | None
    ) -> ReceptorTemperatures:
        """Simulate icons on the rigs of people until `end_s`, with currents that are designed on `rig`."""
        from thermicon.circuit import simulate_many

        batch = simulate_many(icons, rigs, nominal=rig, end_s=end_s, rate_Hz=rate_Hz, tracking=tracking, probes=PROBES)
        names = tuple(icon.name for icon in icons)
        return cls(batch.cold_C, batch.warm_C, batch.time_s, rig.site, rig.contact.area_m2, names)

    def of(self, icons: Sequence[int]) -> ReceptorTemperatures:
        """Some of the icons."""
        names = tuple(self.names[place] for place in icons)
        return replace(self, cold_C=self.cold_C[:, icons], warm_C=self.warm_C[:, icons], names=names)

    def thinned(self, people: int, every: int) -> ReceptorTemperatures:
        """The first people at every k-th instant, copied."""
        cold, warm = (held[:people, :, ::every].copy() for held in (self.cold_C, self.warm_C))
        return replace(self, cold_C=cold, warm_C=warm, time_s=self.time_s[::every])


@dataclass(frozen=True, slots=True)
class PopulationResponse:
    """Episodes of every person and icon, and detection probabilities (people, icons); None where not asked for."""

    episodes: Episodes
    detection: Detection | None

    def of(self, icons: Sequence[int]) -> PopulationResponse:
        """Some of the icons, without their detection."""
        places = list(icons)
        return PopulationResponse(Episodes(self.episodes.features[:, places], self.episodes.counts[:, places]), None)

    @property
    def detected(self) -> Detection:
        """Detection of every icon by every person; a ValueError where it was not asked for."""
        if self.detection is None:
            raise ValueError("detection was not asked for: call respond with detection")
        return self.detection


def respond(
    played: ReceptorTemperatures,
    crowd: People,
    observer: Observer,
    *,
    detection: bool = True,
    times: bool = False,
) -> PopulationResponse:
    """Episodes of every icon for every person, and whether it is reported.

    Without `detection` it takes a third of the time; `times` adds response times to it.
    """
    cold, warm, dt = _sensations(played, crowd, observer)
    found = _detection(cold, warm, dt, played.site, crowd, observer, times) if detection else None
    return PopulationResponse(Episodes.of(cold, warm, dt, observer, played.names), found)


def population_detection(played: ReceptorTemperatures, crowd: People, observer: Observer) -> Detection:
    """Detection (people, icons) of every icon by every person, without response times."""
    cold, warm, dt = _sensations(played, crowd, observer)
    return _detection(cold, warm, dt, played.site, crowd, observer, times=False)


def _sensations(played: ReceptorTemperatures, crowd: People, observer: Observer) -> tuple[Array, Array, float]:
    dt, rows = uniform_clock(played.time_s)
    cold, warm = perceive_many(
        played.cold_C[..., :rows],
        played.warm_C[..., :rows],
        dt,
        observer,
        area_m2=played.area_m2,
        site=played.site,
        threshold_cold=crowd.threshold_cold[:, None],
        threshold_warm=crowd.threshold_warm[:, None],
    )
    return cold, warm, dt


def _detection(
    cold: Array, warm: Array, dt_s: float, site: str, crowd: People, observer: Observer, times: bool
) -> Detection:
    return detect(
        cold,
        warm,
        dt_s,
        observer,
        path_m=observer.path_m(site) * crowd.path[:, None],
        criterion_cold=crowd.criterion_cold[:, None],
        criterion_warm=crowd.criterion_warm[:, None],
        decision_s=crowd.decision_s[:, None],
        times=times,
    )


def memory_dprime(felt: PopulationResponse, norm: Norm, memory: Array, observer: Observer, task: Task) -> Array:
    """Pairwise d′ from memory (people, icons, icons) by one norm; `memory` (people,) multiplies the memory noise."""
    apart: Array = episode_distances(felt.episodes, felt.episodes, observer, norm, memory)
    if task.carried:
        noise = memory[:, None, None]
        apart = apart * noise / task.between(noise, norm)
    return apart


def identify(
    felt: PopulationResponse,
    norm: Norm,
    crowd: People,
    observer: Observer,
    seed: int,
    samples: int = SAMPLES,
    first: int = 0,
    task: Task = USUAL,
) -> tuple[Array, Confusion]:
    """Pairwise d′ from memory (people, icons, icons) by one norm, and the confusions that follow.

    `first` is the number of the first person, on which the noise depends.
    """
    d_prime = memory_dprime(felt, norm, crowd.memory, observer, task)
    if norm == "naming":
        named = name_directly(
            felt.episodes, observer, memory=crowd.memory, louder=task.louder(crowd.memory, norm), lapse=crowd.lapse,
            seed=seed, samples=min(samples, NAMED_SAMPLES), first=first,
        )  # fmt: skip
        return d_prime, named
    return d_prime, confuse(d_prime, lapse=crowd.lapse, seed=seed, samples=samples, first=first)
