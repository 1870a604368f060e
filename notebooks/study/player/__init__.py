"""Modules whose source is the player of a study in the folder that `thermicon study` writes.

They import one another and the standard library; what else a module needs is imported where it is used.
"""
