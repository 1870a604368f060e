"""From cue text to icons: grammar, recovery after a mistake, diagnosis, assembly."""
