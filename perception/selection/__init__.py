"""Selection of better icons."""
