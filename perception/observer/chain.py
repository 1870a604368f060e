"""The chain from what reaches the receptors to a sensation as calls of its mechanisms.

A fall of temperature at depth (`Tissue`) becomes a drive above the adapted level within the limits of quality
(`Adaptation`, `Bounds`), the drive multiples of a threshold that depends on area, site, age and presentation
(`Summation`, `Site`, `Age`, `Gain`), and these a sensation in d′ (`Transducer`): that is here. `sensation.detection`
goes on with criterion, conduction and decision (`Criterion`, `Conduction`, `Decision`), `sensation.percept` with names
(`Labels`), `identification` with what is remembered (`Memory`, `Ratings`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermicon.base.numbers.arrays import Array, as_rows

from ..kernels.parallel import over_rows
from .channels import Channel
from .mechanisms.adaptation import Adaptation
from .mechanisms.age import Age
from .mechanisms.bounds import Bounds
from .mechanisms.conduction import Conduction
from .mechanisms.criterion import Criterion
from .mechanisms.decision import Decision
from .mechanisms.gain import Gain
from .mechanisms.labels import Labels
from .mechanisms.mechanism import Mechanism
from .mechanisms.memory import Memory
from .mechanisms.ratings import Ratings
from .mechanisms.site import Site
from .mechanisms.spreads import Spreads
from .mechanisms.summation import Summation
from .mechanisms.tissue import Tissue
from .mechanisms.transducer import Transducer


@dataclass(frozen=True, kw_only=True)
class SensoryChain(
    Tissue, Adaptation, Bounds, Site, Summation, Age, Memory, Ratings, Transducer, Gain,
    Criterion, Conduction, Decision, Labels, Spreads, Mechanism,
):  # fmt: skip
    """The mechanisms of an observer, and the order in which they act.

    No mechanism overrides another one, so that the order of the bases means nothing.
    """

    def sensitivity(self, channel: Channel, area_m2: float | None, site: str | None) -> float:
        """Sensitivity relative to the hand at the reference area; None: that area, or the hand."""
        return self.of_area(channel, area_m2) / self.site_factor(channel, site)

    def sensation(
        self,
        drive: ArrayLike,
        channel: Channel,
        *,
        area_m2: float | None = None,
        site: str | None = None,
        threshold: ArrayLike = 1.0,
        out: Array | None = None,
    ) -> Array:
        """Sensation ψ in d′ units, of shape (..., n_time) like the drive (in `drive_unit`).

        `area_m2` None is the reference area, `site` None the thenar; `threshold` multiplies those of this person, one
        number or one for each leading index. It is written to `out`, which may be the drive.
        """
        from ..kernels import kernels

        rows, shape = as_rows(drive)
        psi = np.empty(shape) if out is None else out
        felt = psi.reshape(rows.shape)
        unit = self.threshold_drive.of(channel) / self.sensitivity(channel, area_m2, site)
        multiples = np.broadcast_to(np.asarray(threshold, dtype=np.float64), shape[:-1])
        scale = np.ascontiguousarray(1.0 / (unit * multiples)).reshape(-1)

        def work(part: slice) -> None:
            kernels.sensation(rows[part], scale[part], self.a, self.p, self.b, felt[part])

        over_rows(work, rows.shape[0], rows.size)
        return psi
