"""Times that bound the judgement after a play and the demands on hardware."""

ENDING_S = 60.0
"""How long each ending is followed in full: until somebody has noticed."""

LATER_S = 600.0
"""Zero current adds to the dose for 10 min, where the classes of contact of IEC 60601-1 Table 24 end."""

PRACTICAL_S = 0.1
"""A watchdog and a cut-off this quick are demanded rather than a longer pause, quicker ones are not: assumed."""
