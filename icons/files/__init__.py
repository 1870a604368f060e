"""Files other than cue text: JSON, HJIF, shipped sets, the catalogue of errors."""
