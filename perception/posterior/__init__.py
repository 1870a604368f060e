"""Draws from the posterior of all constants, and experiments predicted without having been seen."""
