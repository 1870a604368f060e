"""Text from files and people: which characters may stand in a name, and how any text is shown without acting.

Control characters steer terminals (colours, window titles, a cursor that overwrites a verdict), and marks of writing
direction make a line read differently from what it is. Names and titles do not take them; messages show "�" instead.
"""

import re
import unicodedata

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
