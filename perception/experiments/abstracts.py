"""Simulations of the experiments of which an abstract is known.

A direction or an equality stands in most of them, and no condition that all of them share: what is assumed of site,
area and rate is said with each.
"""

import math
from collections.abc import Iterator

import numpy as np

from ..observer.channels import CHANNELS, Channel
from .laboratory import Laboratory
from .tasks import DisplayRamp, Key, Stimulated

LIMIT_K = 12.0
"""Where ramps of limits end: far above every threshold."""
AGE_YEARS = 24.5
"""Age that is assumed of all people, that of E3."""
ANY_LABORATORY = "E3"
"""Its offset is on both sides of each ratio."""
ORDERS: tuple[tuple[str, str, float, tuple[str, str], tuple[str, str], tuple[Channel, ...]], ...] = (
    ("E9 Greenspan", "ratio_limits_thenar_over_forearm", 9.0, ("thenar", "hand"), ("forearm", "forearm"), ("cold",)),
    ("E9 Hagander", "ratio_limits_thenar_over_wrist", 9.0, ("thenar", "hand"), ("forearm", "forearm"), CHANNELS),
    ("E9 Wakolbinger", "ratio_limits_palm_over_dorsum", 2.56, ("thenar", "hand"), ("hand-dorsum", "hand"), CHANNELS),
    ("E10", "ratio_limits_palm_over_finger", 2.56, ("thenar", "hand"), ("fingertip", "hand"), CHANNELS),
)
"""Experiment, statistic, area in cm² (9, and that of E10, are assumed), rig and site above and below the line of the
ratio, channels."""


def limit_ln(laboratory: Laboratory, place: tuple[str, str], channel: Channel, rest_C: float, area_cm2: float) -> float:
    """Mean log of the limits in K at 1 K/s from a resting temperature, at a place that is a rig and a site."""
    rig, site = place
    played = Stimulated.of(laboratory, DisplayRamp.held(rig, channel, rest_C, LIMIT_K, 1.0, 0.0))
    gain = laboratory.gain(channel, area_cm2, ANY_LABORATORY, site, AGE_YEARS)
    return float(np.log(played.limits_K(gain, site)).mean())


def order_of_sites(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
    """E9 and E10: limits at 1 K/s at one site over those of the same people at another."""
    for experiment, statistic, area_cm2, above, below, channels in ORDERS:
        for channel in channels:
            logs = (limit_ln(laboratory, place, channel, 32.0, area_cm2) for place in (above, below))
            yield (experiment, statistic, channel), next(logs) - next(logs)


PAD_CM2 = 1.5
"""Contact of one finger pad, that of the shipped fingertip; assumed."""
MATCHED_K = np.array([5.0, 7.0, 10.0])
"""Changes of two of three fingers."""
TRIED_K = np.geomspace(2.5, 10.0, 6)
"""Changes of three fingers, between which drive is taken for a power of the change."""
MATCHED_K_PER_S, MATCHED_S = 1.0, 5.0
"""Rate in K/s, and how long the end is held; assumed."""


def matched_fingers(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
    """E11: the change of three fingers over that of two which is felt as strong, multiples of threshold alike."""
    for channel in CHANNELS:
        ramps = [
            DisplayRamp.held("fingertip", channel, 32.0, size, MATCHED_K_PER_S, MATCHED_S) for size in TRIED_K.tolist()
        ]
        peaks = np.log([Stimulated.of(laboratory, ramp).peak for ramp in ramps])
        two, three = (
            math.log(laboratory.gain(channel, fingers * PAD_CM2, ANY_LABORATORY, "hand", AGE_YEARS))
            for fingers in (2, 3)
        )
        wanted = np.interp(np.log(MATCHED_K), np.log(TRIED_K), peaks) + two - three
        matched = np.interp(wanted, peaks, np.log(TRIED_K))
        yield ("E11", "three_fingers_match_two", channel), float((matched - np.log(MATCHED_K)).mean())


COOL_SKIN_C, USUAL_SKIN_C = 27.0, 32.0
"""Fingertips in rooms of about 15 and 25 °C; assumed, since the abstract has the rooms."""


def cool_skin(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
    """E12: from the change that is felt cool to the one that is felt warm, at cool skin over at usual skin."""

    def log_width(rest_C: float) -> float:
        limits = (limit_ln(laboratory, ("fingertip", "hand"), channel, rest_C, PAD_CM2) for channel in CHANNELS)
        return math.log(sum(map(math.exp, limits)))

    key = ("E12", "ratio_zone_width_cool_over_warm_skin", "both")
    yield key, log_width(COOL_SKIN_C) - log_width(USUAL_SKIN_C)


ADAPTED_C = (36.0, 40.0)
SMALL_K = 0.2
"""A small increase: the threshold of warmth on the thenar, where E13 is assumed to be."""


def warm_skin(laboratory: Laboratory) -> Iterator[tuple[Key, float]]:
    """E13: forced-choice thresholds of warmth from 40 °C over those from 36 °C, drive over change alike."""
    cooler, warmer = (
        math.log(Stimulated.of(laboratory, DisplayRamp.held("thenar", "warm", rest_C, SMALL_K, 1.0, 3.0)).peak)
        for rest_C in ADAPTED_C
    )
    yield ("E13", "ratio_thresholds_from_40_over_36", "warm"), cooler - warmer
