"""Pictures of results, as notebooks expect them; the room of plots loads when one is first made."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Drawn:
    """A result that the room of plots can draw."""

    __slots__ = ()

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the result on the axes or on new ones, and return them."""
        from .plots.plot import plot

        return plot(self, ax)

    def _repr_html_(self) -> str:
        from .plots.plot import as_svg

        return as_svg(self.plot())
