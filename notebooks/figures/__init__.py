"""Figures that several commands or views share."""
