"""The result of a fit: parameters with intervals, correlations, residuals, and the rig they make."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from thermicon.icons.atomic import OutputError, complete_or_absent

from ..arrays import Array
from ..inputs import LONGEST_NAME
from ..rig.rig import Rig
from .identify import Parameter
from .overlay import Beside
from .problem import Problem
from .rig_file import fitted_text

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


@dataclass(frozen=True, slots=True, eq=False)
class ChannelFit(Beside):
    """A measured column beside the fitted rig, on the clock of its run's drive.

    `run` and `file` are the log with the drive and that of the column, `unit` that of a difference: K or V. `offset_K`
    of the sensor was fitted along, and is contained in `fitted`.
    """

    run: str
    file: str
    unit: str
    offset_K: float

    @property
    def fitted(self) -> Array:
        """What the fitted rig gives (rows,)."""
        return self.simulated

    @property
    def residual(self) -> Array:
        """Measured minus fitted (rows,)."""
        return self.difference


@dataclass(frozen=True, slots=True, eq=False)
class RigFit:
    """A rig fitted to logs.

    Attributes
    ----------
    rig
        The fitted rig, with the intervals in its uncertainty, and the layers of the skin that was logged, at the
        thickness that they had. What was not identified stays as it was before.
    parameters
        The free keys in the order in which they were named.
    correlation
        Correlations (keys, keys) of the fitted numbers.
    channels
        Every measured column beside the simulation.
    sources
        Name and SHA-256 of every log.
    notes
        Sentences on columns, clocks, sensors and the fit itself.
    converged
        Whether the fit came to rest.
    misfit
        Whether residuals exceed the noise of the logs, or a sensor is off by more than 3 standard deviations; the
        uncertainty of `rig` is then never narrower than before.
    fitted_layers
        Names of the layers of the skin that were fitted along.
    series
        Contact and outermost layer in series, which a log of the display knows about; None where either is not fitted.

    Examples
    --------
    >>> from thermicon.circuit import Rig, fit
    >>> from thermicon.circuit.fitting.laboratory import synthetic_log
    >>> log = synthetic_log(Rig.load("thenar").with_(**{"contact.resistance_m2K_per_W": 7e-4}), seed=1)
    >>> fit(log, Rig.load("thenar"), free=["contact.resistance_m2K_per_W"])
    RigFit(thenar: contact.resistance_m2K_per_W = 0.000... m²·K/W ±... %)
    """

    rig: Rig
    parameters: tuple[Parameter, ...]
    correlation: Array
    channels: tuple[ChannelFit, ...]
    sources: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]
    converged: bool
    misfit: bool = False
    fitted_layers: tuple[str, ...] = ()
    series: Parameter | None = None

    def __repr__(self) -> str:
        parts = [f"{item.key} = {item.value:.4g} {item.unit} {item.interval}" for item in self.parameters]
        return f"RigFit({self.rig.name}: {', '.join(parts)})"

    def __getitem__(self, key: str) -> Parameter:
        """The parameter of a key; raises KeyError with the keys there are."""
        for item in self.parameters:
            if item.key == key:
                return item
        raise KeyError(f"{key} was not fitted; fitted were {', '.join(item.key for item in self.parameters)}")

    @property
    def values(self) -> Mapping[str, float]:
        """Fitted values by key, in the units of the rig file; those that were not identified are not in `rig`."""
        return {item.key: item.value for item in self.parameters}

    @property
    def unidentified(self) -> tuple[Parameter, ...]:
        """Parameters that the logs do not identify, each with the measurement that would."""
        return tuple(item for item in self.parameters if not item.identified)

    def to_frame(self) -> pd.DataFrame:
        """Return one row per parameter: key, unit, start, value, low, high, identified, cure."""
        import pandas as pd

        names = ("key", "unit", "start", "value", "low", "high", "identified", "cure")
        return pd.DataFrame([{name: getattr(item, name) for name in names} for item in self.parameters])

    def correlations(self) -> pd.DataFrame:
        """Return the correlations of the parameters, by key."""
        import pandas as pd

        keys = [item.key for item in self.parameters]
        return pd.DataFrame(self.correlation, index=keys, columns=keys)

    def plot(self, ax: Axes | None = None, column: str | None = None) -> Axes:
        """Draw the residuals of every column, or of one, in K (voltages in V) against time; returns the Axes."""
        from .fit_figure import plot_residuals

        return plot_residuals(self, ax, column)

    def rig_text(self, name: str | None = None) -> str:
        """Return the rig file of the fitted rig, with where its numbers come from; None keeps the name of the rig."""
        return fitted_text(self.rig, self.parameters, self.sources, name, layers=self.fitted_layers, misfit=self.misfit)

    def save(self, path: str | Path, name: str | None = None) -> None:
        """Write the fitted rig as a rig file with its provenance.

        Parameters
        ----------
        path
            A file whose name ends in `.toml`; an existing file is replaced.
        name
            Name of the fitted rig; None: that of the file.

        Raises
        ------
        FitError
            For another ending, and a path that cannot be written.
        """
        from .keys import FitError

        where = Path(path)
        if where.suffix != ".toml":
            raise FitError(f"{where}: the name of a rig file ends in .toml; call it {where.name}.toml")
        try:
            with complete_or_absent(where) as draft:
                draft.write_text(self.rig_text(name or where.stem[:LONGEST_NAME]), encoding="utf-8")
        except OutputError as problem:
            raise FitError(str(problem)) from None


def channel_fits(problem: Problem, theta: Array) -> tuple[ChannelFit, ...]:
    """Return every channel beside the simulation at a point, on the clock of its run's drive."""
    found = problem.simulated(theta)
    fits = []
    for r, c, channel in problem.channels():
        inside = problem.inside(theta, r, channel)
        measured = channel.values[inside]
        fitted = problem.modelled(theta, r, c, found[r])[inside]
        time, offset = problem.run_time_s(theta, r, channel)[inside], problem.nuisance(theta, "offset", r, c)
        unit, run = "K" if channel.temperature else "V", problem.runs[r].name
        fits.append(ChannelFit(channel.column, time, measured, fitted, run, channel.file, unit, offset))
    return tuple(fits)
