"""The observer file of a laboratory, as ``pilot --keep`` writes one, from draws of the shipped posterior."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from thermicon.perception.observer.draws import BETWEEN_LABORATORIES, PosteriorDraws
from thermicon.perception.observer.draws_file import to_text


def few_draws(path: Path, count: int, resampled: str = "", rig: str = "") -> Path:
    """Write the first draws to a file: those of one laboratory where ``resampled`` says how they were obtained."""
    shipped = PosteriorDraws.load()
    values = shipped.draws[:count].copy()
    if resampled:
        values[:, shipped.names.index(BETWEEN_LABORATORIES)] = 1e-6
    header = replace(shipped.header, resampled=resampled, rig=rig)
    path.write_text(to_text(header, shipped.names, values), encoding="utf-8")
    return path
