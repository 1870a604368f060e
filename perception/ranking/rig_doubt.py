"""What receptors go through when contact and outermost layer of the skin are uncertain: from nine simulations.

No posterior knows of the two. Both are simulated at three values each; in between, temperatures are those of the
parabolas through them, so that hundreds of draws cost nine simulations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..identification.population import PROBES, ReceptorTemperatures
from ..observer.people import People, people_records
from ..sensation.parameters import ObserverParameter

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

RATE_HZ = 12.5
"""As draws are judged for the intervals of a new laboratory."""
NODES = (0.0, 0.5, 1.0)
CONTACT, LAYER = "contact resistance", "thickness of the outermost layer"


@dataclass(frozen=True, slots=True)
class UncertainRig:
    """Contact and layer as intervals, and the simulations between which others are interpolated.

    `grid` holds cold and warm temperatures in °C, shape (contact, layer, channel, people, icons, n_time). Shares are
    of each parameter's interval, 0–1; the rig as it is has 0.5 of both.
    """

    contact: ObserverParameter
    layer: ObserverParameter
    grid: Array
    time_s: Array
    site: str
    area_m2: float
    names: tuple[str, ...]

    @classmethod
    def simulate(cls, icons: Sequence[Icon], rig: Rig, people: People, end_s: float) -> UncertainRig:
        """Simulate every icon for each person at the nodes, with the currents that are designed on the rig as it is."""
        from thermicon.circuit import simulate_many

        contact, layer = intervals_of(rig)
        grid, time_s = [], np.empty(0)
        for share in NODES:
            row = []
            for other in NODES:
                moved = rig.with_(
                    **{
                        "contact.resistance_m2K_per_W": contact.at(share),
                        "skin.layer.0.thickness_mm": layer.at(other),
                    }
                )
                batch = simulate_many(
                    icons, people.rigs(moved), nominal=rig, end_s=end_s, rate_Hz=RATE_HZ, probes=PROBES
                )
                row.append(np.stack([batch.cold_C, batch.warm_C]))
                time_s = batch.time_s
            grid.append(np.stack(row))
        return cls(
            contact, layer, np.stack(grid), time_s, rig.site, rig.contact.area_m2, tuple(each.name for each in icons)
        )

    @property
    def parameters(self) -> tuple[ObserverParameter, ObserverParameter]:
        """Contact and layer."""
        return self.contact, self.layer

    def played(self, contact: float, layer: float) -> ReceptorTemperatures:
        """Temperatures of the receptors for a contact and an outermost layer, as shares of their intervals."""
        weights = np.outer(_parabola(contact), _parabola(layer)).reshape(-1)
        cold, warm = (weights @ self.grid.reshape(weights.size, -1)).reshape(self.grid.shape[2:])
        return ReceptorTemperatures(cold, warm, self.time_s, self.site, self.area_m2, self.names)


def intervals_of(rig: Rig) -> tuple[ObserverParameter, ObserverParameter]:
    """Contact resistance within the uncertainty of the rig, outermost layer within one person's spread."""
    resistance, layer = rig.contact.resistance_m2K_per_W, rig.skin.layers[0]
    thickness = people_records()["outer_layer"]
    by, other = 1.0 + rig.uncertainty.contact_resistance_relative, 1.0 + thickness.central
    mm, source = layer.thickness_m * 1e3, "uncertainty of the rig"
    return (
        ObserverParameter(CONTACT, resistance / by, resistance, resistance * by, "m²K/W", source, "assumed"),
        ObserverParameter(LAYER, mm / other, mm, mm * other, "mm", thickness.source, "assumed"),
    )


def _parabola(share: float) -> Array:
    """Weights of the three nodes in the parabola through them.

    >>> _parabola(0.5).tolist()
    [-0.0, 1.0, 0.0]
    """
    a, b, c = NODES
    return np.array(
        [
            (share - b) * (share - c) / ((a - b) * (a - c)),
            (share - a) * (share - c) / ((b - a) * (b - c)),
            (share - a) * (share - b) / ((c - a) * (c - b)),
        ]
    )
