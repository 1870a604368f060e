"""The meaning of a cue: statements, icons, families, sets, corner points."""
