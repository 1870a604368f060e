"""Selection: the best few icons, the cheapest edit, the search of a family."""
