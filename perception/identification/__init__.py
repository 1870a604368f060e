"""Distance between percepts, confusion, information, and the task in which icons are identified."""
