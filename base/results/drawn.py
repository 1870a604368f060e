"""Pictures and tables of results with a drawing module that loads only on demand."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..files.atomic import complete_or_absent

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

ROOMS = {"icons": "pictures.draw", "perception": "plots.plot"}
"""Where a package draws what it makes."""


class Drawn:
    """A result that the drawing room of its package can draw."""

    __slots__ = ()

    def _room(self) -> Any:
        package = type(self).__module__.split(".")[1]
        return import_module(f"thermicon.{package}.{ROOMS[package]}")

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw on the axes, or on new ones, and return them; of icons up to 24 over one another, against time."""
        axes: Axes = self._room().plot(self, ax)
        return axes

    def _repr_html_(self) -> str:
        return str(self._room().as_svg(self.plot()))


class Tabled:
    """A result of which `to_frame` gives a table, by default of its `rows`."""

    __slots__ = ()

    def rows(self) -> list[dict[str, Any]]:
        """The rows of the table."""
        raise NotImplementedError

    def to_frame(self) -> pd.DataFrame:
        """The result as a table."""
        import pandas as pd

        return pd.DataFrame(self.rows())

    def to_csv(self, path: str | Path) -> None:
        """Write the table as a CSV file; an existing file is replaced."""
        with complete_or_absent(Path(path)) as draft:
            self.to_frame().to_csv(draft, index=False, float_format="%.9g", lineterminator="\n")
