"""Criteria that several stages share."""

DISTINGUISHABLE_DPRIME = 2.563
"""A pair is distinguishable from this d′ on: two icons would be identified 90 % correctly, Φ(d′/2) = 0.9."""
