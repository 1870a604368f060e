"""Files other than cue text: JSON, shipped sets, the catalogue of errors."""
