"""What a laboratory can measure, and the constants that each measurement would determine.

Offsets of the laboratories of the evidence and constants that other experiments alone make use of are not among them.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Measurement:
    """A measurement in words, and the constants, by name, that it would determine."""

    text: str
    constants: tuple[str, ...]


MEASUREMENTS = (
    Measurement(
        "let people name a few icons from memory and count",
        (
            *("memory noise", "share of the scatter of ratings", "cost of a missing episode", "bar of an episode"),
            *("wrong labels", "warmth that lingers"),
        ),
    ),
    Measurement(
        "repeated magnitude ratings of a few amplitudes",
        (
            *(f"{channel} rating {what}" for channel in ("cold", "warm") for what in ("at threshold", "exponent")),
            "scatter of ratings",
        ),
    ),
    Measurement(
        "thresholds of a dozen people on your own display, by the method of limits",
        (
            *(f"{channel} threshold drive" for channel in ("cold", "warm")),
            *(f"{channel} threshold on the forearm" for channel in ("cold", "warm")),
            *(f"{channel} sensitivity between people" for channel in ("cold", "warm")),
            *("laboratory, cold", "laboratory, warm", "sensitivity between laboratories"),
            *("criterion between people", "correlation of cold and warm"),
        ),
    ),
    Measurement(
        "reaction times and false alarms to changes well above threshold",
        (
            *(f"{channel} conduction velocity" for channel in ("cold", "warm")),
            *("decision time", "decision time between people", "decision time between trials", "choice time"),
            *("criterion of speeded answers", "caution after a pre-pulse"),
        ),
    ),
    Measurement(
        "the share of reports against the size of small changes (psychometric function)",
        ("transducer exponent", "gain noise", "criterion of yes and no"),
    ),
    Measurement("amplitude difference thresholds at several amplitudes", ("slope of sensation",)),
    Measurement(
        "thresholds at several rates of change",
        ("slow adaptation time", "integration time", "noise correlation time"),
    ),
    Measurement("thresholds on areas of several sizes", ("cold area exponent", "warm area exponent")),
    Measurement(
        "coolings of warm skin and warmings of cool skin, at several starting temperatures",
        ("cold limit", "warm limit", "softness of the limits"),
    ),
    Measurement(
        "a log of display and voltage of your rig on skin, to which thermicon fit fits contact and module",
        ("contact resistance", "thickness of the outermost layer"),
    ),
    Measurement(
        "thresholds of older people",
        tuple(f"{channel} sensitivity lost per decade" for channel in ("cold", "warm")),
    ),
    Measurement(
        "no measurement of people: depths and thermal properties of the skin",
        (
            *("cold receptor depth", "warm receptor depth", "effusivity of living skin"),
            "contact resistance of a thermode",
        ),
    ),
)


def base_name(constant: str) -> str:
    """A constant without the norm that its value belongs to.

    >>> base_name("memory noise (episodes)")
    'memory noise'
    """
    return constant.split(" (")[0]
