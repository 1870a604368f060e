"""Identification of icons from their percepts."""
