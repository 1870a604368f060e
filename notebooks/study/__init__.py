"""A whole experiment from one file: orders, pauses, judged drives, a script, tables."""
