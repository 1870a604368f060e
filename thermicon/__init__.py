"""thermicon: write thermal icons, see what display, skin and receptors do, and predict which of them people confuse.

These are the names that a notebook needs first; `thermicon.icons`, `thermicon.circuit`, `thermicon.perception` and
`thermicon.notebooks` have the others. Each is imported when it is first asked for.
"""

from contextlib import suppress

with suppress(ImportError):  # where it is missing, ``thermicon doctor`` has to say so
    from lazy_loader import attach_stub

    __getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
