"""The meaning of a cue text as objects from statements to corner points."""
