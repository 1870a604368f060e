"""What a study of sensitivity plays on: uncertain parameters, and what the receptors go through for any of them.

Contact and skin are simulated at three values each; in between, temperatures are those of the parabolas
through them, so that thousands of runs cost nine simulations.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..identification.population import ReceptorTemperatures
from ..observer.observer import Norm, load_thresholds
from ..observer.people import People, draw_people, people_records
from ..sensation.parameters import ObserverParameter, observer_parameters

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

RATE_HZ = 25.0
TAIL_S = 10.0
NODES = (0.0, 0.5, 1.0)
CONTACT, LAYER = "contact resistance", "thickness of the outermost layer"
SPREAD, LAPSE = "spread of thresholds between people", "lapse rate"


@dataclass(frozen=True, slots=True)
class SimulationGrid:
    """Parameters in their order (the observer's, then contact, layer, spread, lapse), people, and nine simulations.

    `grid` holds cold and warm temperatures in °C, shape (contact, layer, channel, people, icons, n_time). Shares are
    of every parameter's interval, 0–1; `centre` has every parameter at its value.
    """

    parameters: tuple[ObserverParameter, ...]
    centre: Array
    crowd: People
    grid: Array
    time_s: Array
    site: str
    area_m2: float

    def observer_values(self, shares: Array) -> dict[str, float]:
        """Values of the observer's own parameters by name."""
        own = self.parameters[: -len(OTHERS)]
        return {p.name: p.at(float(share)) for p, share in zip(own, shares[: len(own)], strict=True)}

    def played(self, shares: Array) -> ReceptorTemperatures:
        """Temperatures of the receptors for a contact and an outermost layer."""
        contact, layer = (_parabola(share) for share in self.played_key(shares))
        weights = np.outer(contact, layer).reshape(-1)
        cold, warm = (weights @ self.grid.reshape(weights.size, -1)).reshape(self.grid.shape[2:])
        return ReceptorTemperatures(cold, warm, self.time_s, self.site, self.area_m2)

    def played_key(self, shares: Array) -> tuple[float, float]:
        """All that `played` hangs on: the shares of contact and layer."""
        return self._share(shares, CONTACT), self._share(shares, LAYER)

    def crowd_at(self, shares: Array) -> People:
        """The people with another spread of thresholds and another mean lapse."""
        spread = self._ratio(shares, SPREAD)
        return replace(
            self.crowd,
            threshold_cold=self.crowd.threshold_cold**spread,
            threshold_warm=self.crowd.threshold_warm**spread,
            lapse=self.crowd.lapse * self._ratio(shares, LAPSE),
        )

    def _share(self, shares: Array, name: str) -> float:
        return float(shares[len(self.parameters) - len(OTHERS) + OTHERS.index(name)])

    def _ratio(self, shares: Array, name: str) -> float:
        parameter = self.parameters[len(self.parameters) - len(OTHERS) + OTHERS.index(name)]
        return parameter.at(self._share(shares, name)) / parameter.value


OTHERS = (CONTACT, LAYER, SPREAD, LAPSE)


def simulate_grid(icons: Sequence[Icon], rig: Rig, people: int, seed: int, norm: Norm) -> SimulationGrid:
    """Draw the people and simulate every icon for each of them at the nodes of contact and skin.

    Currents are designed on the rig as it is: what differs is what the people turn out to have.
    """
    from thermicon.circuit import duration_s, simulate_many

    crowd = draw_people(people, seed)
    end = math.ceil((max(duration_s(icon, rig) for icon in icons) + TAIL_S) * RATE_HZ - 1e-6) / RATE_HZ
    contact, layer = _about_rig(rig)
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
            batch = simulate_many(icons, crowd.rigs(moved), nominal=rig, end_s=end, rate_Hz=RATE_HZ)
            row.append(np.stack([batch.cold_C, batch.warm_C]))
            time_s = batch.time_s
        grid.append(np.stack(row))
    parameters = (*observer_parameters(norm, rig.site), contact, layer, *_about_people())
    centre = np.array([_share_of(parameter) for parameter in parameters])
    return SimulationGrid(parameters, centre, crowd, np.stack(grid), time_s, rig.site, rig.contact.area_m2)


def _about_rig(rig: Rig) -> tuple[ObserverParameter, ObserverParameter]:
    """Contact resistance and outermost layer of the rig; their intervals are one person's spread to either side."""
    records = people_records()
    resistance, layer = rig.contact.resistance_m2K_per_W, rig.skin.layers[0]
    spread, thickness = records["contact_resistance"], records["outer_layer"]
    by, other = 1.0 + spread.central, 1.0 + thickness.central
    mm = layer.thickness_m * 1e3
    return (
        ObserverParameter(CONTACT, resistance / by, resistance, resistance * by, "m²K/W", spread.source, "assumed"),
        ObserverParameter(LAYER, mm / other, mm, mm * other, "mm", thickness.source, "assumed"),
    )


def _about_people() -> tuple[ObserverParameter, ObserverParameter]:
    spread, lapse = load_thresholds().one("between-person spread"), people_records()["lapse"]
    return (
        ObserverParameter(SPREAD, *_three(spread.interval, spread.central), "log10 units", spread.source, spread.use),
        ObserverParameter(LAPSE, *_three(lapse.interval, lapse.central), lapse.unit, lapse.source, lapse.use),
    )


def _three(interval: tuple[float, float], value: float) -> tuple[float, float, float]:
    return interval[0], value, interval[1]


def _share_of(parameter: ObserverParameter) -> float:
    """The share at which a parameter has its value, by bisection: `at` rises from low to high."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if parameter.at(middle) < parameter.value else (low, middle)
    return 0.5 * (low + high)


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
