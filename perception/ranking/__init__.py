"""The ranking of a set."""
