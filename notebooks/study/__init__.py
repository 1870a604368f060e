"""A whole experiment from one file."""
