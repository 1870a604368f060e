"""Numerical work: arrays and the compiled functions that take them."""
