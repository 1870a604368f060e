"""The best few icons, the cheapest edit, the search of a family, and how robust a choice is."""
