"""Arrays, compiled functions, processor cores, and the program that computed a result."""
