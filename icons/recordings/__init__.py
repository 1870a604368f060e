"""Recorded courses of temperature as icons with few corner points."""
