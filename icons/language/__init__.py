"""The language of cue texts from its grammar to the errors that it reports."""
