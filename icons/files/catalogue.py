"""The catalogue of error codes with examples."""

from dataclasses import dataclass
from textwrap import indent

from thermicon.base.words.near_words import nearest_words

from ..language.parse import parse
from ..model.errors import CueErrors, codes


@dataclass(frozen=True, slots=True)
class Entry:
    """One code: what it means, a wrong text and a right one, or, where no text can show it, what to do."""

    code: str
    title: str
    meaning: str
    wrong: str = ""
    right: str = ""
    cure: str = ""

    def message(self) -> str:
        """Return what is printed for the wrong text."""
        try:
            parse(self.wrong, "alerts.cue")
        except CueErrors as found:
            return str(found)
        raise ValueError(f"{self.code}: nothing is wrong with its example")


def catalogue() -> dict[str, Entry]:
    """Return the entries by code, in the order of the codes."""
    return {code: Entry(code, **values) for code, values in sorted(codes().items())}


def explain(code: str) -> str:
    """Return the entry for a code as plain text; ValueError, with the nearest codes, for one that does not exist."""
    wanted = code.strip().upper()
    wanted = f"E{wanted}" if wanted.isdigit() else wanted
    entries = catalogue()
    if wanted not in entries:
        titles = {entry.title.upper(): entry.code for entry in entries.values()}
        by_title = [titles[title] for title in nearest_words(wanted, titles, 2)]
        close = by_title or nearest_words(wanted, entries, 2, cutoff=0.0)
        near = ", ".join(f"{other} {entries[other].title}" for other in close)
        raise ValueError(f"there is no error {code.strip()[:40]}; the nearest are {near}")
    entry = entries[wanted]
    parts = [f"{entry.code} {entry.title}\n{entry.meaning}"]
    if entry.cure:
        parts.append(entry.cure)
    if entry.wrong:
        parts += ["Wrong:", indent(entry.wrong.strip("\n"), "  "), "What is said:", indent(entry.message(), "  ")]
    if entry.right:
        parts += ["Right:", indent(entry.right.strip("\n"), "  ")]
    return "\n\n".join(parts)
