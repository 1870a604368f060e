"""Figures of perception."""
