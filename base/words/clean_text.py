"""Names and texts without characters that act on a terminal or a page.

Control characters steer terminals (colours, window titles, a cursor that overwrites a verdict), and marks of writing
direction make a line read differently from what it is. Names and titles do not take them; messages show "�" instead.
"""

import re
import unicodedata

_WORD = r"[^\W\d_](?:[^\W_]|-)*"
# Members of a family are named after their values: ramp_amount=-6_rate=1.
_NAME = re.compile(rf"{_WORD}(?:_{_WORD}=-?[0-9]+(?:\.[0-9]+)?(?:e-?[0-9]+)?)*")
# Joiners and the soft hyphen are part of ordinary words in many scripts.
_HARMLESS = "\u00ad\u200c\u200d"
_PLAIN = re.compile(r"[ -~\n\t]*")


def acts(char: str) -> bool:
    """Tell whether a character is a control, a mark of writing direction, a line separator or half a character.

    >>> acts("\\x1b"), acts("\\u202e"), acts("\\u2028"), acts("é"), acts("°")
    (True, True, True, False, False)
    """
    return unicodedata.category(char) in ("Cc", "Cf", "Cs", "Zl", "Zp") and char not in _HARMLESS


def first_control(text: str, allowed: str = "") -> str | None:
    """Return the first character that acts, as in U+001B, or None; those in ``allowed`` may stand.

    >>> first_control("a\\x1b[2J"), first_control("two\\nlines", "\\n")
    ('U+001B', None)
    """
    if text.isprintable():  # said by the interpreter at once; a rig file has thousands of letters
        return None
    bad = next((char for char in text if not char.isprintable() and char not in allowed and acts(char)), None)
    return None if bad is None else f"U+{ord(bad):04X}"


def clean(text: str) -> str:
    """Return a text as it may be shown on a terminal: line ends and tabs stay, what else acts becomes "�".

    >>> clean("drive.csv\\x1b]0;mine\\x07: is\\nred")
    'drive.csv�]0;mine�: is\\nred'
    """
    if _PLAIN.fullmatch(text):
        return text
    return "".join(char if char in "\n\t" or not acts(char) else "�" for char in text)


def clean_line(text: str) -> str:
    """Return a text as one line that may be shown: line ends and tabs become "�" too.

    >>> clean_line("x\\ny")
    'x�y'
    """
    return clean(text).replace("\n", "�").replace("\t", "�")


def name_fault(name: str) -> str | None:
    """Return what keeps a text from being a name, or None.

    >>> name_fault("cooling-step"), name_fault("3rd")
    (None, "'3rd' is not a name: letters, digits and hyphens, beginning with a letter")
    """
    if _NAME.fullmatch(name):
        return None
    return f"{name!r} is not a name: letters, digits and hyphens, beginning with a letter"


def text_fault(text: str) -> str | None:
    """Return what keeps a text out of metadata, or None: it must show something and hold no control characters."""
    if not text.strip():
        return "the text is empty"
    bad = first_control(text, "\n\t")
    return f"the text holds the control character {bad}" if bad else None
