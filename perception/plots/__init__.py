"""Figures of percepts, confusion, distance, sensitivity."""
