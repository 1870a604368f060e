"""The time line of an icon as data."""
