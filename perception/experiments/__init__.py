"""Simulated psychophysical procedures."""
