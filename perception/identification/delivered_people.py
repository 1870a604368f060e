"""Detection of an icon by virtual people, as designed and as a device delivers it.

Designed, it is played as `rank` plays it. What the device changes at the receptors of the nominal person is added to
the temperatures of every person, as much larger or smaller as the icon itself is for that person. That is exact for
what scales with the icon, and wrong by about a tenth of the change otherwise, since skins differ in lag.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..observer.channels import CHANNELS, Channel
from ..observer.observer import Observer
from ..observer.people import draw_people
from ..sensation.features import receptor_C
from .delivered import DeliveredChange
from .population import ReceptorTemperatures, population_detection
from .run_end import RATE_HZ, run_end_s

if TYPE_CHECKING:
    from thermicon.circuit import Trace
    from thermicon.circuit.delivery.delivered_drive import DeliveredDrive

PEOPLE, SEED = 200, 0
"""The people of `rank` unless it is asked for others, so that both show the same number."""


def detected_as_delivered(
    delivery: DeliveredDrive,
    designed: Trace,
    delivered: Trace,
    *,
    end_s: float | None = None,
    people: int = PEOPLE,
    seed: int = SEED,
    tracking: str | None = None,
) -> DeliveredChange:
    """Probability that a person drawn at random reports an icon, as designed (as in `rank`) and as delivered.

    `designed` and `delivered` are its traces on the nominal rig, on the clock of the file. `end_s` is when the run of
    the set ends (None: 10 s after this icon). Raises `RigError` where the skin of a person cannot be held at the
    icon's baseline.

    >>> from thermicon.circuit import Device, Rig
    >>> from thermicon.circuit.delivery.deliver import deliver
    >>> from thermicon.icons import read_cue
    >>> made = deliver(read_cue("six-icons")["cooling-step"], Rig.load("thenar"), Device.load("dac-12"))
    >>> detected_as_delivered(made, made.designed_trace, made.trace, people=4).delivered > 0.9
    True
    """
    from thermicon.circuit.solver.simulate import duration_s

    icon, rig = delivery.icon, delivery.rig
    crowd, observer = draw_people(people, seed), Observer.load()
    end = run_end_s([duration_s(icon, rig)]) if end_s is None else end_s
    as_designed = ReceptorTemperatures.simulated([icon], crowd.rigs(rig), rig, end, RATE_HZ, tracking)
    cold, warm = (
        met + _change(met - met[..., :1], channel, designed, delivered, as_designed.time_s + delivery.lead_s)
        for channel, met in zip(CHANNELS, (as_designed.cold_C, as_designed.warm_C), strict=True)
    )
    as_delivered = replace(as_designed, cold_C=cold, warm_C=warm)
    before, after = (
        float(population_detection(each, crowd, observer).probability.mean()) for each in (as_designed, as_delivered)
    )
    return DeliveredChange(before, after)


def _change(met_K: Array, channel: Channel, designed: Trace, delivered: Trace, at_s: Array) -> Array:
    """What the device changes at the receptors of people (people, icons, n_time), K, who meet the icon as `met_K`.

    The nominal change is multiplied by the least-squares ratio of a person's icon to the nominal one.
    """
    before, after = (np.interp(at_s, each.time_s, receptor_C(each, channel)) for each in (designed, delivered))
    icon = before - before[0]
    size = float(icon @ icon)
    gain = (met_K @ icon)[..., None] / size if size > 0.0 else 1.0
    change: Array = gain * (after - before)
    return change
