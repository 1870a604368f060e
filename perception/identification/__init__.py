"""Identification of icons: distance between percepts, confusion, information."""
