"""Many cues on the skins of many people under one thermode: the display is the same for all, their skins are not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from thermicon.icons import Icon

from ..arrays import Array
from ..rig.rig import Rig
from ..rig.rigfile import RigError
from .displayed import design_display
from .prescribed import FELT, modes_of


def displays_on(
    icons: Sequence[Icon], rigs: Sequence[Rig], nominal: Rig, rows: Array, tracking: str | None, probes: Sequence[str]
) -> Array:
    """Return probes (probes, rigs, icons, rows) of cues on thermode rigs.

    The display is the one designed on the nominal rig, since a thermode shows the same to everybody; under `ideal`
    tracking a skin-controlled cue gets one for each rig. What a thermode does not have (`hot_plate_C`) is NaN.
    """
    if nominal.thermode is None or any(rig.thermode != nominal.thermode for rig in rigs):
        raise RigError("rigs of one batch must have the same thermode, or none")
    felt = [place for place, probe in enumerate(probes) if probe in FELT]
    chosen = [FELT.index(probes[place]) for place in felt]
    values = np.full((len(probes), len(rigs), len(icons), len(rows)), np.nan)
    finest = float(np.diff(rows).min(initial=0.01))
    shared = [design_display(icon, nominal, float(rows[-1]), min(finest, 0.01)) for icon in icons]
    step, displays = shared[0].step_s, np.array([plan.display_C for plan in shared])
    times: Array = np.arange(displays.shape[1], dtype=np.float64) * step
    anew = [k for k, icon in enumerate(icons) if tracking == "ideal" and icon.context.control == "skin"]
    aligned = len(rows) <= len(times) and bool(np.abs(times[: len(rows)] - rows).max() < 1e-9)
    for r, rig in enumerate(rigs):
        for k in anew:
            displays[k] = design_display(icons[k], rig, float(rows[-1]), min(finest, 0.01)).display_C
        read = modes_of(rig).run_many(displays, step, chosen)
        if aligned:
            values[felt, r] = read[:, :, : len(rows)]
        else:
            values[felt, r] = [[np.interp(rows, times, row) for row in lane] for lane in read]
    return values
