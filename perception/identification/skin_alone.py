"""The baseline: an observer who uses skin temperature only.

A change is noticed at one size; icons differ by the root mean square of the difference of their skin temperatures
over one noise in K, which the rate task sets, exactly as that of memory (`identification.task`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations
from statistics import NormalDist

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.circuit import Rig
from thermicon.icons import Icon

from ..observer.channels import Channel
from ..observer.observer import load_thresholds
from ..observer.people import People, draw_people
from .confusion import confuse, normalised
from .population import RATE_HZ, run_end_s

SAMPLES, PEOPLE = 1024, 50
"""Presentations of an icon to a person: with 200 people a pooled share is known to 0.001; and people, if not said."""


def noticed_K(channel: Channel) -> float:
    """The change of skin temperature that is noticed: the published threshold by forced choice on the thenar, K."""
    return load_thresholds().one("detection threshold", channel=channel, site="thenar").central


def noise_K() -> float:
    """Noise at which the rate task comes out as published, mean square over its spans and both usual criteria, K.

    Of a ramp at a rate and one at k times the rate, both over a span s, the courses differ by (k − 1)·s/(k·√3), root
    mean square until the slower has ended: until 1/k of that time by (k − 1) times the slower, then by what it lacks.

    >>> round(noise_K(), 3)
    0.492
    """
    known = load_thresholds()
    faster = 1.0 + known.one("rate Weber fraction").central
    spans, criteria = (known.one(f"{what} of the rate task").interval for what in ("span", "criterion"))
    apart = [span * (faster - 1.0) / (faster * math.sqrt(3.0)) for span in spans]
    wanted = [math.sqrt(2.0) * NormalDist().inv_cdf(proportion) for proportion in criteria]
    return math.sqrt(sum((rms / d) ** 2 for rms in apart for d in wanted) / (len(apart) * len(wanted)))


def named_by_skin(skin_C: Array, rows: Sequence[int], crowd: People, seed: int) -> Array:
    """Confusions (people, icons, icons) by skin temperatures (people, icons, n_time), the icons so many rows long."""
    people, icons = skin_C.shape[:2]
    apart = np.zeros((people, icons, icons))
    for first, second in combinations(range(icons), 2):
        end = max(rows[first], rows[second])
        rms = np.sqrt(np.square(skin_C[:, first, :end] - skin_C[:, second, :end]).mean(axis=1))
        apart[:, first, second] = apart[:, second, first] = rms
    return confuse(apart / noise_K(), lapse=crowd.lapse, seed=seed, samples=SAMPLES).probability


def confused_by_skin(icons: Sequence[Icon], rig: Rig, crowd: People, seed: int) -> Array:
    """Confusions (people, icons, icons) by skin temperature, each person on their own skin and contact."""
    from thermicon.circuit import simulate_many
    from thermicon.circuit.solver.simulate import duration_s

    lasting = [duration_s(icon, rig) for icon in icons]
    end_s, rigs = run_end_s(lasting), crowd.rigs(rig)
    skin = simulate_many(icons, rigs, nominal=rig, end_s=end_s, rate_Hz=RATE_HZ, probes=("skin_C",))["skin_C"]
    return named_by_skin(skin, [round(each * RATE_HZ) + 1 for each in lasting], crowd, seed)


def skin_alone(icons: Sequence[Icon], rig: Rig) -> Array:
    """Pooled confusions (icons, icons) by skin temperature."""
    return normalised(confused_by_skin(icons, rig, draw_people(PEOPLE), 0).mean(axis=0))
