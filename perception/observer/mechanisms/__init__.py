"""Mechanisms of the observer."""
