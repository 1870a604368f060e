"""The corners of a rig's uncertainty in which a drive must be safe.

Contact, gain, Seebeck coefficient, thermal conductance and plates are at either end of their uncertainty, in all
combinations. Heat sink and ambient move together: every temperature rises with those of the heat sink and of deep
tissue, so the extremes are where both are warm or both are cold. Where deep tissue is from the heat balance at resting
temperature of bare skin, a warmer room means cooler blood. A Peltier module cools most at one current, since its Joule
heat grows with the square: where the driver can pass that current, gains in between are corners too.
"""

import itertools
from collections.abc import Iterable
from dataclasses import dataclass

from ..rig.corner import perturbed
from ..rig.rig import Rig
from ..rig.uncertainty import WORDS
from ..solver.network import COLD, network_of
from ..solver.steady import state_under_current

GAINS_BETWEEN = (-1.0, -0.5, 0.0, 0.5, 1.0)
"""Shares of the gain's uncertainty where the coldest gain may lie between the ends: within 0.02 K of it."""
MOVED = tuple(key for key in WORDS if key != "gain_relative")
NEARLY = 0.97
"""Share of the greatest current at which the display is compared with that at the greatest: a step towards less."""


@dataclass(frozen=True, slots=True)
class Corner:
    """One possible state of a rig: shares and K of deviation; the gain, which scales currents, is not part of `rig`."""

    rig: Rig
    contact_resistance_relative: float = 0.0
    ambient_K: float = 0.0
    gain_relative: float = 0.0
    heat_sink_K: float = 0.0
    seebeck_relative: float = 0.0
    conductance_relative: float = 0.0
    plates_relative: float = 0.0

    def __str__(self) -> str:
        from .words import corner_text

        return corner_text(self.deviations)

    @property
    def deviations(self) -> tuple[float, ...]:
        """Shares and K of deviation, in the order of `WORDS`."""
        return tuple(getattr(self, key) for key in WORDS)

    @property
    def nominal(self) -> bool:
        """Whether this is the rig as given."""
        return not any(self.deviations)


def corners_of(rig: Rig) -> tuple[Corner, ...]:
    """The rig as given and then the corners of its uncertainty, fewer than 64 where one is 0."""
    unsure = rig.uncertainty
    gains = _ends(unsure.gain_relative)
    if unsure.gain_relative and passes_most_cooling(rig):
        gains = tuple(share * unsure.gain_relative for share in GAINS_BETWEEN)
    module = map(_ends, (unsure.seebeck_relative, unsure.conductance_relative, unsure.plates_relative))
    others = itertools.product(_ends(unsure.contact_resistance_relative), gains, *module)
    every = itertools.product(surroundings(rig), others)
    return _cornered(rig, ((contact, air, gain, sink, *rest) for (air, sink), (contact, gain, *rest) in every))


def contact_corners(rig: Rig) -> tuple[Corner, ...]:
    """The rig as given, then all combinations of contact and ambient at either end of their uncertainty."""
    every = itertools.product(_ends(rig.uncertainty.contact_resistance_relative), _ends(rig.uncertainty.ambient_K))
    return _cornered(rig, ((contact, ambient, 0.0, 0.0, 0.0, 0.0, 0.0) for contact, ambient in every))


def _ends(most: float) -> tuple[float, ...]:
    return (-most, most) if most else (0.0,)


def _cornered(rig: Rig, every: Iterable[tuple[float, ...]]) -> tuple[Corner, ...]:
    """The rig as given, then a corner for each of the deviations that is one."""
    known = (each for each in every if any(each))
    moved = ((dict(zip(MOVED, (*each[:2], *each[3:]), strict=True)), each) for each in known)
    return (Corner(rig), *(Corner(perturbed(rig, **by), *each) for by, each in moved))


def passes_most_cooling(rig: Rig) -> bool:
    """Whether more current cools less at the driver's limit at rest: then neither end of the gain is the coldest."""
    network, most = network_of(rig), rig.driver.current_max_A * (1.0 + rig.uncertainty.gain_relative)
    try:
        less, more = (float(state_under_current(network, share * most)[COLD]) for share in (NEARLY, 1.0))
    except ArithmeticError:  # no steady state: the module runs hot
        return True
    return more >= less


def surroundings(rig: Rig) -> tuple[tuple[float, float], ...]:
    """Deviations of ambient and heat sink in K, at their coldest and their warmest for the skin."""
    ambient, sink = rig.uncertainty.ambient_K, rig.uncertainty.heat_sink_K
    if not ambient and not sink:
        return ((0.0, 0.0),)
    warmer = perturbed(rig, ambient_K=ambient).deep_C >= perturbed(rig, ambient_K=-ambient).deep_C
    hot = ambient if warmer else -ambient
    return (-hot, -sink), (hot, sink)
