"""Rig parameters from measured logs."""
