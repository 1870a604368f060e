"""The known words nearest to an unknown one."""

from collections.abc import Iterable

_MOST_LISTED = 12


def nearest_words(word: str, known: Iterable[str], most: int = 1, cutoff: float = 0.6) -> list[str]:
    """Return the known words that are at least as alike as ``cutoff`` (0 to 1), the most alike first.

    >>> nearest_words("coool", ["warm", "cool"]), nearest_words("xyz", ["warm"])
    (['cool'], [])
    """
    from difflib import get_close_matches

    return get_close_matches(word[:200], list(known), n=most, cutoff=cutoff)


def did_you_mean(word: str, known: Iterable[str], most: int = 3, beside: str = "") -> str:
    """Return a sentence with the nearest known words, or one that lists them all; with a file `beside`, that one.

    >>> did_you_mean("thenr", ["thenar", "shani2021"])
    'did you mean thenar?'
    >>> did_you_mean("xyz", ["thenar", "shani2021"])
    'known: shani2021, thenar'
    """
    if beside:
        return f"did you mean {beside}?"
    names = sorted(name for name in known if name)
    if close := nearest_words(word, names, most, 0.55):
        return f"did you mean {' or '.join(close)}?"
    return f"known: {', '.join(names[:_MOST_LISTED])}{', …' if len(names) > _MOST_LISTED else ''}"
