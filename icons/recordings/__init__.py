"""A recorded course of temperature to the few corner points of an icon."""
