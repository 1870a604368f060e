"""A network without power: a heat sink with a controller of its own loses it, and keeps the heat that it has."""

from __future__ import annotations

from dataclasses import replace

from .network import Network

SINK_C, SINK_LIMIT_W = 5, 14
"""Places among `Network.plates`."""


def unpowered(network: Network, sink_C: float) -> Network:
    """Return a network whose controlled heat sink stands at a temperature in °C and has no more power."""
    plates = network.plates.copy()
    plates[SINK_C], plates[SINK_LIMIT_W] = sink_C, 0.0
    return replace(network, plates=plates)
