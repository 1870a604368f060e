"""Cue text to icons: grammar, recovery after a mistake, diagnosis in words, assembly."""
