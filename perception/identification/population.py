"""The chain for many people and many icons: receptor temperatures → responses → pairwise d′ → confusions."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.base.numbers.arrays import Array

from ..observer.channels import MemoryForm
from ..observer.constants import Both
from ..observer.observer import Observer
from ..observer.people import People
from ..sensation.detection import Detection, detect
from ..sensation.percept import perceive_many
from ..sensation.received import uniform_clock
from .confusion import NAMED_SAMPLES, SAMPLES, Confusion, confuse, few_named, name_directly
from .depths import between
from .episodes import Episodes, episode_distances
from .measures import information_bits
from .task import USUAL, Task
from .tracks import Tracks

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.circuit.solver.batch import Batch
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
    """Temperatures at the receptors of every person: °C; clock in s, area in m².

    `rungs_C` has those of cold and of warm receptors, (depths, people, icons, n_time) each: at `depths_m`, between
    which the receptors of many observers lie, or, where that is empty, of the one they were simulated for.
    """

    rungs_C: tuple[Array, Array]
    depths_m: tuple[Both[float], ...]
    corneum_m: Array
    time_s: Array
    site: str
    area_m2: float
    names: tuple[str, ...]

    @classmethod
    def simulated(
        cls, icons: Sequence[Icon], crowd: People, rig: Rig, observer: Observer, end_s: float, rate_Hz: float,
        tracking: str | None, probes: tuple[str, str] = PROBES,
    ) -> ReceptorTemperatures:  # fmt: skip
        """Simulate icons on the skins of people until `end_s`, with currents that are designed on `rig`."""
        from thermicon.circuit import simulate_many

        rigs = crowd.rigs(rig, [observer.depths_m(each) for each in crowd.corneum_m(rig).tolist()])
        batch = simulate_many(icons, rigs, nominal=rig, end_s=end_s, rate_Hz=rate_Hz, tracking=tracking, probes=probes)
        return cls._of([batch], (), crowd, rig, icons)

    @classmethod
    def at_depths(
        cls, icons: Sequence[Icon], crowd: People, rig: Rig, depths_m: tuple[Both[float], ...], end_s: float,
        rate_Hz: float, tracking: str | None, probes: tuple[str, str] = PROBES, designed_on: Rig | None = None,
    ) -> ReceptorTemperatures:  # fmt: skip
        """The same for observers whose receptors lie between these depths; a rig that places its own keeps them."""
        from thermicon.circuit import simulate_many

        rungs_m = depths_m[:1] if rig.skin.own else depths_m
        skins = [crowd.rigs(rig, [each] * len(crowd)) for each in rungs_m]
        how: dict[str, Any] = {"rate_Hz": rate_Hz, "tracking": tracking, "probes": probes}
        each = [simulate_many(icons, rigs, nominal=designed_on or rig, end_s=end_s, **how) for rigs in skins]
        return cls._of(each, () if rig.skin.own else rungs_m, crowd, rig, icons)

    @classmethod
    def _of(
        cls, played: Sequence[Batch], depths_m: tuple[Both[float], ...], crowd: People, rig: Rig, icons: Sequence[Icon]
    ) -> ReceptorTemperatures:
        several = len(played) > 1
        cold, warm = (np.stack([each.values[k] for each in played]) if several else played[0].values[k][np.newaxis]
                      for k in range(2))  # fmt: skip
        names, first = tuple(icon.name for icon in icons), played[0]
        return cls((cold, warm), depths_m, crowd.corneum_m(rig), first.time_s, rig.site, rig.contact.area_m2, names)

    @property
    def people(self) -> int:
        """Number of people."""
        return self.corneum_m.size

    def felt_by(self, observer: Observer) -> tuple[Array, Array]:
        """Temperatures (people, icons, n_time) at the receptors of an observer, cold and warm."""
        if not self.depths_m:
            return self.rungs_C[0][0], self.rungs_C[1][0]
        above_m = observer.corneum_share * self.corneum_m
        columns = zip(zip(*self.depths_m, strict=True), self.rungs_C, observer.depth_m, strict=True)
        cold, warm = (between(depths, rungs_C, above_m + own_m) for depths, rungs_C, own_m in columns)
        return cold, warm

    def first(self, people: int) -> ReceptorTemperatures:
        """Those of the first people."""
        cold, warm = (rungs_C[:, :people] for rungs_C in self.rungs_C)
        return replace(self, rungs_C=(cold, warm), corneum_m=self.corneum_m[:people])


@dataclass(frozen=True, slots=True)
class TrackTemperatures:
    """Temperatures at the receptors for the tracks of icons, one rig after the other."""

    parts: tuple[ReceptorTemperatures, ...]
    tracks: Tracks

    @classmethod
    def of(cls, tracks: Tracks, part: Callable[[Sequence[Icon], Rig], ReceptorTemperatures]) -> TrackTemperatures:
        """Those that `part` finds for the icons on each rig."""
        return cls(tuple(part(icons, rig) for rig, icons in tracks.by_rig), tracks)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the icons."""
        return self.tracks.names

    def first(self, people: int) -> TrackTemperatures:
        """Those of the first people."""
        return replace(self, parts=tuple(part.first(people) for part in self.parts))


AnyTemperatures = ReceptorTemperatures | TrackTemperatures


@dataclass(frozen=True, slots=True)
class PopulationResponse:
    """Episodes of every person and icon, and detection probabilities (people, icons); None where not asked for.

    Of icons on several elements the episodes are those of the `tracks`.
    """

    episodes: Episodes
    detection: Detection | None
    tracks: Tracks | None = None

    @property
    def icons(self) -> int:
        """Number of icons."""
        return int(self.episodes.counts.shape[1]) if self.tracks is None else len(self.tracks.names)

    @property
    def surfaces(self) -> int:
        """Number of surfaces that are felt apart."""
        return 1 if self.tracks is None else len(self.tracks.surfaces)

    @property
    def detected(self) -> Detection:
        """Detection of every icon by every person; a ValueError where it was not asked for."""
        if self.detection is None:
            raise ValueError("detection was not asked for: call respond with detection")
        return self.detection


def respond(
    played: AnyTemperatures, crowd: People, observer: Observer, *, detection: bool = True, times: bool = False
) -> PopulationResponse:
    """Episodes of every icon for every person, optionally with detection and with the times of its reports."""
    if isinstance(played, TrackTemperatures):
        parts = [respond(part, crowd, observer, detection=detection, times=times) for part in played.parts]
        if (places := played.tracks.played) is None:
            return parts[0]
        from .surfaces import detected_by_any, joined

        seen = detected_by_any([part.detected for part in parts], places) if detection else None
        return PopulationResponse(joined([part.episodes for part in parts]), seen, played.tracks)
    cold, warm, dt = _sensations(played, crowd, observer)
    found = _detection(cold, warm, dt, played.site, crowd, observer, times) if detection else None
    return PopulationResponse(Episodes.of(cold, warm, dt, observer, played.names), found)


def population_detection(played: ReceptorTemperatures, crowd: People, observer: Observer) -> Detection:
    """Detection (people, icons) of every icon by every person, without response times."""
    cold, warm, dt = _sensations(played, crowd, observer)
    return _detection(cold, warm, dt, played.site, crowd, observer, times=False)


def _sensations(played: ReceptorTemperatures, crowd: People, observer: Observer) -> tuple[Array, Array, float]:
    dt, rows = uniform_clock(played.time_s)
    at_cold, at_warm = played.felt_by(observer)
    cold, warm = perceive_many(
        at_cold[..., :rows],
        at_warm[..., :rows],
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


def memory_dprime(felt: PopulationResponse, form: MemoryForm, memory: Array, observer: Observer, task: Task) -> Array:
    """Pairwise d′ from memory (people, icons, icons) by one form; `memory` (people,) multiplies its noise."""
    apart: Array = episode_distances(felt.episodes, felt.episodes, observer, form, memory)
    if felt.tracks is not None and felt.tracks.played is not None:
        from .surfaces import added

        return added(apart, felt.tracks.played)
    if task.carried:
        noise = memory[:, None, None]
        apart = apart * noise / task.between(noise, form)
    return apart


def identify(
    felt: PopulationResponse,
    form: MemoryForm,
    crowd: People,
    observer: Observer,
    seed: int,
    samples: int = SAMPLES,
    first: int = 0,
    task: Task = USUAL,
    d_prime: Array | None = None,
) -> Confusion:
    """Confusions with the noise of people numbered from `first`; `d_prime` are those of the form, where known."""
    lapse = crowd.lapse if felt.tracks is None else felt.tracks.lapses(crowd.lapse)
    if form == "naming" and felt.tracks is not None and felt.tracks.played is not None:
        from .surfaces import name_apart

        return name_apart(
            felt.episodes, felt.tracks, observer, memory=crowd.memory, lapse=lapse, seed=seed,
            samples=min(samples, NAMED_SAMPLES), first=first,
        )  # fmt: skip
    if form == "naming":
        return name_directly(
            felt.episodes, observer, memory=crowd.memory, louder=task.louder(crowd.memory, form), lapse=crowd.lapse,
            seed=seed, samples=min(samples, NAMED_SAMPLES), first=first,
        )  # fmt: skip
    apart = memory_dprime(felt, form, crowd.memory, observer, task) if d_prime is None else d_prime
    return confuse(apart, lapse=lapse, seed=seed, samples=samples, first=first)


@dataclass(frozen=True, slots=True)
class Identification:
    """How people name icons: `d_prime` (people, icons, icons) by the first form of memory, confusions by every form.

    `shares` are those of laboratories with each form, with which the mean over forms is taken.
    """

    d_prime: Array
    by_form: Mapping[MemoryForm, Confusion]
    shares: Mapping[MemoryForm, float]

    @property
    def probability(self) -> Array:
        """Confusions (people, icons, icons), the mean over forms."""
        return np.asarray(sum(self.shares[form] * each.probability for form, each in self.by_form.items()))

    @property
    def bits(self) -> Array:
        """Information (people,), bits: the mean over forms, of which a laboratory has one."""
        each = ((self.shares[form], information_bits(named.probability)) for form, named in self.by_form.items())
        return np.asarray(sum(share * bits for share, bits in each))


def form_samples(forms: Collection[MemoryForm], icons: int, surfaces: int = 1) -> dict[MemoryForm, int]:
    """Trials of an icon for each person, by form; where both count, fewer are named directly."""
    return {"episodes": SAMPLES, "naming": few_named(icons, surfaces) if len(forms) > 1 else NAMED_SAMPLES}


def identify_by(
    felt: PopulationResponse,
    shares: Mapping[MemoryForm, float],
    crowd: People,
    observer: Observer,
    seed: int,
    first: int = 0,
    task: Task = USUAL,
) -> Identification:
    """The same by every form, of which laboratories have these shares."""
    forms, samples = list(shares), form_samples(shares, felt.icons, felt.surfaces)
    d_prime = memory_dprime(felt, forms[0], crowd.memory, observer, task)
    known = {forms[0]: d_prime}
    found = {
        form: identify(felt, form, crowd, observer, seed, samples[form], first, task, known.get(form)) for form in forms
    }
    return Identification(d_prime, found, shares)
