"""Mechanisms of the observer: a module each, with its constants, its equation and its source."""
