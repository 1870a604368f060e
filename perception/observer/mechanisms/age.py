"""Age: sensitivity lost per decade."""

import math
from dataclasses import dataclass

from ..channels import Channel
from ..constants import ANY, Both, constant
from .mechanism import Mechanism

YOUNG_YEARS, OLD_YEARS = 25.0, 65.0
"""Age at which thresholds are the observer's, and an age at which they are old."""


@dataclass(frozen=True, kw_only=True)
class Age(Mechanism):
    """Thresholds at an age over those at 25 years."""

    equation = "threshold × e^(lost · (age − 25)/10)"
    source = "QST norms (Magerl et al. 2010)"
    lost_per_decade: Both[float] = constant("{} sensitivity lost per decade", ANY)

    def age_factor(self, age_years: float, channel: Channel) -> float:
        """Threshold of a channel at an age over that at 25 years; a ValueError outside 18 to 100 years."""
        if not 18.0 <= age_years <= 100.0:
            raise ValueError(f"an age of {age_years:g} years is not covered: give 18 to 100")
        return math.exp(self.lost_per_decade.of(channel) * (age_years - YOUNG_YEARS) / 10.0)
