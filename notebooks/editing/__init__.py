"""Cue text in an editor: errors, completion, history, and edits that keep what they do not touch as it is written."""
