"""Cue text in an editor."""
