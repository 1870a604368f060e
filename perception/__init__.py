"""thermicon.perception: receptor temperature → percept → distance → confusion matrix → ranking.

The front door holds what a script or a notebook needs; everything else is in the rooms, such as
`thermicon.perception.sensation.detection`. Compiled kernels and matplotlib load when they are first used.
"""

from lazy_loader import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
