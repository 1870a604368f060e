"""References and the methods paragraph of a paper."""
