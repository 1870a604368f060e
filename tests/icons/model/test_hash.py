"""The content hash: equal for equal content and different after any change."""

import os
import subprocess
import sys
from dataclasses import replace

import pytest

from tests.builders import messages
from thermicon.icons import Icon, IconSet, hold, parse, rest

TEXT = """cue 1
set alerts "Three alerts" { site thenar; control display; baseline 32 °C; by "me"; tags "a, b" }
icon dip means "message" doi "10.1/x" { cool by 6 °C at 3 °C/s; hold for 4 s; return at 3 °C/s; total 8 s }
icon lot(size in [1, 2] K, time in 1..2 step 0.5 s) means "{size}" {
  pulse by size for time; square by 1 K every 1 s for 2 s
}
icon both { repeat 2 { play dip }; play lot_size=1_time=1.5 }
"""
SET = parse(TEXT)
PINNED = {
    "set": "202ad3a31478310c99ed9815585893aeb7f48e8455128e4bc3d3de361f9f9089",
    "dip": "d34e3f9e3abde125a47242a26ba18d1359473f3d7b042e71a22c1feb68c47c6c",
    "lot_size=1_time=1.5": "5677e781ed36ce0669b2b1216d55e60c6cca72ef194b92bbc169b0175da22e56",
    "both": "545d18f6ffba655d81864e7edbf59f25050075ae1165d6bbf984b779954239f6",
}
PROGRAM = (
    "import sys; from thermicon.icons import parse\n"
    "made = parse(sys.stdin.buffer.read())\n"
    "print(made.content_hash, *(made[name].content_hash for name in sys.argv[1:]))"
)
NAMES = [name for name in PINNED if name != "set"]


def test_hashes_are_pinned_and_the_same_in_every_process() -> None:
    assert {"set": SET.content_hash, **{name: SET[name].content_hash for name in NAMES}} == PINNED
    for seed in ("0", "4711"):
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        command = [sys.executable, "-c", PROGRAM, *NAMES]
        done = subprocess.run(command, input=TEXT.encode(), capture_output=True, check=True, env=environment)
        assert done.stdout.decode().split() == list(PINNED.values())


def test_layout_comments_and_spelling_do_not_count() -> None:
    other = TEXT.replace("; ", "  # note\n ").replace("6 °C", "6.0 K").replace("4 s", "4000 ms")
    assert parse(other).content_hash == SET.content_hash


CASES = messages(__file__, "cases.toml")


@pytest.mark.parametrize(("old", "new"), CASES["hash"]["changes"])
def test_another_content_has_another_hash(old: str, new: str) -> None:
    assert parse(TEXT.replace(old, new, 1)).content_hash != SET.content_hash


def test_order_counts() -> None:
    one, two = Icon("one", [hold(1)]), Icon("two", [rest(1)])
    made = IconSet("", "", one.context, one.metadata, (one, two))
    assert replace(made, entries=(two, one)).content_hash != made.content_hash
    assert Icon("one", [rest(1)]).content_hash != one.content_hash
