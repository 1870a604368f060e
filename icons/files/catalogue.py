"""The catalogue of errors: what every code means, a file that causes it with the message, and a corrected file."""

from dataclasses import dataclass

from ..language.parse import parse
from ..model.errors import CueErrors, codes
from ..near_words import nearest_words


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
        parts += [f"Wrong:\n\n{_indented(entry.wrong)}", f"What is said:\n\n{_indented(entry.message())}"]
    if entry.right:
        parts.append(f"Right:\n\n{_indented(entry.right)}")
    return "\n\n".join(parts)


def _indented(text: str) -> str:
    return "\n".join(f"  {line}".rstrip() for line in text.strip("\n").split("\n"))
