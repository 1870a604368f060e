"""The count of maintained lines, room by room: ``python tests/count.py`` prints the table for a release."""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = {"product": ("icons", "circuit", "perception", "notebooks", "thermicon", "docs", ".ci"), "tests": ("tests",)}
CODE = {"product": (".py", ".py.txt"), "tests": (".py", ".toml", ".csv", ".cue", ".c", ".json", ".txt")}
"""Endings of what counts: tests with their data, but not the reference data of others."""


@dataclass(frozen=True, slots=True)
class Room:
    """A folder with the lines and the number of files in it."""

    name: str
    lines: int
    files: int


def rooms(what: str) -> list[Room]:
    """The rooms of the product or of the tests."""
    lines: Counter[str] = Counter()
    files: Counter[str] = Counter()
    for folder in FOLDERS[what]:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.is_file() and path.name.endswith(CODE[what]) and "build" not in path.parts:
                room = path.parent.relative_to(ROOT).as_posix()
                lines[room] += len(path.read_text(encoding="utf-8").splitlines())
                files[room] += 1
    return [Room(name, lines[name], files[name]) for name in sorted(lines)]


if __name__ == "__main__":
    for what in FOLDERS:
        counted = rooms(what)
        for room in counted:
            print(f"{room.lines:7,} {room.files:4}  {room.name}")
        print(f"{sum(room.lines for room in counted):7,}       {what}\n")
