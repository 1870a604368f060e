"""thermicon.icons: cue text or recording → icon → corner points.

The names stand in the order of the flow in `__init__.pyi`; nothing heavier than the standard library is imported before
it is used.
"""

from lazy_loader import attach_stub

from thermicon.base.checks.arguments import register

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)

register(
    "thermicon.icons",
    Icon='load_library("six-icons")["cooling-step"]',
    IconSet='load_library("six-icons")',
    Ramp="cool(by=4, at=2)",
)
