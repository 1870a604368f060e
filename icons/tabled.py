"""Results with a table, which they write as the command line does."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from .atomic import complete_or_absent

if TYPE_CHECKING:
    import pandas as pd


class Tabled:
    """A result of which `to_frame` gives a table."""

    __slots__ = ()

    def to_frame(self) -> pd.DataFrame:
        """The result as a table."""
        raise NotImplementedError

    def to_csv(self, path: str | Path) -> None:
        """Write the table as a CSV file; an existing file is replaced."""
        with complete_or_absent(Path(path)) as draft:
            self.to_frame().to_csv(draft, index=False, float_format="%.9g", lineterminator="\n")
