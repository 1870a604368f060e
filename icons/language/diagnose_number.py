"""Diagnosis of numbers with a wrong unit or without one."""

import re
from collections.abc import Container
from fractions import Fraction

from ..model.units import KIND_WORDS, UNITS, Kind, decimal_text
from ..model.words import (
    BOUNDS,
    DASHES,
    EXAMPLES,
    NUMBER_WORDS,
    WAVES,
    fahrenheit,
    nearest,
    nearest_unit,
    scaled,
    unit_kinds,
)
from .failed_statement import FailedStatement, at, short, signed, swap
from .source import Finding, Patch, Piece

_UNIT_KINDS: dict[str, Kind] = {kind.upper(): kind for kind in UNITS if kind not in ("change", "count")}
_CONNECTIVES = ("at", "over", "by", "to", "for", "every", "starting", "cut")
_WANTED = {
    **dict.fromkeys(("for", "over", "every", "total", "most", "least"), "time"),
    **{"at": "rate", "by": "difference", "to": "absolute"},
}
_OPERATORS = (":", "/", "*", "×", "·", "÷", "^", "+", *DASHES)
_DEGREES = ("°", "º", "˚", "deg", "degree", "degrees")
_FAHRENHEIT = re.compile(r"(?i)([°º˚]|deg)f(/(s|min))?|fahrenheit")
_PERIODS = ("period", "periods", "cycle", "cycles", "times", "oscillations")


def notation(case: FailedStatement) -> Finding | None:
    """Arithmetic, or the time of a clock, where one number belongs."""
    bad, before, names = case.bad, case.before, case.names or ()
    if case.listing or before is None or case.where not in ("icon", "repeat"):
        return None
    pieces, sign = [before, bad, *case.rest[:1]], bad.text
    if bad.kind == "number" and bad.text[:1] in ("+", "-", "−"):
        pieces, sign = [before, bad], bad.text[0]
    elif bad.text in names and case.next() in _OPERATORS:
        pieces, sign = [bad, *case.rest[:2]], case.next()
    elif bad.text not in _OPERATORS or len(pieces) < 3 or not _operand(pieces[2], names):
        return None
    if not _operand(pieces[0], names):
        return None
    text = "".join(piece.text for piece in pieces)
    what, help = "there is no arithmetic", "write the value itself, as one number"
    if sign == ":":
        what, help = "there is no clock notation", 'a time is one number with its unit, such as "90 s"'
    cures: tuple[Patch, ...] = ()
    over, under = pieces[0].text, pieces[-1].text
    if sign == "/" and len(pieces) == 3 and over.isdecimal() and under.isdecimal() and len(over + under) < 10:
        plain = decimal_text(int(over) / int(under)) if int(under) else ""
        if plain and Fraction(plain) == Fraction(int(over), int(under)):
            cures = (Patch(pieces[0].start, pieces[2].end, plain),)
    return Finding("E106", pieces[0].start, pieces[-1].end, f'"{short(text)}" is not a number: {what}', help, cures)


def _operand(piece: Piece, names: Container[str]) -> bool:
    return piece.kind == "number" or piece.text in names or piece.text == "("


def unit(case: FailedStatement) -> Finding | None:
    """A number without a unit, or with one that does not fit."""
    kinds = [kind for terminal, kind in _UNIT_KINDS.items() if terminal in case.accepts]
    number, bad = case.before, case.bad
    if not kinds or number is None:
        return None
    kind = kinds[0]
    if case.where in ("icon", "repeat") and case.first == "return":
        kind = "rate"
    if re.fullmatch(r"[0-9]{3}", bad.text) and re.fullmatch(r"[+\-−]?[0-9]{1,3}", number.text):
        what = f'there is a space within the number "{number.text} {bad.text}"'
        cure = Patch(number.end, bad.start, "")
        return Finding("E106", number.start, bad.end, what, "write digits without spaces between them", (cure,))
    if bad.kind not in ("word", "other") or bad.text in _CONNECTIVES:
        cure = Patch(number.end, number.end, " " + next(iter(UNITS[kind])))
        shared = bad.kind == "number" and case.next() in UNITS[kind]  # two numbers, one unit: which was meant?
        return at(number, "E102", "this number has no unit", EXAMPLES[kind], *(() if shared else (cure,)))
    if bad.text in (case.names or ()):
        help = "a parameter replaces number and unit; there is no arithmetic"
        return at(bad, "E103", f'"{short(bad.text)}" is a parameter, not a unit', help)
    if bad.text in ("%", "%/s"):
        return at(bad, "E103", f'"{bad.text}" is not a unit of this language', EXAMPLES[kind])
    others = [other for other in unit_kinds(bad.text) if other not in kinds]
    if case.first == "to" and kind == "current" and "absolute" in others:
        word = case.pieces[0]
        heads = tuple(Patch(word.start, word.start, text) for text in ("cool ", "warm "))
        help = 'temperatures take a direction: "cool to 26 °C at 3 °C/s"'
        return Finding("E209", word.start, word.end, '"to" alone moves a current', help, heads)
    if bad.text in _DEGREES and re.fullmatch(r"[Cc](/.*)?", case.next()):
        cure = Patch(bad.start, case.rest[0].end, "°C" + case.next()[1:])
        whole = Piece("word", f"{bad.text} {case.next()}", bad.start, case.rest[0].end)
        return at(
            whole, "E103", f'"{whole.text}" is not a unit', 'a unit must not contain spaces: "°C" or "degC"', cure
        )
    last = case.rest[0] if bad.text in _DEGREES and re.fullmatch(r"[Ff](/.*)?|fahrenheit", case.next()) else bad
    if last is not bad or _FAHRENHEIT.fullmatch(bad.text):
        size = fahrenheit(number.text, "".join(last.text.partition("/")[1:]), kind)
        converted = (Patch(number.start, last.end, size),) if size else ()
        return at(bad, "E103", "degrees Fahrenheit are not a unit of this language", EXAMPLES[kind], *converted)
    if others:
        return _wrong_kind(case, kind, others)
    if kind == "time" and (found := _periods(case)):
        return found
    if size := scaled(number.text, bad.text, kind):
        help = f"{KIND_WORDS[kind]} is in one of: {', '.join(UNITS[kind])}"
        cure = Patch(number.start, bad.end, size)
        return at(bad, "E103", f'"{short(bad.text)}" is not a unit', help, cure)
    close = nearest_unit(bad.text, kind)
    cures = [swap(bad, close)] if close else []
    known = ", ".join(UNITS[kind])
    return at(bad, "E103", f'"{short(bad.text)}" is not a unit', f"{KIND_WORDS[kind]} is in one of: {known}", *cures)


def _wrong_kind(case: FailedStatement, kind: Kind, others: list[Kind]) -> Finding:
    bad = case.bad
    if kind == "absolute" and bad.text == "K":
        kelvin = "K is for differences; an absolute temperature is in °C"
        return at(bad, "E104", kelvin, EXAMPLES[kind], swap(bad, "°C"))
    help = EXAMPLES[kind]
    if "current" in others and kind in ("difference", "absolute"):
        help += '; a current moves by "to 0.5 A at 1 A/s"'
    meaning = "a temperature" if "absolute" in others else KIND_WORDS[others[0]]
    what = f'"{bad.text}" makes it {meaning}; {KIND_WORDS[kind]} is needed'
    # "°C" where a rate belongs was most likely meant per second, and the other way round.
    if kind in ("rate", "current_rate") and case.next() in ("/", "per"):
        per = nearest_unit(case.next(2), "time") if case.next(2) else None
        whole = f"{bad.text}/{per}"
        cures = (Patch(bad.start, case.rest[1].end, whole),) if per and whole in UNITS[kind] else ()
        return at(bad, "E104", what, EXAMPLES[kind], *cures)
    similar = [text for text in (bad.text + "/s", bad.text.split("/")[0]) if text in UNITS[kind]]
    return at(bad, "E104", what, help, *(swap(bad, text) for text in similar[:1]))


def _periods(case: FailedStatement) -> Finding | None:
    """Hertz for a period, or a count of periods for a time: what people say of waves."""
    bad, number = case.bad, case.quantity(case.index - 1)
    if case.first not in WAVES or number is None or not 0 < number[0] < 1e9:
        return None
    if bad.text.casefold() in ("hz", "hertz"):
        cure = Patch(case.pieces[case.index - 1].start, bad.end, f"{1 / number[0]:.6g} s")
        return at(bad, "E103", f'"{bad.text}" is not a unit', "a wave has a period, such as: every 4 s", cure)
    every = case.find("every")
    period = case.quantity(every + 1) if every is not None else None
    if bad.text in _PERIODS and period is not None:
        cut = " cut" if number[0] % 1 and case.find("cut") is None else ""  # it does not end where it began
        cure = Patch(case.pieces[case.index - 1].start, bad.end, f"{number[0] * period[0]:.6g} {period[1]}{cut}")
        return at(bad, "E103", f'"{bad.text}" is not a unit', "a wave lasts a time, such as: for 12 s", cure)
    return None


def not_a_number(case: FailedStatement) -> Finding | None:
    """Something else where a number, or a parameter, belongs."""
    if "NUMBER" not in case.accepts:
        return None
    bad = case.bad
    if found := signed(case):
        return found
    meant = NUMBER_WORDS.get(bad.text.casefold())
    cures = [swap(bad, meant)] if meant else []
    if case.names and bad.kind == "word" and case.where in ("icon", "repeat") and bad.text not in case.names:
        close = nearest(bad.text, sorted(case.names)) or (min(case.names) if len(case.names) == 1 else None)
        cures = [swap(bad, close), *cures] if close else cures
        help = f"parameters of this icon are: {', '.join(sorted(case.names))}"
        return at(bad, "E226", f'"{short(bad.text)}" is not a parameter', help, *cures)
    if case.first == "repeat" and case.index == 1:
        what = f'"{short(bad.text)}" is not a count' if bad.text else "how often is missing"
        return at(bad, "E207", what, "a positive whole number, such as: repeat 3 { ... }", *cures)
    if case.first == "total" and (found := _bound(case)):
        return found
    if bad.text in ("-", "−", "+") and case.next() in (case.names or ()):
        help = "the values of a parameter carry the sign, such as: amount in [-3, 3] °C"
        return at(bad, "E105", "a parameter has no sign before it", help)
    if bad.kind == "number":
        if re.fullmatch(r"[+\-−]?[1-9][0-9]{0,2},[0-9]{3}", bad.text):
            what = f'"{bad.text}" may be {bad.text.replace(",", "")} or {bad.text.replace(",", ".")}'
            return at(bad, "E106", what, "the decimal mark is a point, and thousands are not separated")
        plain = bad.text.replace(",", ".").replace("_", "")
        cures = [swap(bad, plain)] if plain.count(".") <= 1 else []
        return at(bad, "E106", f'"{short(bad.text)}" is not a number', "numbers look like 6, 0.5 or 1e-3", *cures)
    what = f'a number is needed, not "{short(bad.text)}"' if bad.text else "a number is missing here"
    if case.first == "cue":
        cures = [swap(bad, "1")]
    elif case.rest and case.rest[0].kind == "number" and not cures and case.idle([bad]):
        cures = [Patch(bad.start, case.rest[0].start, "")]
    wanted = "current" if case.first == "to" and case.index == 1 else _WANTED.get(case.pieces[case.index - 1].text, "")
    help = EXAMPLES.get(wanted, "numbers look like 6, 0.5 or 1e-3, each with its unit")
    return at(bad, "E106", what, help, *cures)


def _bound(case: FailedStatement) -> Finding | None:
    """``total most 10 s``, ``total < 10 s``: a bound that is not said in the two words of the language."""
    bad, last = case.bad, case.bad
    text = bad.text
    if bad.text in "<>" and bad.text and case.next() == "=":
        text, last = text + "=", case.rest[0]
    meant = BOUNDS.get(text.casefold())
    if case.index != 1 or meant is None:
        return None
    what = f'"at" is missing before "{text}"' if text in ("most", "least") else f'"{text}" does not fit here'
    help = 'write "total 10 s", "total at most 10 s" or "total at least 10 s"'
    return Finding("E116", bad.start, last.end, what, help, (Patch(bad.start, last.end, meant),))
