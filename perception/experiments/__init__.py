"""Psychophysical procedures, simulated: an observer asked in the ways that laboratories ask."""
