"""Mechanisms of the observer: one module each, with constants, equation, source."""
