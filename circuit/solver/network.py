"""The circuit as arrays for stepping.

State vector: hot plate, cold plate (the display), skin lumps from the surface down, then a passive heat sink of a rig
that has one, deep node (constant), all in °C.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from thermicon.base.numbers.arrays import Array, Index

from ..rig.rig import Rig
from ..rig.skin import SkinColumn

ALPHA, RESISTANCE, CONDUCTANCE, HOT_J_PER_K, COLD_J_PER_K, SINK_C, SINK_W_PER_K, DEEP_C = range(8)
"""Places in `Network.plates` of the module's α V/K, R Ω and 1/Θ W/K, of both heat capacities, of the heat sink's
temperature and 1/R_s, and of the temperature of deep tissue and blood."""

LOWEST_A, HIGHEST_A, COMPLIANCE_V = range(8, 11)
"""Places of the driver's limits."""

SINK_J_PER_K, SINK_AIR_W_PER_K, SINK_START_C = range(11, 14)
"""Places of a passive heat sink's capacity, of its conductance to air (0: it is ideal; else SINK_C is that of the air),
and of its temperature at the start (NaN: where the current and the air leave it)."""

PAST_MOST_COOLING = 14
"""Place of 1 for a loop that does not know at which current its module cools most, and runs to the driver's limit."""

PLATE_NUMBERS = 15


RECORDED = (
    "hot_plate_C",
    "display_C",
    "skin_C",
    "cold_receptor_C",
    "warm_receptor_C",
    "heat_flow_skin_W_per_m2",
    "heat_flow_cold_receptor_W_per_m2",
    "heat_flow_warm_receptor_W_per_m2",
)
"""What every run records, in this order; each is a weighted sum of three neighbouring states."""

Weights = tuple[int, tuple[float, float, float]]
"""A reading: the first of three neighbouring states, and the weight of each."""

HOT, COLD, SKIN = 0, 1, 2
"""Places of hot plate, cold plate and first skin lump in the state vector."""


@dataclass(frozen=True, slots=True, eq=False)
class Network:
    """A rig as lumps; n skin lumps, arrays read-only.

    `capacity_J_per_K` (n,), `conductance_W_per_K` (n + 1,): cold plate to first lump, between lumps, last lump to deep;
    `perfusion_W_per_K` (n,); `probe_start` (8,) and `probe_weight` (8, 3) for RECORDED, as if no heat sink were
    passive; `plates` (18,) for the kernel, in the order of their places above.
    """

    capacity_J_per_K: Array
    conductance_W_per_K: Array
    perfusion_W_per_K: Array
    probe_start: Index
    probe_weight: Array
    plates: Array

    def __post_init__(self) -> None:
        for array in (self.capacity_J_per_K, self.conductance_W_per_K, self.perfusion_W_per_K):
            array.setflags(write=False)
        for other in (self.probe_start, self.probe_weight, self.plates):
            other.setflags(write=False)

    @property
    def deep_C(self) -> float:
        """Temperature of the deep node and of blood in °C."""
        return float(self.plates[DEEP_C])

    @property
    def passive(self) -> bool:
        """Whether the heat sink is passive, so that its temperature is part of the state."""
        return bool(self.plates[SINK_AIR_W_PER_K] > 0)

    @property
    def nodes(self) -> int:
        """Length of the state vector."""
        return len(self.capacity_J_per_K) + self.passive + 3

    @property
    def face_share(self) -> float:
        """Weight of the cold plate in the face temperature; the first lump has the rest."""
        start, weight = int(self.probe_start[2]), self.probe_weight[2]
        return float(weight[COLD - start]) if start <= COLD else 0.0

    def read(self, state_C: Array, probe: str) -> float:
        """Value of one of the RECORDED quantities at a state (nodes,) in °C."""
        row = RECORDED.index(probe)
        start = int(self.probe_start[row])
        if self.passive:
            state_C = np.append(state_C[: SKIN + len(self.capacity_J_per_K)], state_C[-1])
        return float(self.probe_weight[row] @ state_C[start : start + 3])


class ModalRigs(NamedTuple):
    """r rigs for the kernels: how many `lumps` (r,), skins of m modes as in `SkinsOfBank`, and `plates`."""

    lumps: Index
    rate_per_s: Array
    touch: Array
    to_modes: Array
    from_modes: Array
    first_W_per_K: Array
    plates: Array


@lru_cache(maxsize=512)
def network_of(rig: Rig) -> Network:
    """Return the lumps of a rig; raises RigError for a thermode, which has no plates."""
    return network_on(rig, rig.column, rig.deep_C)


def skin_network_of(rig: Rig) -> Network:
    """Return the lumps of a rig's skin under its display; the numbers of its plates are NaN."""
    plates = np.full(PLATE_NUMBERS, np.nan)
    plates[DEEP_C] = rig.deep_C
    return _network(rig, rig.column, plates)


def network_on(rig: Rig, column: SkinColumn, deep_C: float) -> Network:
    """Return the lumps of a rig on another column of its skin, over a deep (and blood) temperature in °C."""
    module, driver = rig.module, rig.driver
    plates = np.zeros(PLATE_NUMBERS)
    plates[[ALPHA, RESISTANCE]] = module.seebeck_V_per_K, module.resistance_ohm
    plates[[CONDUCTANCE, SINK_W_PER_K]] = 1 / module.thermal_resistance_K_per_W, 1 / rig.heat_sink.resistance_K_per_W
    plates[[HOT_J_PER_K, COLD_J_PER_K]] = module.hot_plate_J_per_K, module.cold_plate_J_per_K
    plates[[SINK_C, DEEP_C]] = rig.heat_sink.temperature_C, deep_C
    plates[[LOWEST_A, HIGHEST_A, COMPLIANCE_V]] = driver.current_min_A, driver.current_max_A, driver.voltage_limit_V
    if (passive := rig.heat_sink.passive) is not None:
        plates[[SINK_J_PER_K, SINK_C]] = passive.capacity_J_per_K, passive.air_C
        plates[SINK_AIR_W_PER_K] = 1 / passive.air_resistance_K_per_W
        plates[SINK_START_C] = np.nan if passive.steady else rig.heat_sink.temperature_C
    return _network(rig, column, plates)


def _network(rig: Rig, column: SkinColumn, plates: Array) -> Network:
    area, contact = rig.contact.area_m2, rig.contact.resistance_m2K_per_W
    resistance = column.resistance_m2K_per_W.copy()
    resistance[0] += contact
    place = np.concatenate([[0.0], np.cumsum(resistance)])  # of cold plate, lumps, deep node
    rows = [(HOT, (1.0, 0.0, 0.0)), (COLD, (1.0, 0.0, 0.0)), temperature_weights(contact, place)]
    receptors = (rig.skin.cold_receptor_m, rig.skin.warm_receptor_m)
    depths = [contact + rig.skin.resistance_to_m2K_per_W(depth) for depth in receptors]
    rows += [temperature_weights(depth, place) for depth in depths]
    rows += [flow_weights(depth, place) for depth in (0.5 * place[1], *depths)]
    starts, weights = stacked(rows)
    return Network(
        column.capacity_J_per_m2K * area, area / resistance, column.perfusion_W_per_m2K * area, starts, weights, plates
    )


def places_of(rig: Rig) -> Array:
    """Thermal resistance in m²·K/W from the cold plate down to itself, to every skin lump and to the deep node."""
    resistance = rig.column.resistance_m2K_per_W.copy()
    resistance[0] += rig.contact.resistance_m2K_per_W
    return np.concatenate([[0.0], np.cumsum(resistance)])


def stacked(rows: Sequence[Weights]) -> tuple[Index, Array]:
    """Starts (k,) and weights (k, 3) of several readings, in the form that the kernel expects."""
    return np.array([row[0] for row in rows], dtype=np.int64), np.array([row[1] for row in rows]).reshape(-1, 3)


def _bracket(at: float, place: Array) -> tuple[int, bool]:
    """Index of the state just above a place, and whether the place is that state itself."""
    same = np.flatnonzero(np.abs(place - at) < 1e-9 * place[-1])
    if same.size:
        return int(same[0]), True
    return int(np.searchsorted(place, at)) - 1, False


def temperature_weights(at: float, place: Array) -> Weights:
    """Reading of the temperature at a thermal resistance below the cold plate, linear between states."""
    above, same = _bracket(at, place)
    share = 0.0 if same else float((at - place[above]) / (place[above + 1] - place[above]))
    start = min(above + COLD, len(place) - 2)
    weight = [0.0, 0.0, 0.0]
    weight[above + COLD - start] += 1.0 - share
    if share:
        weight[above + COLD - start + 1] += share
    return start, (weight[0], weight[1], weight[2])


def smooth_flow_weights(at: float, place: Array) -> Weights:
    """Reading of the heat flow in W/m² there, linear between the middles of cells, so that it moves with the place."""
    middles, conductance = 0.5 * (place[:-1] + place[1:]), 1.0 / np.diff(place)
    above = int(np.clip(np.searchsorted(middles, at) - 1, 0, middles.size - 2))
    share = (at - middles[above]) / (middles[above + 1] - middles[above])
    upper, lower = (1.0 - share) * conductance[above], share * conductance[above + 1]
    return above + COLD, (float(upper), float(lower - upper), float(-lower))


def flow_weights(at: float, place: Array) -> Weights:
    """Reading of the heat flow in W/m² there: at a lump the mean of its two faces, between lumps the face's."""
    above, same = _bracket(at, place)
    if same and 0 < above < len(place) - 1:  # at a lump: the mean of the flows through its two faces
        into, out = 0.5 / (place[above] - place[above - 1]), 0.5 / (place[above + 1] - place[above])
        return above - 1 + COLD, (float(into), float(out - into), float(-out))
    above = min(above, len(place) - 2)  # at the deep node, what leaves the last lump
    through = float(1.0 / (place[above + 1] - place[above]))
    if above + COLD + 2 > len(place):
        return above + COLD - 1, (0.0, through, -through)
    return above + COLD, (through, -through, 0.0)
