"""Rig parameters from measured logs: values with intervals, what a log cannot identify, and what to measure instead."""
