"""Figures and small pictures of icons."""
