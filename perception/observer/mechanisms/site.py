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

    def site_factor(self, channel: Channel, site: str | None) -> float:
        """Thresholds of a site over those of the hand; 1 where nothing is known of the site."""
        return self.forearm_factor.of(channel) if site is not None and on_forearm(site) else 1.0


def on_forearm(site: str) -> bool:
    """Whether a site is one of the forearm's, such as `left wrist`."""
    return any(name in site.lower() for name in FOREARM_SITES)
