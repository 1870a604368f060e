"""Ratings: points of 100 by drive."""

from dataclasses import dataclass

from ..constants import Both, constant
from .mechanism import Mechanism


@dataclass(frozen=True, kw_only=True)
class Ratings(Mechanism):
    """A rating is a power of drive in multiples of threshold; repeated ratings scatter."""

    equation = "rating = g·u^n"
    source = "Stevens for the exponents; repeated ratings for their scatter"
    rating_at_threshold: Both[float] = constant("{} rating at threshold")
    rating_exponent: Both[float] = constant("{} rating exponent")
    mean_rating: Both[float] = constant("{} mean rating")
    rating_scatter: float = constant("scatter of ratings")
