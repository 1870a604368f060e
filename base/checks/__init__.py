"""Checks of arguments of public functions."""
