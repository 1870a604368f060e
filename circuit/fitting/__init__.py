"""Rig parameters from measured logs, with intervals."""
