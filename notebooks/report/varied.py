"""The keys that a sweep varies, and their values: ``--vary KEY=LOW:HIGH:N`` or ``KEY=VALUE,VALUE``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from thermicon.perception.ranking.swept import MEASURES, SITE

from ..messages import usage

MOST_VALUES = 10_000
FORM = (
    "give KEY=LOW:HIGH:N, for example contact.area_cm2=4:16:7, LOW:HIGH:Nlog for equal ratios, or values such as "
    "site=thenar,fingertip"
)


def read_measures(text: str, intervals: int) -> tuple[str, ...]:
    """Read ``--measure``, beside the draws for intervals; what cannot be is a usage error."""
    names = tuple(name.strip() for name in text.split(","))
    for name in names:
        if name not in MEASURES:
            raise usage(f"{name!r} is not one of {', '.join(MEASURES)}", "--measure")
    if len(set(names)) < len(names):
        raise usage(f"{text!r}: the same quantity is given twice", "--measure")
    if intervals == 1:
        raise usage("1 draw has no interval; give 2 or more, or 0 for none", "--intervals")
    if intervals == 0 and "correct_95" in names:
        raise usage("correct_95 is about people and model together, and needs 2 draws or more", "--intervals")
    return names


@dataclass(frozen=True, slots=True)
class Vary:
    """A dotted key of the rig file, `people.age_years` or `site`, and its values: in the file's unit, or names."""

    key: str
    values: tuple[float | str, ...]
    log: bool


def read_varied(texts: Sequence[str]) -> tuple[Vary, ...]:
    """Read every ``--vary``: one key, or two for a grid of all their combinations; more are a usage error."""
    varied = tuple(read_vary(text) for text in texts)
    if len(varied) > 2:
        raise usage(f"{len(varied)} keys are given; at most 2 can be varied, and 2 make a grid", "--vary")
    if len({vary.key for vary in varied}) < len(varied):
        raise usage(f"{varied[0].key} is given twice; a grid needs two different keys", "--vary")
    if (count := math.prod(len(vary.values) for vary in varied)) > MOST_VALUES:
        raise usage(f"{count:,} combinations are more than {MOST_VALUES:,}; use fewer values", "--vary")
    return varied


def read_vary(text: str) -> Vary:
    """Read one ``--vary``; a text of another form is a usage error that shows the form.

    >>> read_vary("contact.area_cm2=4:9:3").values, read_vary("contact.resistance_m2K_per_W=1e-4:1e-2:3log").values
    ((4.0, 6.5, 9.0), (0.0001, 0.001, 0.01))
    """
    key, equals, rest = text.partition("=")
    if ":" not in rest and "," in rest:
        return _listed(key.strip(), [part.strip() for part in rest.split(",")], text)
    parts = [part.strip() for part in rest.split(":")]
    if not (key.strip() and equals and len(parts) == 3):
        raise usage(f"{text!r}: {FORM}", "--vary")
    if key.strip() == SITE:
        raise usage(f"{text!r}: sites are names; give them as site=thenar,fingertip", "--vary")
    log = parts[2].endswith("log")
    low, high = (_bound(part, text) for part in parts[:2])
    try:
        count = int(parts[2].removesuffix("log"))
    except ValueError:
        raise usage(f"{text!r}: {parts[2]!r} is not a number of values; {FORM}", "--vary") from None
    if not 2 <= count <= MOST_VALUES:
        raise usage(f"{text!r}: {count} values is outside 2 to {MOST_VALUES}", "--vary")
    if low == high:
        raise usage(f"{text!r}: both ends are {low:g}; a sweep needs two different ends", "--vary")
    if log and not (low > 0 and high > 0):
        raise usage(f"{text!r}: equal ratios need both ends above 0; leave out log for equal steps", "--vary")
    shares = [k / (count - 1) for k in range(count)]
    values = [low * (high / low) ** share if log else low + (high - low) * share for share in shares]
    return Vary(key.strip(), tuple(float(f"{value:.12g}") for value in values), log)


def _listed(key: str, parts: Sequence[str], text: str) -> Vary:
    if not key or not all(parts):
        raise usage(f"{text!r}: {FORM}", "--vary")
    values = tuple(parts) if key == SITE else tuple(_bound(part, text) for part in parts)
    if len(set(values)) < len(values):
        raise usage(f"{text!r}: the same value is given twice", "--vary")
    return Vary(key, values, False)


def _bound(text: str, whole: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise usage(f"{whole!r}: {text!r} is not a number; {FORM}", "--vary")
    return value
