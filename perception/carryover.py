"""What an icon leaves behind for the next one: warmth in the skin, and adaptation of the receptors.

The nominal person feels every icon after every other one. Between the display and the receptors the skin is linear, so
that what is left of the icon before adds to what the next one brings; adaptation, which is not, is then run over both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from thermicon.perception.distance import differences, identification_noise
from thermicon.perception.observer import NORMS, Norm, Observer
from thermicon.perception.percept import perceive_many, uniform_clock
from thermicon.perception.receptors import Array

if TYPE_CHECKING:
    from thermicon.circuit import Rig
    from thermicon.icons import Icon

RATE_HZ = 25.0


@dataclass(frozen=True, slots=True)
class CarryOver:
    """How far every icon (column) feels from itself alone after every other (row): `apart` (norms, icons, icons).

    In sensation units, for the nominal person, `gap_s` after the end of the icon before.
    """

    names: tuple[str, ...]
    gap_s: float
    apart: Array
    noise: Array

    def __repr__(self) -> str:
        most = f"up to {self.carried[0].max():.3g} d′ of sensation"
        return f"CarryOver({len(self.names)} icons, {self.gap_s:g} s apart: {most})"

    @property
    def carried(self) -> Array:
        """Root mean square over the icons before, (norms, icons): each of them is as likely as the next."""
        found: Array = np.sqrt((self.apart**2).mean(axis=1))
        return found

    def worst_of(self, place: int, norm: Norm) -> dict[str, Any]:
        """After which icon one feels least like itself, and by how many d′ from memory, for `rank --json`."""
        k = NORMS.index(norm)
        before = int(self.apart[k, :, place].argmax())
        return {"after": self.names[before], "d_prime": float(self.apart[k, before, place] / self.noise[k])}


def carry_over(
    icons: Sequence[Icon], rig: Rig, end_s: float, gap_s: float, observer: Observer | None = None
) -> CarryOver:
    """Let the nominal person feel every icon of a set after every other, each followed for `end_s`.

    Raises `ValueError` for a gap below 0.

    >>> from thermicon.circuit import Rig
    >>> from thermicon.icons import read_cue
    >>> icons, rig = list(read_cue("six-icons")), Rig.load("thenar")
    >>> near, far = (carry_over(icons, rig, 18.0, gap_s).carried[0].max() for gap_s in (1.0, 60.0))
    >>> bool(near > 3 * far)
    True
    """
    from thermicon.circuit import duration_s, simulate_all

    if not gap_s >= 0.0:
        raise ValueError(f"a gap of {gap_s:g} s between icons must be 0 or more")
    person = Observer.load() if observer is None else observer
    waits = [max(1, round((duration_s(icon, rig) + gap_s) * RATE_HZ)) for icon in icons]
    rows = round(end_s * RATE_HZ) + 1
    traces = simulate_all(list(icons), rig, end_s=(max(waits) + rows) / RATE_HZ, rate_Hz=RATE_HZ)
    dt, _ = uniform_clock(traces[0].time_s)
    cold, warm = (
        np.array([getattr(trace, name) for trace in traces]) for name in ("cold_receptor_C", "warm_receptor_C")
    )

    def felt(at_cold: Array, at_warm: Array) -> Array:
        return np.stack(perceive_many(at_cold, at_warm, dt, person, area_m2=rig.contact.area_m2, site=rig.site))

    alone = felt(cold[:, :rows], warm[:, :rows])
    apart = np.empty((len(NORMS), len(icons), len(icons)))
    for before, wait in enumerate(waits):
        after = felt(*(_after(received, before, wait, rows) for received in (cold, warm)))[..., wait:]
        pairs = np.stack([alone, after], axis=2)
        found = differences(pairs[0], pairs[1], dt, person)
        apart[:, before] = [found[norm][:, 0, 1] for norm in NORMS]
    noise = np.array([float(identification_noise(person, norm, dt * (rows - 1))) for norm in NORMS])
    return CarryOver(tuple(icon.name for icon in icons), gap_s, apart, noise)


def _after(received: Array, before: int, wait: int, rows: int) -> Array:
    """Every icon begun `wait` rows into one of them, (icons, wait + rows)."""
    whole = np.repeat(received[before : before + 1, : wait + rows], len(received), axis=0)
    whole[:, wait:] += received[:, :rows] - received[:, :1]
    return whole
