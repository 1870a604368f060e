"""Cue text in an editor: errors, completion, history, minimal edits."""
