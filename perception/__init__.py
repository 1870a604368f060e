"""thermicon.perception: receptor temperature → percept → distance → confusion matrix → ranking.

The front door holds what a script or a notebook needs; everything else is in the rooms, such as
`thermicon.perception.sensation.detection`. Compiled kernels and matplotlib load when they are first used.
"""

from lazy_loader import attach_stub

from thermicon.base.checks.arguments import register

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)

register(
    "thermicon.icons",
    "thermicon.circuit",
    "thermicon.perception",
    Ranking="rank(icons)",
    Selection="Selection(3)",
    Trials="read_trials(path)",
    Crowd="Crowd(people=50)",
)
