"""Icons in files other than a user's cue text."""
