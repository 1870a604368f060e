"""Memory: the precision of remembered episodes."""

import math
from dataclasses import dataclass

from ..channels import FORM, Channel
from ..constants import FROM_0, SHARE, constant, names_of
from .gain import Gain
from .ratings import Ratings


@dataclass(frozen=True, kw_only=True)
class Memory(Ratings, Gain):
    """Noise of remembered episodes, the bar of an episode, and the cost of one that is missing.

    `timing_noise` σ_T is that of rate, length and pause, which the rate task sets. Nothing published says it of
    intensity: that noise and the scatter of repeated ratings differ by a factor of 1.5 to 2.5; λ, `rated_share`, lies
    between the two. `episode_bar` is the sensation in d′ that a stretch must reach, and by which a valley must part
    two. `missing_cost` is that of a felt episode that a name lacks, beyond its size, when names are given directly: the
    number of features whose noise it would have cost to match it. In a share `lapse` of trials any name is given.
    In a laboratory, the odds that one icon is called another differ from all this by a factor with the SD `pair_spread`
    (ln), the same for all its people.
    """

    equation = "σ_I = σ_T^(1 − λ) · σ_rated^λ, σ_rated = scatter / (n·rated)"
    source = "Bergmann Tiest & Kappers 2009 for the noise of rates"
    timing_noise: float = constant("memory noise (episodes)", method="episodes")
    rated_share: float = constant("share of the scatter of ratings", SHARE)
    missing_cost: float = constant("cost of a missing episode", FROM_0)
    episode_bar: float = constant("bar of an episode")
    lapse: float = constant("lapse rate", SHARE)
    pair_spread: float = constant("spread of pairs between laboratories", FROM_0, default=0.0)

    def intensity_noise(self, channel: Channel) -> float:
        """σ_I of a channel in log units of drive; gain noise makes part of the scatter of ratings."""
        moved = self.rating_exponent.of(channel) * self.mean_rating.of(channel)
        scatter = math.hypot(self.rating_scatter, moved * self.gain_noise)
        return float(self.timing_noise ** (1.0 - self.rated_share) * (scatter / moved) ** self.rated_share)


MEMORY_NAMES = (*names_of(Memory, "timing_noise", "rated_share", "missing_cost", "episode_bar", "pair_spread"), FORM)
"""Every number of memory that a table of draws may have a column for. No published posterior has them."""
NOISE, MISSING, PAIRS = (names_of(Memory, field)[0] for field in ("timing_noise", "missing_cost", "pair_spread"))
