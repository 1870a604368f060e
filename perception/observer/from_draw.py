"""An observer with the constants of one draw, and people who differ as that draw says."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from .channels import Channel
from .memory import BAR, MISSING, NOISE, SHARE, Ratings
from .observer import Observer, Receptor


def observer_with(base: Observer, values: Mapping[str, float]) -> Observer:
    """The observer whose constants, those of memory among them, have these values; all else is that of `base`.

    >>> base = Observer.load()
    >>> values = {"criterion of speeded answers": 3.0, "cold limit": 33.0}
    >>> moved = observer_with(base, values)
    >>> moved.criterion, moved.cold.limit_C, moved.warm == base.warm
    (3.0, 33.0, True)
    """

    def value(name: str, own: float) -> float:
        return values.get(name, own)

    def receptor(channel: Channel) -> Receptor:
        own = base.receptor(channel)
        return replace(
            own,
            adaptation_s=value("slow adaptation time", own.adaptation_s),
            threshold_drive=value(f"{channel} threshold drive", own.threshold_drive),
            velocity_m_per_s=value(f"{channel} conduction velocity", own.velocity_m_per_s),
            area_exponent=value(f"{channel} area exponent", own.area_exponent),
            limit_C=None if own.limit_C is None else value(f"{channel} limit", own.limit_C),
            softness_K=value("softness of the limits", own.softness_K),
            forearm_factor=value(f"{channel} threshold on the forearm", own.forearm_factor),
        )

    gain_noise = value("gain noise", base.gain_noise)

    def ratings(channel: Channel) -> Ratings:
        own = base.memory.ratings(channel)
        exponent = value(f"{channel} rating exponent", own.exponent)
        # What repeated ratings scatter by, without the part that gain noise makes of it.
        scatter = math.sqrt(max(own.scatter**2 - (own.exponent * own.rated * base.gain_noise) ** 2, 0.0))
        whole = math.hypot(value("scatter of ratings", scatter), exponent * own.rated * gain_noise)
        return Ratings(value(f"{channel} rating at threshold", own.at_threshold), exponent, own.rated, whole)

    own = base.memory
    return replace(
        base,
        cold=receptor("cold"),
        warm=receptor("warm"),
        integration_s=value("integration time", base.integration_s),
        a=value("slope of sensation", base.a),
        p=value("transducer exponent", base.p),
        gain_noise=gain_noise,
        criterion=value("criterion of speeded answers", base.criterion),
        noise_correlation_s=value("noise correlation time", base.noise_correlation_s),
        decision_s=value("decision time", base.decision_s),
        choice_s=value("choice time", base.choice_s),
        decision_noise=value("decision time between trials", base.decision_noise),
        memory=replace(
            own,
            timing=value(NOISE, own.timing),
            share=value(SHARE, own.share),
            missing=value(MISSING, own.missing),
            bar=value(BAR, own.bar),
            cold=ratings("cold"),
            warm=ratings("warm"),
        ),
    )
