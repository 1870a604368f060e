"""Proposals for a word that is not known: by other words for a name, its beginning, its parts and its spelling."""

import re
from collections.abc import Iterable, Mapping

_MOST_LISTED = 12
SHORTEST = 2
"""Letters from which on a beginning or a part of a name is taken for it."""
RANKS = (3.0, 2.0, 1.0)
"""What another word for a name, its beginning and one of its parts are worth, beside spelling with 0 to 1."""


def nearest_words(
    word: str, known: Iterable[str], most: int = 1, cutoff: float = 0.6, also: Mapping[str, str] | None = None
) -> list[str]:
    """Return the known names that a word may stand for, the likeliest first: at least as alike as `cutoff` (0 to 1).

    `also` has a text with other words for some names.

    >>> nearest_words("coool", ["warm", "cool"]), nearest_words("xyz", ["warm"])
    (['cool'], [])
    >>> nearest_words("ni", ["dac-16", "ni-analogue-output"]), nearest_words("Bridge", ["pwm-h-bridge-10"])
    (['ni-analogue-output'], ['pwm-h-bridge-10'])
    >>> nearest_words("palm", ["forearm", "thenar"], also={"thenar": "palm thumb"})
    ['thenar']
    """
    from difflib import SequenceMatcher

    plain = word[:200].casefold()
    spelt, whole = SequenceMatcher(b=plain), re.compile(rf"(?<![^\W_]){re.escape(plain)}(?![^\W_])")

    def alike(name: str) -> float:
        text = name.casefold()
        spelt.set_seq1(text)
        if len(plain) >= SHORTEST:
            ways = (whole.search((also or {}).get(name, "").casefold()), text.startswith(plain), whole.search(text))
            if rank := max(rank * bool(way) for rank, way in zip(RANKS, ways, strict=True)):
                return rank + spelt.ratio()
        return 0.0 if spelt.quick_ratio() < cutoff else spelt.ratio()

    ranked = sorted(((alike(name), name) for name in known), reverse=True)
    return [name for score, name in ranked[:most] if score >= cutoff]


def did_you_mean(
    word: str, known: Iterable[str], most: int = 3, beside: str = "", also: Mapping[str, str] | None = None
) -> str:
    """Return a sentence with the nearest known words, or one that lists them all; with a file `beside`, that one.

    >>> did_you_mean("thenr", ["thenar", "shani2021"])
    'did you mean thenar?'
    >>> did_you_mean("xyz", ["thenar", "shani2021"])
    'known: shani2021, thenar'
    """
    if beside:
        return f"did you mean {beside}?"
    names = sorted(name for name in known if name)
    if close := nearest_words(word, names, most, 0.55, also):
        return f"did you mean {' or '.join(close)}?"
    return f"known: {', '.join(names[:_MOST_LISTED])}{', …' if len(names) > _MOST_LISTED else ''}"
