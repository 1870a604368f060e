"""The zones of a TCS II as elements: what its commands play on each."""

from __future__ import annotations

from collections.abc import Sequence

from .tcs2 import course_of


def zone_courses(commands: Sequence[str]) -> list[list[tuple[float, float]]]:
    """Corners of the profile of each zone, in their order; ValueError where the start would play anything else.

    A zone whose profile is not enabled (Ue) plays what was set before, unless the zone is disabled (S).
    """
    courses: dict[int, list[tuple[float, float]]] = {}
    rest = [each for each in commands if not each.startswith("Uw")]
    for profile in [each for each in commands if each.startswith("Uw")]:
        corners = course_of([*rest[:-1], profile, *rest[-1:]])
        zones = [zone for zone, bit in enumerate(profile[2:7]) if bit == "1"]
        if not zones or set(zones) & set(courses):
            raise ValueError(f"{profile[:7]}: every profile is for zones of its own")
        courses |= dict.fromkeys(zones, corners)
    mask = "".join("01"[zone in courses] for zone in range(5))
    starts = next((each[1:] for each in commands if each.startswith("S")), "11111")
    if not courses or f"Ue{mask}" not in commands or starts != mask:
        raise ValueError(f"profiles are for the zones {mask}, and Ue and S must enable these and no other one")
    return [courses[zone] for zone in sorted(courses)]
