"""Say in plain words what is wrong with one statement, from its own pieces and from what the grammar could take."""

from dataclasses import dataclass

from thermicon.icons.source import Edit, Finding, Piece
from thermicon.icons.units import KIND_WORDS, UNITS, Kind
from thermicon.icons.words import EXAMPLES, NOT_YET, VOCABULARY, nearest, nearest_unit, unit_kinds

__all__ = ["VOCABULARY", "diagnose"]

_UNIT_KINDS: dict[str, Kind] = {
    "ABSOLUTE": "absolute",
    "DIFFERENCE": "difference",
    "RATE": "rate",
    "TIME": "time",
    "CURRENT": "current",
    "CURRENT_RATE": "current_rate",
}
_CONNECTIVES = {"AT": "at", "OVER": "over", "BY": "by", "TO": "to", "FOR": "for"}
_TAILS = {"hold": "for 1 s", "rest": "for 1 s"}


@dataclass(frozen=True, slots=True)
class _Case:
    pieces: list[Piece]
    index: int
    at: int
    accepts: frozenset[str]
    where: str

    @property
    def bad(self) -> Piece:
        if self.index < len(self.pieces):
            return self.pieces[self.index]
        end = self.pieces[-1].end if self.pieces else self.at
        return Piece("end", "", end, end)

    @property
    def before(self) -> Piece | None:
        return self.pieces[self.index - 1] if self.index else None

    @property
    def first(self) -> str:
        return self.pieces[0].text if self.pieces else ""


def diagnose(pieces: list[Piece], index: int, at: int, accepts: frozenset[str], where: str) -> Finding:
    """Return the finding for a statement that stopped making sense at ``pieces[index]``, or at its end.

    ``accepts`` are the terminals that the grammar could take there, ``where`` is "file", "set", "icon" or "repeat".
    """
    case = _Case(pieces, index, at, accepts, where)
    for rule in (_not_yet, _text, _unit, _number, _character, _opening, _block, _name, _extra, _pace, _connective):
        finding = rule(case)
        if finding is not None:
            return finding
    what = f'"{_short(case.bad.text)}" does not fit here' if case.bad.text else "something is missing here"
    return _at(case.bad, "E101", what, _examples(where))


def _not_yet(case: _Case) -> Finding | None:
    bad = case.bad
    if case.first in NOT_YET and case.index == 0:
        help = NOT_YET[case.first]
        return _at(bad, "E120", f'"{case.first}" is designed, but this version does not have it', help)
    if bad.text == "baseline" and case.where in ("icon", "repeat") and case.before is not None:
        whole = Edit(case.pieces[0].start, bad.end, "return")
        return _at(bad, "E120", "baseline is no target in this version", "write: return at 3 °C/s", whole)
    return None


def _text(case: _Case) -> Finding | None:
    bad = case.bad
    if bad.kind == "text" and (len(bad.text) < 2 or not bad.text.endswith('"') or bad.text.endswith('\\"')):
        cures: tuple[Edit, ...] = (Edit(bad.end, bad.end, '"'),)
        stripped = bad.text.rstrip()
        if stripped.endswith("{"):
            inner = stripped[:-1].rstrip()
            cures = (Edit(bad.start + len(inner), bad.end, '" {'), *cures)
        return _at(
            bad, "E111", "this text has no closing quotation mark", 'a text stands on one line, between "..."', *cures
        )
    if case.accepts == {"STRING"}:
        key = case.before.text if case.before else ""
        cure = (Edit(bad.start, bad.end, f'"{bad.text}"'),) if bad.kind in ("word", "number") else ()
        return _at(bad, "E117", f'"{key}" needs a text in quotation marks', f'for example {key} "..."', *cure)
    return None


def _unit(case: _Case) -> Finding | None:
    kinds = [kind for terminal, kind in _UNIT_KINDS.items() if terminal in case.accepts]
    number, bad = case.before, case.bad
    if not kinds or number is None:
        return None
    kind = kinds[0]
    if case.where in ("icon", "repeat") and case.first == "return":
        kind = "rate"
    touching = bad.start == number.end
    if bad.kind == "end" or (bad.kind != "word" and bad.kind != "other") or (bad.text in _CONNECTIVES.values()):
        cures = [Edit(number.end, number.end, " " + unit) for unit in list(UNITS[kind])[:1]]
        return _at(number, "E102", "this number has no unit", EXAMPLES[kind], *cures)
    if bad.text in ("%", "%/s"):
        return _at(bad, "E103", f'"{bad.text}" is no unit of this language', EXAMPLES[kind])
    others = [other for other in unit_kinds(bad.text) if other not in kinds]
    if case.first == "to" and kind == "current" and "absolute" in others:
        heads = [Edit(case.pieces[0].start, case.pieces[0].start, word) for word in ("cool ", "warm ")]
        help = 'temperatures take a direction: "cool to 26 °C at 3 °C/s"'
        return Finding(
            "E209", case.pieces[0].start, case.pieces[0].end, '"to" alone moves a current', help, tuple(heads)
        )
    if others:
        if kind == "absolute" and bad.text == "K":
            kelvin = "K is for differences; an absolute temperature is in °C"
            return _at(bad, "E104", kelvin, EXAMPLES[kind], Edit(bad.start, bad.end, "°C"))
        meaning = "a temperature" if "absolute" in others else KIND_WORDS[others[0]]
        what = f'"{bad.text}" makes it {meaning}; {KIND_WORDS[kind]} is needed'
        cures = [Edit(bad.start, bad.end, unit) for unit in _similar(bad.text, kind)]
        return _at(bad, "E104", what, EXAMPLES[kind], *cures)
    close = nearest_unit(bad.text, kind)
    pad = "" if touching or bad.start > number.end else " "
    cures = [Edit(bad.start, bad.end, pad + close)] if close else []
    known = ", ".join(UNITS[kind])
    return _at(bad, "E103", f'"{_short(bad.text)}" is not a unit', f"{KIND_WORDS[kind]} is in one of: {known}", *cures)


def _similar(unit: str, kind: Kind) -> list[str]:
    # "°C" where a rate belongs was most likely meant per second.
    per_second = unit + "/s"
    return (
        [per_second] if per_second in UNITS[kind] else [unit.split("/")[0]] if unit.split("/")[0] in UNITS[kind] else []
    )


def _number(case: _Case) -> Finding | None:
    if "NUMBER" not in case.accepts:
        return None
    bad = case.bad
    if case.first == "repeat" and case.index == 1:
        what = f'"{_short(bad.text)}" is not a count' if bad.text else "how often is missing"
        return _at(bad, "E207", what, "a positive whole number, such as: repeat 3 { ... }")
    if bad.kind == "number":
        plain = bad.text.replace(",", ".").replace("_", "")
        cure = (Edit(bad.start, bad.end, plain),) if plain.count(".") <= 1 else ()
        return _at(bad, "E106", f'"{_short(bad.text)}" is not a number', "numbers look like 6, 0.5 or 1e-3", *cure)
    what = f'a number is needed, not "{_short(bad.text)}"' if bad.text else "a number is missing here"
    cures = (Edit(bad.start, bad.end, "1"),) if case.first == "cue" else ()
    return _at(bad, "E106", what, "numbers look like 6, 0.5 or 1e-3, each with its unit", *cures)


def _character(case: _Case) -> Finding | None:
    bad = case.bad
    if bad.kind != "other":
        return None
    code = f"U+{ord(bad.text):04X}"
    shown = f'"{bad.text}" ({code})' if bad.text.isprintable() else code
    return _at(bad, "E105", f"the character {shown} has no meaning here", "take it away", Edit(bad.start, bad.end, ""))


def _opening(case: _Case) -> Finding | None:
    bad = case.bad
    if case.index or "LBRACE" in case.accepts:
        return None
    if bad.kind == "end":
        return Finding("E101", case.at, case.at + 1, "a block needs a word before it", _examples(case.where))
    known = VOCABULARY[case.where]
    if case.where == "set":
        close = nearest(bad.text, known)
        cures = [Edit(bad.start, bad.end, close)] if close else []
        return _at(bad, "E216", f'"{_short(bad.text)}" is not a setting', f"settings are: {', '.join(known)}", *cures)
    close = nearest(bad.text, known)
    cures = [Edit(bad.start, bad.end, close)] if close else []
    home = _home(bad.text)
    what = f'"{_short(bad.text)}" {"belongs " + home if home else "is not understood"}'
    return _at(bad, "E101", what, _examples(case.where), *cures)


def _home(word: str) -> str:
    if word in VOCABULARY["icon"]:
        return "inside the braces of an icon"
    if word in VOCABULARY["set"]:
        return "inside the braces of the set"
    return "outside of every block" if word in VOCABULARY["file"] else ""


def _block(case: _Case) -> Finding | None:
    if "LBRACE" not in case.accepts:
        return None
    bad = case.bad
    last = case.pieces[-1] if case.pieces else bad
    if bad.kind == "end" or bad.text in VOCABULARY["icon"] or bad.text in VOCABULARY["set"]:
        here = case.before or last
        cure = Edit(here.end, here.end, " {")
        return Finding(
            "E114", here.start, here.end, 'no "{" opens the block after this', 'statements stand in "{ ... }"', (cure,)
        )
    if case.first == "repeat":
        return _at(bad, "E114", 'a "{" is needed here', "for example: repeat 3 { ... }", Edit(bad.start, bad.end, ""))
    texted = any(piece.kind == "text" for piece in case.pieces[case.index + 1 :][:1])
    if bad.kind == "word" and case.index == 2 and case.first == "icon" and not texted:
        name = Edit(case.pieces[1].end, bad.end, "-" + bad.text)
        return _at(bad, "E113", "a name has no blanks in it", "join its parts with hyphens", name)
    if bad.kind == "word" and "KEY" in case.accepts and (close := nearest(bad.text, VOCABULARY["header"])):
        return _at(bad, "E101", f'"{bad.text}" is not a key', _keys(), Edit(bad.start, bad.end, close))
    return _at(bad, "E101", f'"{_short(bad.text)}" does not fit here', _keys())


def _name(case: _Case) -> Finding | None:
    if "NAME" not in case.accepts:
        return None
    bad = case.bad
    plain = "".join(char if char.isalnum() else "-" for char in bad.text.strip('"')).strip("-")
    plain = plain if plain[:1].isalpha() else f"{case.first}-{plain}" if plain else ""
    help = "a name has letters, digits and hyphens and begins with a letter, such as cooling-step"
    if bad.kind == "end" or not plain:
        return _at(bad, "E113", f'a name is missing after "{case.first}"', help)
    return _at(bad, "E113", f'"{_short(bad.text)}" is not a name', help, Edit(bad.start, bad.end, plain))


def _extra(case: _Case) -> Finding | None:
    bad, before = case.bad, case.before
    if "_NEWLINE" not in case.accepts or before is None or bad.kind == "end":
        return None
    if case.first in ("site", "control"):
        what = f'"{_short(bad.text)}" is too much: {case.first} takes one name'
        return _at(
            bad, "E108", what, "a name has no blanks; join its parts with hyphens", Edit(before.end, bad.start, "-")
        )
    if bad.text in VOCABULARY[case.where]:
        cures: tuple[Edit, ...] = (Edit(before.end, before.end, ";"),)
        return _at(bad, "E108", "a second statement begins here", 'put ";" or a new line between them', *cures)
    cures = (Edit(before.end, case.pieces[-1].end, ""),)
    return _at(bad, "E108", f'the statement is complete before "{_short(bad.text)}"', "one statement a line", *cures)


def _pace(case: _Case) -> Finding | None:
    if not case.accepts & {"AT", "OVER"}:
        return None
    bad, pieces = case.bad, case.pieces
    unit = "A/s" if "A" in "".join(piece.text for piece in pieces[-1:]) else "°C/s"
    rate = f"at {3 if unit == '°C/s' else 1} {unit}"
    help = f'how fast, such as "{rate}", or how long, such as "over 2 s"'
    if bad.kind == "end":
        cure = Edit(bad.end, bad.end, f" {rate}")
        return Finding("E107", pieces[0].start, bad.end, "how fast, or over what time, is not said", help, (cure,))
    cures = []
    if bad.kind == "number":
        cures = [Edit(bad.start, bad.start, "at "), Edit(bad.start, bad.start, "over ")]
    elif bad.kind == "word":
        alias = {"in": "over", "during": "over", "for": "over", "within": "over", "with": "at", "@": "at"}
        close = alias.get(bad.text) or nearest(bad.text, ("at", "over"))
        cures = [Edit(bad.start, bad.end, close)] if close else [Edit(bad.start, pieces[-1].end, rate)]
    return _at(bad, "E107", f'"at" or "over" is needed, not "{_short(bad.text)}"', help, *cures)


def _connective(case: _Case) -> Finding | None:
    words = [word for terminal, word in _CONNECTIVES.items() if terminal in case.accepts]
    if not words or not case.index:
        return None
    bad = case.bad
    either = " or ".join(f'"{word}"' for word in words)
    help = EXAMPLES.get(case.first, "")
    if bad.kind == "end":
        cures = [Edit(bad.end, bad.end, f" {_TAILS[case.first]}")] if case.first in _TAILS else []
        return Finding("E116", case.pieces[0].start, bad.end, f"{either} is missing", help, tuple(cures))
    cures = []
    if bad.kind == "number":
        cures = [Edit(bad.start, bad.start, f"{word} ") for word in words]
    elif bad.kind == "word":
        cures = [Edit(bad.start, bad.end, close)] if (close := nearest(bad.text, words)) else []
        cures += [Edit(bad.start, bad.end, word) for word in words]
    return _at(bad, "E116", f'{either} is needed, not "{_short(bad.text)}"', help, *cures)


def _at(piece: Piece, code: str, what: str, help: str = "", *cures: Edit) -> Finding:
    return Finding(code, piece.start, max(piece.end, piece.start + 1), what, help, cures)


def _examples(where: str) -> str:
    if where == "file":
        return 'a file holds "cue 1", at most one set, and icons: icon my-icon { ... }'
    return "statements begin with: " + ", ".join(VOCABULARY[where])


def _keys() -> str:
    return f'after the name stand {", ".join(VOCABULARY["header"])}, each with a text, then "{{"'


def _short(text: str) -> str:
    return text if len(text) <= 30 else text[:29] + "…"
