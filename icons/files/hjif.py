"""Icons as HJIF, the JSON interchange form of MPEG haptics (ISO/IEC 23090-31): experimental, see ``to_hjif``."""

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from fractions import Fraction
from itertools import islice
from typing import Any

from ..model.corners import Corners
from ..model.icon import Icon
from ..model.iconset import IconSet
from ..model.units import decimal_text

PAUSE_S = 10
"""Between two icons of a file, in s: the player adds up what it plays at one time, so they follow one another."""
# Perceptions of a file in the profile Main at level 1; ticks per second.
MOST_ICONS = 128
_COARSEST, _FINEST = 1000, 48_000
EXPERIMENTAL = "experimental: the unit of Temperature in ISO/IEC 23090-31 was not available to check"
_PRESCRIBED = {"skin": "temperature of the skin surface", "display": "temperature of the display"}


class HjifError(ValueError):
    """Icons that HJIF cannot take; the message says which, why, and what to do."""


@dataclass(frozen=True, slots=True)
class _Track:
    """One icon in ticks: its place in time, full scale in K, keyframes of tick and amplitude."""

    icon: Icon
    start: int
    gain_K: float
    keyframes: tuple[tuple[int, float], ...]


def to_hjif(icons: IconSet | Iterable[Icon], date: datetime | None = None) -> str:
    """Return icons as the text of an HJIF file (experimental: never read by MPEG's own software).

    Parameters
    ----------
    icons
        A set, or icons with a baseline.
    date
        Date of the file; None: now.

    Returns
    -------
    str
        JSON with one perception of modality Temperature per icon.

    Raises
    ------
    HjifError
        For icons under current control or without a baseline, and for more than 128 icons.

    Notes
    -----
    Each perception has one channel and one Curve band of straight lines. Amplitude (-1 to 1) times the channel's
    gain is the change from the baseline in K. This convention is our own, since the standard's text was not
    available for its unit; the file states so. Icons follow one another after 10 s of baseline. Times are in ticks:
    exact where a timescale of at most 48000 ticks/s permits, otherwise rounded to the nearest tick, which the file
    states. A step takes one tick.

    Examples
    --------
    >>> from thermicon.icons import read_cue
    >>> document = json.loads(to_hjif(read_cue("cooling-step-skin")))
    >>> document["perceptions"][0]["channels"][0]["gain"]
    6.0
    """
    title = ""
    if isinstance(icons, IconSet):
        title = icons.title or icons.name
        icons = icons.icons
    taken = list(islice(icons, MOST_ICONS + 1))
    _check(taken)
    corners = [icon.corners() for icon in taken]
    timescale = ticks_per_second(corners)
    tracks, start = [], 0
    for icon, one in zip(taken, corners, strict=True):
        tracks.append(_track(icon, one, timescale, start))
        start += tracks[-1].keyframes[-1][0] + PAUSE_S * timescale
    document = {
        "version": "2023",
        "profile": "Main",
        "level": 1,
        "date": (date or datetime.now(UTC)).replace(microsecond=0).isoformat(),
        "description": _description(title, tracks, corners, timescale),
        "timescale": timescale,
        "avatars": [],
        "perceptions": [_perception(place, track) for place, track in enumerate(tracks)],
        "syncs": [],
    }
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def ticks_per_second(corners: Iterable[Corners]) -> int:
    """Return the timescale: 1000, or the smallest multiple up to 48000 in which every corner falls on a tick.

    48000 is returned when there is none; so it is, or the largest that fits, where icons have steps.

    >>> ticks_per_second([Corners((0.0, 1 / 3), (32.0, 33.0), "temperature_C")])
    3000
    """
    listed = list(corners)
    exact = 1
    for one in listed:
        for time in one.time_s:
            exact = math.lcm(exact, Fraction(time).limit_denominator(_FINEST).denominator)
            if exact > _FINEST:
                return _FINEST
    if any(one.steps for one in listed):
        return exact * (_FINEST // exact)
    together = math.lcm(exact, _COARSEST)
    return together if together <= _FINEST else exact * -(-_COARSEST // exact)


def _check(icons: list[Icon]) -> None:
    if not icons:
        raise HjifError("there is no icon to write")
    if len(icons) > MOST_ICONS:
        raise HjifError(f"HJIF takes {MOST_ICONS} icons per file at most (profile Main, level 1); choose among them")
    for icon in icons:
        if icon.context.control == "current":
            help = "write the set with control skin or display, or export the current as a waveform"
            raise HjifError(f"icon {icon.name} prescribes a current in A, HJIF has no such perception; {help}")
        if icon.context.baseline_C is None:
            help = 'say it in the set block, such as "baseline 32 °C"'
            raise HjifError(f"icon {icon.name} has no baseline, from which HJIF counts temperatures; {help}")


def _track(icon: Icon, corners: Corners, timescale: int, start: int) -> _Track:
    baseline = icon.context.baseline_C or 0.0
    changes = [round(value - baseline, 12) for value in corners.value]
    gain = max(map(abs, changes)) or 1.0
    keyframes: list[tuple[int, float]] = []
    for time, change in zip(corners.time_s, changes, strict=True):
        tick = round(time * timescale)
        if keyframes:  # the two ends of a step share their tick
            tick = max(tick, keyframes[-1][0] + 1)
        keyframes.append((tick, round(change / gain, 12) + 0.0))
    if keyframes[-1][1] != 0:  # what a player does behind the last keyframe is 0, that is, baseline
        keyframes.append((keyframes[-1][0] + 1, 0.0))
    return _Track(icon, start, gain, tuple(keyframes))


def _perception(place: int, track: _Track) -> dict[str, Any]:
    icon, context = track.icon, track.icon.context
    level = decimal_text(context.baseline_C or 0.0)
    site = f", {context.site}" if context.site else ""
    means = f": {icon.metadata.means}" if icon.metadata.means else ""
    effect = {
        "effect_type": "Basis",
        "position": track.start,
        "phase": 0.0,
        "base_signal": "Sine",
        "keyframes": [{"relative_position": tick, "amplitude_modulation": value} for tick, value in track.keyframes],
    }
    band = {
        "band_type": "Curve",
        "curve_type": "Linear",
        "lower_frequency_limit": 0,
        "upper_frequency_limit": 1000,
        "effects": [effect],
    }
    channel = {
        "id": 0,
        "description": f"{_PRESCRIBED[context.control]}{site}: amplitude x gain = K from {level} degC",
        "gain": track.gain_K,
        "mixing_coefficient": 1.0,
        "body_part_mask": 0,
        "bands": [band],
    }
    return {
        "id": place,
        "avatar_id": 0,
        "description": f"{icon.name}{means}",
        "perception_modality": "Temperature",
        "unit_exponent": -3,
        "perception_unit_exponent": 0,
        "reference_devices": [],
        "effect_library": [],
        "channels": [channel],
    }


def _description(title: str, tracks: list[_Track], corners: list[Corners], timescale: int) -> str:
    levels = sorted({track.icon.context.baseline_C or 0.0 for track in tracks})
    said = " and ".join(f"{decimal_text(level)} degC" for level in levels)
    parts = [
        f"{title or 'thermal icons'}, written by thermicon; {EXPERIMENTAL}",
        f"convention: amplitude (-1 to 1) x gain of the channel = change in K from the baseline of {said}",
    ]
    off = _rounding_s(corners, timescale)
    if off > 1e-6:
        parts.append(f"corner times rounded to the nearest 1/{timescale} s, by {off * 1e6:.1f} us at most")
    if any(one.steps for one in corners):
        parts.append(f"steps take one tick of 1/{timescale} s")
    away = [track.icon.name for track, one in zip(tracks, corners, strict=True) if len(track.keyframes) > len(one)]
    if away:
        parts.append(f"ending away from baseline, to which one tick leads back: {', '.join(away)}")
    if len(tracks) > 1:
        starts = ", ".join(f"{track.icon.name} at {track.start / timescale:.6g} s" for track in tracks)
        parts.append(f"icons follow one another with {PAUSE_S} s of baseline between: {starts}")
    return "; ".join(parts)


def _rounding_s(corners: list[Corners], timescale: int) -> float:
    times = {time for one in corners for time in one.time_s}
    return max((abs(time - round(time * timescale) / timescale) for time in times), default=0.0)
