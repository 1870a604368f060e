"""A drive as the corners of a piecewise linear source, for netlists."""

from __future__ import annotations

from ..solver.drive import Drive

EDGE_S = 1e-6
"""Width of the flank that replaces a jump of a held current; less where rows are closer than four of these."""


def points(drive: Drive, rest_A: float | None) -> list[tuple[float, float]]:
    """Corners of a drive's current: (time s, A), a flank of 1 µs for each jump."""
    times, currents = drive.time_s.tolist(), drive.current_A.tolist()
    start: list[tuple[float, float]] = [(0.0, currents[0])]
    if rest_A is not None and rest_A != currents[0]:
        edge = min(EDGE_S, times[1] / 4)
        slope = 0.0 if drive.held else (currents[1] - currents[0]) / times[1]
        start = [(0.0, float(rest_A)), (edge, currents[0] + slope * edge)]
    if not drive.held:
        return [*start, *zip(times[1:], currents[1:], strict=True)]
    points, before = start, currents[0]
    for k in range(1, len(times) - 1):
        if currents[k] != before:
            half = min(EDGE_S / 2, (times[k] - times[k - 1]) / 4, (times[k + 1] - times[k]) / 4)
            points += [(times[k] - half, before), (times[k] + half, currents[k])]
            before = currents[k]
    return [*points, (times[-1], before)]
