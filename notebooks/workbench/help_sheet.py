"""The sheet behind "?": what can be dragged, clicked and pressed."""

from __future__ import annotations

from ..report.blocks import fragment
from ..timeline.terms import glossary

SHEET: tuple[tuple[str, tuple[str, ...]], ...] = (
    (
        "Time line",
        (
            "drag a filled dot: the corner moves, and the number in the text with it",
            "move the pointer: the cursor reads all curves, and stays where the pointer leaves the curves",
            "[ and ] choose a corner, arrows move it, with Shift ten times as far, Escape goes back to the cursor",
            "Left, Right, Home, End move the cursor; Ctrl+Z, Ctrl+Shift+Z and Ctrl+S as in the text",
        ),
    ),
    (
        "Text",
        (
            "Ctrl+Space offers what may follow; Enter or Tab takes it",
            "F8 goes to the next error, Ctrl+. takes its correction",
            "Ctrl+F searches, Ctrl+/ makes a line a comment, Ctrl+D selects the next occurrence",
            "Ctrl+Z and Ctrl+Shift+Z undo and redo text, drags and applied edits; Ctrl+S saves the file",
            "Tab, with no offer open, leaves the text",
        ),
    ),
    (
        "Set",
        (
            "click a cell, or choose it with arrows and Enter: both icons, why they are confused, the cheapest edit",
            "choose: the best few icons; Keep these takes the others out of the text (Undo brings them back)",
            "goal: what is wanted of the set, in words; which parts are met, by how much, and what binds",
        ),
    ),
    (
        "Versions",
        (
            "Keep this version, go on editing: the list shows each version with the lines that were changed since",
            "Restore brings a version back into the text; Undo takes it out again",
        ),
    ),
    ("Log", ("lay a measured log over the curves; shift moves it in time, Align finds the shift",)),
    ("Safety", ("click the badge: every limit that was judged on this run; export judges worst cases",)),
    ("Words", tuple(glossary())),
)


def help_html() -> str:
    """Return the sheet as HTML.

    >>> "F8" in help_html()
    True
    """
    return "".join(f"{fragment('block', head, 'th-head')}{fragment('points', lines)}" for head, lines in SHEET)
