"""The steps of a threshold: changes of one direction, equally spaced in logarithm, as icons of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermicon.icons import parse

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import IconSet

    from .keys import Threshold

FELT, UNFELT = "felt", "not-felt"
"""Answers in a threshold run."""


def levels_K(threshold: Threshold) -> tuple[float, ...]:
    """Changes in K, from the smallest to the greatest, rounded to 1 mK.

    >>> from .keys import Threshold
    >>> levels_K(Threshold(direction="cool", least_K=0.1, most_K=1.0, levels=3))
    (0.1, 0.316, 1.0)
    """
    spaced = np.geomspace(threshold.least_K, threshold.most_K, threshold.levels)
    return tuple(round(float(change), 3) for change in spaced)


def level_icons(threshold: Threshold, rig: Rig) -> IconSet:
    """Return the steps as a set of icons for the display, from the skin's rest, named after their place.

    >>> from thermicon.circuit import Rig
    >>> from .keys import Threshold
    >>> [icon.name for icon in level_icons(Threshold(direction="cool", levels=3), Rig.load("thenar"))]
    ['cool-01', 'cool-02', 'cool-03']
    """
    verb, rate, hold = threshold.direction, threshold.rate_K_per_s, threshold.hold_s
    lines = [
        "cue 1",
        f'set steps-{verb} "Steps for a threshold" {{',
        f"  site {rig.site}",
        "  control display",
        f"  baseline {rig.skin.rest_C:g} °C",
        "}",
    ]
    for place, change_K in enumerate(levels_K(threshold), 1):
        middle = [f"  hold for {hold:g} s"] if hold else []
        lines += [
            "",
            f'icon {verb}-{place:02d} means "a change of {change_K:g} K" by "thermicon" {{',
            f"  {verb} by {change_K:g} °C at {rate:g} °C/s",
            *middle,
            f"  return at {rate:g} °C/s",
            "}",
        ]
    return parse("\n".join(lines) + "\n", "steps of the threshold")
