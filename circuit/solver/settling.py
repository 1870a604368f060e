"""How skin and receptors settle after a hand has landed on a display."""

import numpy as np

from thermicon.base.numbers.arrays import Array
from thermicon.icons import Icon

from ..rig.rig import Rig
from .drive import Drive
from .inverse import baseline_C, design
from .modes import FELT, modes_of
from .network import SKIN
from .simulate import duration_s, simulate_current

LONGEST_S = 1800.0
"""A hand that has not settled by then has no landing."""


def settling(icon: Icon, rig: Rig, from_K: float, held: bool) -> tuple[Array, Array]:
    """Seconds after contact, and the largest deviation of skin and receptors in K from where they settle.

    Skin arrives `from_K` warmer or colder than it rests; the display stays at baseline (`held`), or the current does.
    """
    modes = modes_of(rig)
    columns = ("skin_C", "cold_receptor_C", "warm_receptor_C")
    times = np.arange(LONGEST_S + 1.0)
    base = baseline_C(icon, rig)
    deviations = []
    for arrived_C in (rig.skin.rest_C - from_K, rig.skin.rest_C + from_K):
        begun = modes.steady(modes.display_holding_skin_C(arrived_C))
        if held:
            display = modes.display_holding_skin_C(base) if icon.context.control == "skin" else base
            run = modes.relax(times, display, begun)
            steady = modes.relax(times[:1], display, modes.steady(display))
            places = [FELT.index(name) for name in columns]
            deviations.append(np.abs(run[places] - steady[places]).max(axis=0))
            continue
        plan = design(icon, rig, duration_s(icon, rig))
        start = plan.start_C.copy()
        start[SKIN:-1] = modes.lumps @ begun + modes.deep_C
        drive = Drive([0.0, LONGEST_S], [plan.rest_A, plan.rest_A], held=True)
        trace = simulate_current(drive, rig, rate_Hz=1.0, start_C=start)
        still = simulate_current(
            Drive([0.0, 1.0], [plan.rest_A] * 2, held=True), rig, rate_Hz=1.0, start_C=plan.start_C
        )
        deviations.append(np.max([np.abs(getattr(trace, name) - getattr(still, name)[0]) for name in columns], axis=0))
    return times, np.asarray(np.max(deviations, axis=0))
