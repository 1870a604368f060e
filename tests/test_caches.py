"""Every cache of the program is listed in caches.toml with the time that it saves."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LEAST_PER_CENT = 0.8
"""Of a command or an evaluation: what saves less is not worth what it hides."""
DECORATED = r"@(?:lru_cache|cache|cached_property)\b.*\n(?:\s*@.*\n)*\s*def (\w+)"
ASSIGNED = r"\n\s*(\w+) = (?:lru_cache\(.*\)|cache)\("


def test_each_cache_is_known_by_what_it_saves() -> None:
    found = []
    for path in (
        path for room in ("base", "icons", "circuit", "perception", "notebooks") for path in (ROOT / room).rglob("*.py")
    ):
        module = path.relative_to(ROOT).with_suffix("").as_posix().replace("/", ".")
        text = path.read_text(encoding="utf-8")
        found += [f"{module}.{name}" for name in re.findall(DECORATED, text) + re.findall(ASSIGNED, text)]
    listed = tomllib.loads((ROOT / "tests" / "caches.toml").read_text(encoding="utf-8"))
    assert sorted(found) == sorted(listed)
    assert [name for name, (saves_s, share, _) in listed.items() if share < LEAST_PER_CENT or saves_s <= 0.0] == []
