"""What a ranking depends on most, one line an assumption."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from thermicon.icons.number_text import percent

NAMES = {f"laboratory, {channel}": f"sensitivity to {channel} in your laboratory" for channel in ("cold", "warm")}


def assumption_lines(found: Mapping[str, Any] | None) -> Iterator[str]:
    """Yield the assumptions that move the proportion correct most, what the site rests on, and what was not varied.

    >>> area = {"name": "area of contact", "unit": "cm²", "low": 0.75, "high": 3.0, "source": "people",
    ...         "correct_at_low": 0.4, "correct_at_high": 0.6, "value": 1.5}
    >>> next(line for line in assumption_lines({"moving": [area], "site": None, "not_varied": []}) if "area" in line)
    '  - area of contact: 40 % correct at 0.75 cm², 60 % at 3 cm² (1.5 cm² assumed)'
    """
    if found is None or not (found["moving"] or found["site"]):
        return
    yield ""
    if found["moving"]:
        yield "What this depends on most, from the people and draws above:"
    else:
        yield "What this depends on (no single assumption stands out from these people and draws):"
    for each in found["moving"]:
        yield f"  - {_moving(each)}"
    if found["site"] is not None:
        yield f"  - {_site(found['site'])}"
    if found["not_varied"]:
        yield f"  not varied: {', '.join(found['not_varied'])}"


def _moving(each: Mapping[str, Any]) -> str:
    low, high = percent(each["correct_at_low"]), percent(each["correct_at_high"])
    if each["source"] == "draws":
        name = NAMES.get(each["name"], each["name"])
        return f"{name}: {low} correct at the low end of its 95 %, {high} at the high end"
    unit = each["unit"]
    return (
        f"{each['name']}: {low} correct at {each['low']:.2g} {unit}, {high} at {each['high']:.2g} {unit} "
        f"({each['value']:.2g} {unit} assumed)"
    )


def _site(site: Mapping[str, Any]) -> str:
    nearest = site["nearest_recorded"]
    near = f"the nearest site with thresholds on record is the {nearest} ({site['why']})" if nearest else site["why"]
    used = (
        "whose thresholds are used" if nearest == site["thresholds_of"] else f"the {site['thresholds_of']}'s are used"
    )
    twice = site["proportion_correct_at_twice_the_thresholds"]
    more = "" if twice is None else f"; with twice those thresholds, {percent(twice)} correct"
    return f"{site['site']}: {near}, {used}{more}"
