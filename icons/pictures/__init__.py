"""Curves as figures and small pictures; what is drawn is known by its type only."""
