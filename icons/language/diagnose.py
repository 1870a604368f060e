"""Diagnosis of one wrong statement from its tokens in the light of the grammar."""

import re
from dataclasses import replace

from ..model.words import LACKING, QUOTES, VOCABULARY, nearest
from .diagnose_elements import elements
from .diagnose_family import family
from .diagnose_number import not_a_number, notation, unit
from .diagnose_word import connective, extra, joined, pace, peaks, unit_twice, word
from .failed_statement import FailedStatement, at, short, signed, swap
from .source import Finding, Patch

_CURLY = re.compile(r"[”“»«’‘'](?!\w)")
_HOMES = {
    "icon": "belongs inside the braces of an icon",
    "set": "belongs inside the braces of the set",
    "file": "belongs outside of every block",
}
_NAME_HELP = "a name has letters, digits and hyphens and begins with a letter, such as cooling-step"


def diagnose(case: FailedStatement) -> Finding:
    """Return the finding for a statement that stopped making sense."""
    for rule in _RULES:
        if (finding := rule(case)) is None:
            continue
        words = [piece.text.casefold() for piece in case.pieces[case.index :] if piece.text not in (case.names or ())]
        said = next((LACKING[word] for word in words if word in LACKING), finding.help)
        if case.where not in ("icon", "repeat") or said == finding.help or finding.code == "E105":
            return finding
        return replace(finding, help=said, cures=())  # a word has no counterpart in the language
    what = f'"{short(case.bad.text)}" does not fit here' if case.bad.text else "something is missing here"
    return at(case.bad, "E101", what, _examples(case.where))


def not_yet(case: FailedStatement) -> Finding | None:
    """A target that the language does not have on purpose."""
    bad = case.bad
    if bad.text == "baseline" and case.where in ("icon", "repeat") and case.before is not None:
        what = "baseline is not a target in this version"
        if case.first == "step":
            return at(bad, "E120", what, "write the level itself, such as: step to 32 °C")
        return at(bad, "E120", what, "write: return at 3 °C/s", Patch(case.pieces[0].start, bad.end, "return"))
    return None


def quotes(case: FailedStatement) -> Finding | None:
    """A text between quotation marks that are not straight, or between single ones."""
    bad = case.bad
    if bad.text not in QUOTES or not case.accepts & {"STRING", "TITLE"}:
        return None
    close = next((piece for piece in case.rest if piece.text in QUOTES[bad.text]), None)
    end = close.end if close is not None else bad.end
    what = "the quotation marks of a text are straight and double"
    return Finding("E117", bad.start, end, what, f'"...", not {bad.text}...{QUOTES[bad.text][0]}', (swap(bad, '"'),))


def comment(case: FailedStatement) -> Finding | None:
    """A comment that begins as in another language."""
    bad, rest = case.bad, case.rest
    if case.index and "_NEWLINE" not in case.accepts:
        return None
    mark = bad.text + (rest[0].text if rest and rest[0].start == bad.end else "")
    if mark not in ("//", "--", "/*", "/**"):
        return None
    cure = Patch(bad.start, rest[0].end, "#")
    return Finding("E105", bad.start, rest[0].end, f'a comment begins with "#", not with "{mark}"', "", (cure,))


def text(case: FailedStatement) -> Finding | None:
    """A text that is never closed, or that is missing."""
    bad = case.bad
    if bad.kind == "text" and (len(bad.text) < 2 or not bad.text.endswith('"') or bad.text.endswith('\\"')):
        # A curly mark closes where no letter follows: an apostrophe has one.
        curly = [Patch(bad.start + found.start(), bad.start + found.end(), '"') for found in _CURLY.finditer(bad.text)]
        cures: tuple[Patch, ...] = (Patch(bad.end, bad.end, '"'),)
        stripped = bad.text.rstrip()
        if stripped.endswith("{"):
            inner = stripped[:-1].rstrip()
            cures = (Patch(bad.start + len(inner), bad.end, '" {'), *cures)
        cures = (*curly[:2], *cures)
        return at(
            bad, "E111", "this text has no closing quotation mark", 'a text is on one line, between "..."', *cures
        )
    if case.accepts == {"STRING"}:
        key = case.before.text if case.before else ""
        cure = (swap(bad, f'"{bad.text}"'),) if bad.kind in ("word", "number") else ()
        return at(bad, "E117", f'"{key}" needs a text in quotation marks', f'for example {key} "..."', *cure)
    return None


def character(case: FailedStatement) -> Finding | None:
    """A character that no statement has."""
    bad = case.bad
    if bad.kind != "other" or (bad.text in "([" and "LPAR" in case.accepts):
        return None
    if case.accepts & {"BY", "TO"} and (found := signed(case)):
        return found
    code = f"U+{ord(bad.text):04X}"
    shown = f'"{bad.text}" ({code})' if bad.text.isprintable() else code
    cures = [swap(bad, "")] if case.idle([bad]) else []
    return at(bad, "E105", f"the character {shown} has no meaning here", "remove it", *cures)


def opening(case: FailedStatement) -> Finding | None:
    """A first word that begins nothing."""
    bad = case.bad
    if case.index or "LBRACE" in case.accepts:
        return None
    if bad.kind == "end":
        return Finding("E101", case.at, case.at + 1, "a block needs a word before it", _examples(case.where))
    known = VOCABULARY[case.where]
    close = nearest(bad.text, known)
    cures = [swap(bad, close)] if close else []
    if case.where == "set":
        return at(bad, "E216", f'"{short(bad.text)}" is not a setting', f"settings are: {', '.join(known)}", *cures)
    said = next((home for block, home in _HOMES.items() if bad.text in VOCABULARY[block]), "is not understood")
    return at(bad, "E101", f'"{short(bad.text)}" {said}', _examples(case.where), *cures)


def block(case: FailedStatement) -> Finding | None:
    """A header that no brace follows."""
    if "LBRACE" not in case.accepts:
        return None
    bad = case.bad
    last = case.pieces[-1] if case.pieces else bad
    if bad.kind == "end" or bad.text in VOCABULARY["icon"] or bad.text in VOCABULARY["set"]:
        here = case.before or last
        cure = Patch(here.end, here.end, " {")
        cause, hint = 'no "{" opens the block after this', 'statements are written in "{ ... }"'
        return Finding("E114", here.start, here.end, cause, hint, (cure,))
    if case.first == "repeat":
        cures = [swap(bad, "")] if case.idle([bad]) else []
        return at(bad, "E114", 'a "{" is needed here', "for example: repeat 3 { ... }", *cures)
    texted = any(piece.kind == "text" for piece in case.rest[:1])
    if bad.kind == "word" and case.index == 2 and case.first == "icon" and not texted:
        joined = Patch(case.pieces[1].end, bad.end, "-" + bad.text)
        return at(bad, "E113", "a name must not contain spaces", "join its parts with hyphens", joined)
    if bad.kind == "word" and "KEY" in case.accepts and (close := nearest(bad.text, VOCABULARY["header"])):
        return at(bad, "E101", f'"{bad.text}" is not a key', _keys(), swap(bad, close))
    return at(bad, "E101", f'"{short(bad.text)}" does not fit here', _keys())


def name(case: FailedStatement) -> Finding | None:
    """Something else where a name belongs."""
    if "NAME" not in case.accepts:
        return None
    bad = case.bad
    plain = "".join(char if char.isalnum() else "-" for char in bad.text.strip('"')).strip("-")
    plain = plain if plain[:1].isalpha() else f"{case.first}-{plain}" if plain else ""
    if bad.kind == "end" or not plain:
        return at(bad, "E113", f'a name is missing after "{case.first}"', _NAME_HELP)
    what = "a name has no quotation marks" if bad.kind == "text" else f'"{short(bad.text)}" is not a name'
    return at(bad, "E113", what, _NAME_HELP, swap(bad, plain))


def _examples(where: str) -> str:
    if where == "file":
        return 'a file holds "cue 1", at most one set, and icons: icon my-icon { ... }'
    return "statements begin with: " + ", ".join(VOCABULARY[where])


def _keys() -> str:
    return f'after the name come {", ".join(VOCABULARY["header"])}, each with a text, then "{{"'


_RULES = (
    *(not_yet, quotes, text, elements, family, unit_twice, notation, unit, not_a_number, comment, joined, character),
    *(opening, block, name),
    *(word, peaks, extra, pace, connective),
)
