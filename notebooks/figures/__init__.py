"""Figures that several commands and views share."""
