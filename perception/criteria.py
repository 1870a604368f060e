"""Criteria that several stages share."""

DISTINGUISHABLE_DPRIME = 2.563
"""A pair is distinguishable from this d′ on: two icons would be identified 90 % correctly, Φ(d′/2) = 0.9."""

FELT_FROM = 0.5
"""An icon is felt from this probability of a report on: then its onset is the median over trials that mostly report.

An icon that fewer trials report is not an alert, and is chosen only if it is asked for.
"""

MOST_ICONS = 2000
"""More icons at once than anyone reads about; families may have 100,000."""
