"""Words: numbers, names and texts as people read them."""
