"""Simulated measurements under a condition on the skin of a rig.

The tasks are those of the published experiments; `measure` asks new laboratories, a pilot those that its data leave.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from thermicon.base.checks.arguments import checked
from thermicon.base.numbers.arrays import Array
from thermicon.circuit.rig.rig import AnyRig, Rig

from ..kernels.parallel import in_order
from ..observer.channels import CHANNELS, Channel
from ..observer.constants import BETWEEN_LABORATORIES, Both
from ..observer.draws import PosteriorDraws
from ..observer.mechanisms.age import YOUNG_YEARS
from ..observer.mechanisms.site import on_forearm
from ..observer.observer import Observer
from .laboratory import PEOPLE, SEED, Laboratory
from .tasks import UNSTATED, DisplayRamp, Stimulated, yes_no_logs

Kind = Literal["threshold", "reaction_time", "rating", "wrong_quality"]
METHODS: dict[Kind, tuple[str, ...]] = {
    "threshold": ("forced_choice", "yes_no", "limits"),
    "reaction_time": ("choice", "simple"),
    "rating": ("magnitude",),
    "wrong_quality": ("choice",),
}
"""Methods of each kind; the first of reaction times and ratings is meant where none is given."""
ADAPTIVE = ("forced_choice", "yes_no")
"""Methods that find the size themselves."""
UNITS: dict[Kind, str] = {"threshold": "K", "reaction_time": "s", "rating": "points", "wrong_quality": "1"}
"""Units inside; ratings are points of 100, wrong qualities a share of the answers."""
WORDS = {
    "forced_choice": "forced choice",
    "yes_no": "yes/no",
    "limits": "limits",
    "choice": "choice reaction time",
    "simple": "simple reaction time",
    "magnitude": "rating",
    "wrong_quality": "wrong quality of a speeded choice",
}
"""Methods in words, and the kind whose method does not say what is asked."""
OWN = "own"
"""Name of the laboratory whose offset is the user's."""
SITES = ("thenar", "forearm", "hand-dorsum", "fingertip")
"""Sites whose skin is shipped, as rigs of the same name."""
CHOICE_SIZES_K = np.geomspace(0.01, 8.0, 10)
YES_NO_SIZES_K = np.geomspace(0.05, 12.0, 9)
AFTER_S = 3.0
"""Seconds after a timed ramp in which an answer still counts."""
DRAWS, LEAST_DRAWS = 100, 2


@checked
@dataclass(frozen=True, slots=True)
class Condition:
    """A measured quantity with the ramp of the display used for it; changes and rates are without sign.

    Parameters
    ----------
    kind
        ``threshold``, ``reaction_time``, ``rating`` or ``wrong_quality``.
    method
        ``forced_choice``, ``yes_no`` or ``limits``; ``choice`` or ``simple``; ``magnitude``; ``choice``.
    channel
        ``cold`` or ``warm``.
    baseline_C
        Where the ramp starts, °C.
    size_K
        Change that was timed, rated or named, and where a ramp of limits ends, K; None for forced choice and yes/no.
    rate_K_per_s
        Rate of the ramp, K/s.
    hold_s
        How long its end is held, s.

    Raises
    ------
    ValueError
        For a method of another kind, a rate of 0, and a size that is missing.

    Examples
    --------
    >>> Condition("threshold", "limits", "cold", 32.0, 12.0, 1.0, 0.0).label
    'cold, limits, 1 K/s'
    """

    kind: Kind
    method: str
    channel: Channel
    baseline_C: float
    size_K: float | None
    rate_K_per_s: float
    hold_s: float

    def __post_init__(self) -> None:
        if self.kind not in get_args(Kind) or self.method not in METHODS[self.kind] or self.channel not in CHANNELS:
            raise ValueError(f"there is no {self.kind} by {self.method} of {self.channel}")
        if not self.rate_K_per_s > 0.0 or not self.hold_s >= 0.0:
            raise ValueError("a rate above 0 and a hold of at least 0 s are needed")
        if self.method not in ADAPTIVE and (self.size_K is None or not self.size_K > 0.0):
            raise ValueError(f"{self.words} needs the size of the change, above 0 K")

    @property
    def unit(self) -> str:
        """Unit of its values."""
        return UNITS[self.kind]

    @property
    def words(self) -> str:
        """The method in words."""
        return WORDS.get(self.kind, WORDS[self.method])

    @property
    def label(self) -> str:
        """The quantity in words."""
        words = f"{self.channel}, {self.words}"
        if self.kind == "threshold":
            return f"{words}, {self.rate_K_per_s:g} K/s"
        return f"{words}, {self.size_K:g} K at {self.rate_K_per_s:g} K/s"


@dataclass(frozen=True, slots=True)
class Setting:
    """Skin, contact and area under which measurements were made."""

    site_rig: str
    contact_m2K_per_W: float
    area_cm2: float

    @classmethod
    def of(cls, rig: Rig) -> Setting:
        """The setting of a rig; a ValueError for a site whose skin is not known."""
        if rig.site not in SITES:
            raise ValueError(
                f"measurements can be simulated at {', '.join(SITES)}; {rig.name} is at {rig.site!r}: give a rig of "
                "one of these sites"
            )
        return cls(rig.site, rig.contact.resistance_m2K_per_W, rig.contact.area_m2 * 1e4)

    @property
    def path_site(self) -> str:
        """Site by which thresholds and paths to the cord differ."""
        return "forearm" if on_forearm(self.site_rig) else "hand"

    def laboratory(
        self, constants: Observer, offsets: Sequence[float], people: int = PEOPLE, seed: int = SEED
    ) -> Laboratory:
        """A laboratory that measures here; its people are so much more sensitive (ln), by `offsets`."""
        met = replace(constants, contact_m2K_per_W=self.contact_m2K_per_W)
        return Laboratory.of(met, {OWN: Both(*offsets)}, people, seed)


def logs_of(
    laboratory: Laboratory, setting: Setting, condition: Condition, sizes_K: Array = CHOICE_SIZES_K
) -> tuple[Array, float]:
    """Log value of each person (people,), and the SD of the log of one trial (UNSTATED where there is none).

    A threshold by forced choice lies between `sizes_K`, linear in logarithms.
    """
    site, channel, limits = setting.path_site, condition.channel, condition.method == "limits"
    gain = laboratory.gain(channel, setting.area_cm2, OWN, site, YOUNG_YEARS)

    def ramp(size_K: float, hold_s: float) -> DisplayRamp:
        return DisplayRamp.held(setting.site_rig, channel, condition.baseline_C, size_K, condition.rate_K_per_s, hold_s)

    if condition.method == "yes_no":
        ramps = [ramp(size, condition.hold_s) for size in YES_NO_SIZES_K.tolist()]
        return yes_no_logs(laboratory, ramps, gain)[0], UNSTATED
    if condition.method == "forced_choice":
        peaks = [Stimulated.of(laboratory, ramp(size, condition.hold_s)).peak for size in sizes_K.tolist()]
        logs = np.maximum.accumulate(np.log(peaks))
        rising = np.append(True, np.diff(logs) > 0.0)
        wanted = np.log(laboratory.people.threshold(channel) / gain)
        return np.interp(wanted, logs[rising], np.log(sizes_K)[rising]), UNSTATED
    assert condition.size_K is not None
    timed = condition.kind == "reaction_time"
    hold_s = 0.0 if limits else max(condition.hold_s, AFTER_S) if timed else condition.hold_s
    played = Stimulated.of(laboratory, ramp(condition.size_K, hold_s))
    if limits:
        logs = np.log(played.limits_K(gain, site))
        return logs.mean(axis=1), float(np.median(logs.std(axis=1)))
    if timed:
        times = played.answers_s(gain, site, choice=condition.method == "choice")
        logs = np.log(np.minimum(times, condition.size_K / condition.rate_K_per_s + AFTER_S + 1.0))
        return np.median(logs, axis=1), float(np.median(logs.std(axis=1)))
    constants = laboratory.constants
    exponent, unit = constants.rating_exponent.of(channel), constants.rating_at_threshold.of(channel)
    logs = math.log(unit) + exponent * (math.log(played.peak * gain) - np.log(laboratory.people.threshold(channel)))
    scatter = constants.rating_scatter / math.exp(float(logs.mean()))
    return logs, math.hypot(scatter, exponent * constants.gain_noise)


def misnamed_of(laboratory: Laboratory, setting: Setting, condition: Condition) -> tuple[Array, float]:
    """Share (people,) of the answers of a speeded choice that name the wrong quality, and the SD of one answer."""
    assert condition.size_K is not None
    cold, warm = (laboratory.gain(each, setting.area_cm2, OWN, setting.path_site, YOUNG_YEARS) for each in CHANNELS)
    about = setting.site_rig, condition.channel, condition.baseline_C, condition.size_K, condition.rate_K_per_s
    played = Stimulated.of(laboratory, DisplayRamp.held(*about, max(condition.hold_s, AFTER_S)))
    shares = played.misnamed(Both(cold, warm).of(condition.channel), warm, setting.path_site)
    return shares, float(np.median(np.sqrt(shares * (1.0 - shares))))


@dataclass(frozen=True, slots=True)
class Measurement:
    """Predicted measurements of new laboratories under a condition; medians over laboratories.

    Attributes
    ----------
    condition
        What is measured.
    value, low, high
        Geometric mean over people in the unit of the condition, and its 95 % interval.
    between, within
        SD of the natural log of a value between people, and of one trial of the median person. Of wrong qualities they,
        like `value`, are of the share itself.

    See Also
    --------
    measure : Predicts it.
    """

    condition: Condition
    value: float
    low: float
    high: float
    between: float
    within: float

    def __repr__(self) -> str:
        unit, log = ("", "") if self.condition.unit == "1" else (f" {self.condition.unit}", " ln")
        span = f"{self.value:.3g}{unit} [{self.low:.3g}, {self.high:.3g}]"
        return f"Measurement({self.condition.label}: {span}, SD between people {self.between:.2f}{log})"


@checked
def measure(
    condition: Condition,
    rig: AnyRig = "thenar",
    *,
    draws: int = DRAWS,
    seed: int = 0,
    posterior: PosteriorDraws | None = None,
) -> Measurement:
    """Predict what a laboratory that nobody knows would measure of young people.

    Parameters
    ----------
    condition
        What is measured, and with which ramp.
    rig
        The rig, or its name or file: site, contact and area count; the display is taken to follow the ramp.
    draws
        Laboratories, each with constants of another draw of the posterior and an offset of its own.
    seed
        Seed of the offsets.
    posterior
        Draws of the constants (None: the shipped ones).

    Returns
    -------
    Measurement
        The same numbers for the same arguments.

    Raises
    ------
    ValueError
        For a site whose skin is not known, and fewer than two draws.

    Notes
    -----
    Tasks after E1 to E4, E6 and E8 of the evidence. Forced choice is correct in 76 % at threshold (d′ = 1), yes/no
    reported in half of the trials with the criterion of questions without haste, limits pressed at the first change. A
    rating is a power of the largest drive; another laboratory's scale may differ by a factor. A wrong quality is a
    speeded choice that noise of the other channel decides, or cold that is called warm; who feels nothing guesses.

    Examples
    --------
    >>> from thermicon.circuit import Rig
    >>> found = measure(Condition("threshold", "limits", "cold", 32.0, 12.0, 1.0, 0.0), Rig.load("forearm"), draws=20)
    >>> found.low < found.value < found.high, found.condition.unit
    (True, 'K')

    """
    if draws < LEAST_DRAWS:
        raise ValueError(f"an interval needs at least {LEAST_DRAWS} laboratories, not {draws}")
    rig = Rig.of(rig)
    setting, known = Setting.of(rig), posterior or PosteriorDraws.load()
    chosen = known.spaced(draws)
    standard = np.random.default_rng(seed).standard_normal((draws, len(CHANNELS)))
    offsets = (known.values(BETWEEN_LABORATORIES)[chosen][:, None] * standard).tolist()
    shares = condition.kind == "wrong_quality"

    def one(k: int) -> tuple[float, float, float]:
        laboratory = setting.laboratory(known.observer(chosen[k]), offsets[k])
        found, within = (misnamed_of if shares else logs_of)(laboratory, setting, condition)
        return float(found.mean()), float(found.std()), within

    mean, between, within = np.array(list(in_order(one, range(draws)))).T
    ends = np.percentile(mean, [2.5, 50.0, 97.5])
    low, middle, high = (ends if shares else np.exp(ends)).tolist()
    return Measurement(condition, middle, low, high, float(np.median(between)), float(np.median(within)))
