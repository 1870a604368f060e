"""Site: thresholds of the forearm over those of the thenar."""

from dataclasses import dataclass

from ..channels import Channel
from ..constants import Both, constant
from .mechanism import Mechanism

FOREARM_SITES = ("forearm", "wrist", "arm")


@dataclass(frozen=True, kw_only=True)
class Site(Mechanism):
    """Sites of the forearm have thresholds and nerve paths of their own; every other site has those of the hand."""

    equation = "sensitivity ÷ forearm factor at forearm, wrist and arm"
    source = "Jamal et al. 1985 at the wrist over Stevens & Choo 1998 at the thenar"
    forearm_factor: Both[float] = constant("{} threshold on the forearm")

    def sensitivity(self, channel: Channel, area_m2: float | None, site: str | None) -> float:
        """The site's part of it: none where nothing is known of the site."""
        whole = super().sensitivity(channel, area_m2, site)
        return whole / self.forearm_factor.of(channel) if site is not None and on_forearm(site) else whole


def on_forearm(site: str) -> bool:
    """Whether a site is one of the forearm's, such as `left wrist`."""
    return any(name in site.lower() for name in FOREARM_SITES)
