"""The effect of each mechanism on a cue: the same stimulus with or without it, as curves.

Skin is that of the inference under its own thermode, receptors and sensation are the shipped observer's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtri

from thermicon.base.numbers.arrays import Array
from thermicon.circuit.solver.modes import thermode_modes
from thermicon.perception.experiments.laboratory import Corner, course_of, load_rig
from thermicon.perception.observer.channels import CHANNELS, SIGN, Channel
from thermicon.perception.observer.mechanisms.bounds import NO_LIMIT_C
from thermicon.perception.observer.observer import Observer
from thermicon.perception.sensation.detection import detect

Look = Literal["cold", "warm", "reference", "off", "other"]
"""How a curve is drawn: in a channel's colour, thin for a reference, dashed grey for a mechanism turned off."""
DT_S = 0.02
STRIPS_CM2 = 9.8


@dataclass(frozen=True, slots=True)
class Curve:
    """One curve by its label: `x` and `y` (n,), in the units of the axes of its effect."""

    label: str
    look: Look
    x: Array
    y: Array


@dataclass(frozen=True, slots=True)
class Effect:
    """What a mechanism does to a cue: curves with and without it, and what the axes show."""

    title: str
    x_label: str
    y_label: str
    curves: tuple[Curve, ...]
    log_x: bool = False
    log_y: bool = False


def limits_effect() -> Effect:
    """A slow fall from 38 to 31 °C: cold with its limit and without, and warmth, which is what fades first."""
    time, whole = _clock(42.0), Observer.load()
    free = replace(whole, limit_C=NO_LIMIT_C)
    corners: list[Corner] = [(2.0, 6.0), (30.0, 6.0), (37.0, -1.0)]
    curves = [
        Curve("warm", "warm", time, _felt(corners, "warm", whole, time)),
        Curve("cold", "cold", time, _felt(corners, "cold", whole, time)),
        Curve("cold, limit off", "off", time, _felt(corners, "cold", free, time)),
    ]
    return Effect("Held at 38 °C, then a fall to 31 °C at 1 K/s (forearm)", "time (s)", "sensation (d′)", tuple(curves))


def adaptation_effect() -> Effect:
    """Skin held 1, 3 and 8 K colder for a minute: cold fades inside the neutral zone, and stays beyond it."""
    time, observer = _clock(60.0), Observer.load()
    sizes: tuple[tuple[float, Look], ...] = ((8.0, "cold"), (3.0, "reference"), (1.0, "other"))
    curves = []
    for size, look in sizes:
        felt = _felt([(1.0, 0.0), (1.0 + size / 2.0, -size)], "cold", observer, time)
        curves.append(Curve(f"to {32.0 - size:.0f} °C", look, time, felt))
    title = "A held fall from 32 °C: complete adaptation to 30 °C"
    return Effect(title, "time (s)", "sensation of cold (d′)", tuple(curves))


def depth_effect() -> Effect:
    """A fall by 5 K in 0.5 s at the cold receptors of thenar and forearm, for two ways to count their depth."""
    time, observer = _clock(4.0), Observer.load()
    sites: tuple[tuple[str, Look, Look], ...] = (("forearm", "cold", "off"), ("thenar", "reference", "other"))
    curves = []
    for site, below, surface in sites:
        for counted, at, look in (
            ("below a share of the corneum", observer.depths_m(load_rig(site).skin.corneum_m).cold, below),
            ("0.15 mm from the surface", 0.15e-3, surface),
        ):
            change = _course(site, at, 32.0, [(0.5, -5.0)], time.size)
            curves.append(Curve(f"{site}, {counted}", look, time, change - change[0]))
    return Effect(
        "A fall by 5 K in 0.5 s at the cold receptors", "time (s)", "change of temperature (K)", tuple(curves)
    )


def summation_effect() -> Effect:
    """Sensitivity against the area of contact, with the two ends of summation and without."""
    area = np.geomspace(0.02, 5000.0, 120)
    observer, curves = Observer.load(), []
    for channel in CHANNELS:
        ratio = np.array([observer.sensitivity(channel, a * 1e-4, None) for a in area.tolist()])
        curves.append(Curve(channel, channel, area, ratio))
    ends_off: tuple[tuple[Channel, Look], ...] = (("cold", "off"), ("warm", "other"))
    for channel, look in ends_off:
        power = (area / (observer.reference_area_m2 * 1e4)) ** observer.area_exponent.of(channel)
        curves.append(Curve(f"{channel}, no ends", look, area, power))
    title = "Sensitivity by area of contact (1 at 9 cm²)"
    return Effect(title, "area of contact (cm²)", "sensitivity", tuple(curves), log_x=True, log_y=True)


def transducer_effect() -> Effect:
    """Sensation against drive for the inferred exponent, a linear observer and the square law."""
    drive, whole = np.geomspace(0.2, 60.0, 120), Observer.load()
    curves = [
        Curve(f"p = {whole.p:.2g} (inferred)", "cold", drive, whole.psi(drive)),
        Curve("p = 1 (linear near threshold)", "reference", drive, replace(whole, p=1.0).psi(drive)),
        Curve("p = 2 (square law)", "off", drive, replace(whole, p=2.0).psi(drive)),
    ]
    title = "Sensation by receptor drive"
    return Effect(title, "drive (multiples of threshold)", "sensation (d′)", tuple(curves), log_x=True, log_y=True)


def gain_noise_effect() -> Effect:
    """The psychometric function of a fall of temperature, with noise of the gain and without."""
    sizes = np.linspace(0.02, 1.4, 60)
    whole = Observer.load()
    curves = [
        Curve("gain noise", "cold", sizes, 100.0 * _noticed(sizes, whole)),
        Curve("additive noise alone", "off", sizes, 100.0 * _noticed(sizes, replace(whole, gain_noise=0.0))),
    ]
    title = "One person, a fall at 2.5 K/s and 1.5 s of hold (forearm)"
    return Effect(title, "size of the fall (K)", "noticed (%)", tuple(curves))


def criteria_effect() -> Effect:
    """The same for people with a low, a middle and a high criterion."""
    sizes, observer, curves = np.linspace(0.02, 3.0, 60), Observer.load(), []
    # Cautious people have a high criterion: the last number is the share of people with a lower one.
    people: tuple[tuple[str, Look, float], ...] = (
        ("lax (5th percentile)", "other", 0.05),
        ("middle", "cold", 0.5),
        ("cautious (95th percentile)", "reference", 0.95),
    )
    for words, look, share in people:
        criterion = float(np.exp(observer.criterion_between * ndtri(share)))
        curves.append(Curve(words, look, sizes, 100.0 * _noticed(sizes, observer, criterion)))
    return Effect("Three people who differ in criterion alone", "size of the fall (K)", "noticed (%)", tuple(curves))


EFFECTS: Mapping[str, Callable[[], Effect]] = {
    "limits": limits_effect,
    "adaptation": adaptation_effect,
    "depth": depth_effect,
    "summation": summation_effect,
    "transducer": transducer_effect,
    "gain-noise": gain_noise_effect,
    "criteria": criteria_effect,
}
"""Every effect by the name of its picture."""


def _clock(end_s: float) -> Array:
    clock: Array = DT_S * np.arange(round(end_s / DT_S) + 1, dtype=np.float64)
    return clock


def _course(site: str, depth_m: float, baseline_C: float, corners: Sequence[Corner], rows: int) -> Array:
    """Temperature (rows,) at a depth below the face of a site's skin under the thermode, °C."""
    whole = Observer.load()
    skin = thermode_modes(load_rig(site), (depth_m,), whole.contact_m2K_per_W, whole.effusivity)
    return course_of(skin.rise(0, DT_S, rows), skin.rest(0, baseline_C), corners, DT_S, rows)


def _felt(
    corners: Sequence[Corner], channel: Channel, observer: Observer, time: Array, *, baseline_C: float = 32.0
) -> Array:
    """Sensation (n_time,) of a thermode on the forearm that goes from corner to corner."""
    depth = observer.depths_m(load_rig("forearm").skin.corneum_m).of(channel)
    received = _course("forearm", depth, baseline_C, corners, time.size)
    drive = observer.drive(received, DT_S, channel)
    return observer.sensation(drive, channel, area_m2=STRIPS_CM2 * 1e-4, site="forearm")


def _noticed(sizes_K: Array, observer: Observer, criterion: ArrayLike = 1.0) -> Array:
    """Probability (sizes,) that a fall is noticed, false alarms taken out."""
    time, sign = _clock(4.0), SIGN["cold"]
    felt = np.stack(
        [_felt([(size / 2.5, sign * size), (time[-1], sign * size)], "cold", observer, time) for size in sizes_K]
    )
    return detect(felt, np.zeros_like(felt), DT_S, observer, criterion_cold=criterion).probability
