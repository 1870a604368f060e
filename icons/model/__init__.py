"""Statements, icons, families and sets: what a cue means, its limits, its corner points and its text."""
