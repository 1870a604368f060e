"""A load in place of skin: a block of metal, or air. For logs of a bench without a person.

Under the display lies one lump: the block, which is isothermal, or a layer of air. What lies behind it rests at the
temperature of the room. Nothing on such a rig says what a person would feel, or whether a drive is safe for one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from .skin import Column

if TYPE_CHECKING:
    from .rig import Rig

METAL, AIR = "metal block", "air"
LOAD_SITES = (METAL, AIR)
"""What stands for the site of the skin on rigs with a load."""

AIR_J_PER_M2K = 12.0
"""Heat capacity of the air that is carried along: a boundary layer of 1 cm, 1.2 kg/m³ · 1005 J/(kg·K) · 0.01 m."""
NO_CONTACT_M2K_PER_W = 1e-7
"""Air touches the display without a resistance of contact: the film is all there is."""

Capacity = Annotated[float, Field(ge=1e-3, le=1e6)]
Conductance = Annotated[float, Field(ge=1e-6, le=1e4)]
Film = Annotated[float, Field(ge=0.1, le=1e5)]


class LoadTable(BaseModel):
    """Keys of [load]: a block of metal has a heat capacity and a conductance to the room, air a film."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    capacity_J_per_K: Capacity | None = None
    conductance_W_per_K: Conductance | None = None
    film_W_per_m2K: Film | None = None


@dataclass(frozen=True, slots=True)
class Load:
    """What the display touches: `site` is `metal block` or `air`; capacity J/K, conductance to the room W/K."""

    site: str
    capacity_J_per_K: float
    conductance_W_per_K: float

    def column(self, area_m2: float) -> Column:
        """The load as a column of one lump: a block behind its contact, air half way through its film."""
        whole = area_m2 / self.conductance_W_per_K
        before = 0.0 if self.site == METAL else 0.5 * whole
        return Column(
            np.zeros(1), np.array([self.capacity_J_per_K / area_m2]), np.zeros(1), np.array([before, whole - before])
        )


def load_of(table: LoadTable | None, area_m2: float) -> Load | None:
    """The load of a rig file on a display of an area; None where there is skin."""
    if table is None:
        return None
    if table.film_W_per_m2K is not None:
        return Load(AIR, AIR_J_PER_M2K * area_m2, table.film_W_per_m2K * area_m2)
    assert table.capacity_J_per_K is not None and table.conductance_W_per_K is not None
    return Load(METAL, table.capacity_J_per_K, table.conductance_W_per_K)


def refuse_load(rig: Rig, what: str) -> None:
    """Raise RigError where a rig has a load in place of skin; `what` needs skin, such as `safety for people`."""
    from .rigfile import RigError

    if rig.bench_load is not None:
        raise RigError(f"rig {rig.name}: {without_skin(rig.bench_load.site, what)}")


def without_skin(site: str, what: str) -> str:
    """Why something cannot be judged where the display touches a load.

    >>> without_skin("air", "safety for people")
    'the display touches air in place of skin ([load]): safety for people cannot be judged; use the rig without [load]'
    """
    return (
        f"the display touches {with_article(site)} in place of skin ([load]): {what} cannot be judged; use the rig "
        "without [load]"
    )


def with_article(site: str) -> str:
    """A load in words.

    >>> with_article("metal block"), with_article("air")
    ('a metal block', 'air')
    """
    return f"a {site}" if site == METAL else site
