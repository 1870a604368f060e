"""The layers of the skin that was logged, fitted along with the keys: nobody's skin is that of the rig file.

The prior of each factor is the spread between people. What is a times as thick is simulated as equally thick with 1/a
of the conductivity and a times the density and perfusion, which is the same to a log and keeps the mesh of the skin.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..rig.rig import Rig
from ..rig.skin import layer_spreads

THICKNESS, CONDUCTIVITY, CAPACITY = LAYER_KINDS = ("thickness", "conductivity", "heat capacity")
"""What differs of a layer; the last is per volume."""

FINE_ELEMENTS = 40
"""Elements per layer of the skin that the mesh is compared with: within 0.5 mK of more, where the mesh is off by 2."""

Factors = Mapping[tuple[str, int], float]
"""Logarithms of factors by kind and layer."""


def layer_priors(rig: Rig) -> dict[tuple[str, int], float]:
    """Return the standard deviation of the logarithm of every layer's factors; nothing on a rig without skin.

    >>> priors = layer_priors(Rig.load("thenar"))
    >>> len(priors), round(priors[THICKNESS, 0], 3)
    (15, 0.182)
    """
    if rig.bench_load is not None:
        return {}
    known = {record.quantity: math.log1p(record.central) for record in layer_spreads()}
    priors = {(kind, k): known[f"layer {kind} spread"] for k in range(len(rig.skin.layers)) for kind in LAYER_KINDS}
    return {**priors, (THICKNESS, 0): known["outermost layer thickness spread"]}


def changed_layers(rig: Rig, factors: Factors) -> dict[str, float]:
    """Return keys of the rig for its layers times factors, at the thickness that they have; none without factors."""
    changes = {}
    for k, layer in enumerate(rig.skin.layers if factors else ()):
        thicker, better, heavier = (math.exp(factors.get((kind, k), 0.0)) for kind in LAYER_KINDS)
        changes[f"skin.layer.{k}.conductivity_W_per_mK"] = layer.conductivity_W_per_mK * better / thicker
        changes[f"skin.layer.{k}.density_kg_per_m3"] = layer.density_kg_per_m3 * heavier * thicker
        changes[f"skin.layer.{k}.perfusion_per_s"] = layer.perfusion_per_s * thicker
    return changes


def finely_divided(rig: Rig) -> Rig | None:
    """The rig with a fine mesh of its skin; None where it states its elements, or has no skin."""
    if rig.skin.elements is not None or rig.bench_load is not None:
        return None
    return rig.with_(**{"skin.elements": [FINE_ELEMENTS] * len(rig.skin.layers)})
