"""Compiled loops of the perception and the number of threads they run on."""
