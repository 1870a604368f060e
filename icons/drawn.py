"""Pictures of icons, as notebooks expect them; the room of pictures loads when one is first made."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Drawn:
    """An icon, a family or a set, which the room of pictures can draw."""

    __slots__ = ()

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw against time, on the axes or on new ones, and return them; up to 24 icons over one another."""
        from .pictures.draw import plot

        return plot(self, ax)

    def _repr_html_(self) -> str:
        from .pictures.draw import as_svg

        return as_svg(self.plot())
