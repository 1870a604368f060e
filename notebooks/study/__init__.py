"""A whole experiment from one file: orders, pauses, judged drives, a script that runs it, and its tables."""
