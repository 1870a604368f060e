"""The kind of a text file by words that only one kind has."""

import re

KINDS = {
    "cue file": (r"cue\s+\d", "give it where icons are asked for"),
    "study file": (r"\[(stimuli|participants|trials)\]", "thermicon study takes it"),
    "device file": (r"driven_by\s*=", "give it as the device"),
    "layout file": (r"\[\[\s*element\s*\]\]", "give it as the rig, as of rank"),
    "rig file": (r"(base\s*=|\[\[?(skin|contact|heat_sink|module|thermode)\b)", "give it as the rig, as of simulate"),
    "log of E-Prime": (r"\*\*\* LogFrame Start", "export a table from E-DataAid"),
    "table of records": (r"\A(#.*\n|\s)*\[\[record\]\]", "give it as the observer"),
}
"""How a line of each kind begins, which no kind before it has, and where it belongs."""
HEAD = 20_000


def other_kind(text: str, expected: str) -> tuple[str, str] | None:
    """The kind of a text that is not of the `expected` one, and where it belongs; None where none is certain.

    >>> other_kind("# mine\\n[contact]\\narea_cm2 = 4\\n", "study file")
    ('this is a rig file, not a study file', 'give it as the rig, as of simulate')
    >>> other_kind("[contact]\\narea_cm2 = 4\\n", "rig file")
    """
    marked = (kind for kind, (mark, _) in KINDS.items() if re.search(rf"(?m)^[ \t]*{mark}", text[:HEAD]))
    found = next(marked, expected)
    return None if found == expected else (f"this is a {found}, not a {expected}", KINDS[found][1])
