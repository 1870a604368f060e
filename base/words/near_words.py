"""Proposals for a word that is not known: by other words for a name, its beginning, its parts and its spelling."""

import re
from collections.abc import Iterable, Mapping

_MOST_LISTED = 12
SHORTEST = 2
"""Letters from which on a beginning or a part of a name is taken for it."""
NO_OTHERS: Mapping[str, str] = {}


def nearest_words(word: str, known: Iterable[str], most: int = 1, cutoff: float = 0.6) -> list[str]:
    """Return the known words that are spelt as alike as ``cutoff`` (0 to 1), the most alike first.

    >>> nearest_words("coool", ["warm", "cool"]), nearest_words("xyz", ["warm"])
    (['cool'], [])
    """
    from difflib import get_close_matches

    return get_close_matches(word[:200], list(known), n=most, cutoff=cutoff)


def proposals(
    word: str, known: Iterable[str], most: int = 1, cutoff: float = 0.55, also: Mapping[str, str] = NO_OTHERS
) -> list[str]:
    """Return the known names that a word may stand for, whatever its capitals; `also` has other words for some of them.

    Those of the first way that finds any: another word for a name, its beginning, one of its parts, its spelling.

    >>> proposals("palm", ["forearm", "thenar"], also={"thenar": "palm thumb"}), proposals("Thenr", ["thenar"])
    (['thenar'], ['thenar'])
    >>> proposals("ni", ["dac-16", "ni-analogue-output"]), proposals("bridge", ["pwm-h-bridge-10"])
    (['ni-analogue-output'], ['pwm-h-bridge-10'])
    """
    plain, names = word[:200].casefold(), {name.casefold(): name for name in known}
    whole = re.compile(rf"(?<![^\W_]){re.escape(plain)}(?![^\W_])")
    meant = [name for name in names if whole.search(also.get(names[name], "").casefold())]
    begun = [name for name in names if name.startswith(plain)]
    holding = [name for name in names if whole.search(name)]
    close = (meant or begun or holding) if len(plain) >= SHORTEST else []
    near = nearest_words(plain, close, most, 0.0) or nearest_words(plain, names, most, cutoff)
    return [names[name] for name in near]


def did_you_mean(
    word: str, known: Iterable[str], most: int = 3, beside: str = "", also: Mapping[str, str] = NO_OTHERS
) -> str:
    """Return a sentence with what a word may stand for, or one that lists all known words; with a file `beside`, that.

    >>> did_you_mean("thenr", ["thenar", "shani2021"])
    'did you mean thenar?'
    >>> did_you_mean("xyz", ["thenar", "shani2021"])
    'known: shani2021, thenar'
    """
    if beside:
        return f"did you mean {beside}?"
    names = sorted(name for name in known if name)
    if close := proposals(word, names, most, also=also):
        return f"did you mean {' or '.join(close)}?"
    return f"known: {', '.join(names[:_MOST_LISTED])}{', …' if len(names) > _MOST_LISTED else ''}"
