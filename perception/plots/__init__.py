"""Figures of percepts, confusion, distance and sensitivity; what is drawn is known by its type only."""
