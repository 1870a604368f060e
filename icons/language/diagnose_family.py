"""Diagnosis of a family's parentheses."""

from ..model.units import UNITS
from ..model.words import VOCABULARY, nearest_unit
from .failed_statement import FailedStatement, at, short, signed, swap
from .source import Finding, Patch, Piece

_ALL_UNITS = tuple(dict.fromkeys(unit for units in UNITS.values() for unit in units if unit))
_HELP = 'values are a list, "amount in [-3, 3] °C", or a range, "amount in 1..3 step 0.5 °C"'
_NAME_HELP = "a parameter is called after what varies, such as: amount, rate, pause"
_NO_COMMA = "a unit comes right after its values, without a comma"
THREE_DOTS = "a range has two dots between its ends, not three"
_OPENERS, _CLOSERS = ("[", "{", "<"), ("]", "}", ">")


def family(case: FailedStatement) -> Finding | None:
    """Faults between the parentheses of a family, or around them."""
    bad = case.bad
    if not case.listing:
        if case.first != "icon" or "LBRACE" not in case.accepts or bad.text not in ("(", *_OPENERS):
            return None
        if "LPAR" in case.accepts:
            what = f'parameters are written in "( ... )", not in "{bad.text}"'
            return at(bad, "E118", what, _HELP, swap(bad, "("))
        return at(bad, "E118", "parameters come directly after the name of the icon", 'icon x(...) means "..." {')
    if bad.kind == "newline":
        here = case.before or bad
        return at(here, "E118", "a parameter is on one line", "break the line after a comma")
    for terminal, rule in _RULES.items():
        if terminal in case.accepts:
            return rule(case)
    return at(bad, "E118", f'"{short(bad.text)}" does not fit here', _HELP)


def _name(case: FailedStatement) -> Finding:
    bad, before = case.bad, case.before
    if bad.text in _ALL_UNITS and before is not None and before.text == ",":
        return at(bad, "E118", _NO_COMMA, _HELP, Patch(before.start, bad.end, " " + bad.text))
    if bad.text == ")" and before is not None:
        what = "there is no parameter between the parentheses" if before.text == "(" else "no parameter follows"
        return at(bad, "E118", what, _HELP, Patch(before.start, bad.end, "" if before.text == "(" else ")"))
    if bad.text == "," and before is not None:
        return at(bad, "E118", "there is a comma too many", _HELP, Patch(before.end, bad.end, ""))
    if bad.kind == "end" or bad.text == "in":
        return at(bad, "E113", "the name of a parameter is missing here", _NAME_HELP)
    plain = "".join(char if char.isalnum() else "-" for char in bad.text).strip("-")
    cures = (swap(bad, plain),) if plain[:1].isalpha() else ()
    return at(bad, "E113", f'"{short(bad.text)}" is not a name', _NAME_HELP, *cures)


def _in(case: FailedStatement) -> Finding:
    bad, before = case.bad, case.before
    if before is not None and before.text == "in":
        return at(before, "E113", "the name of a parameter is missing here", _NAME_HELP)
    if before is not None and before.text in _ALL_UNITS and bad.text in (")", ",", ""):
        cure = Patch(case.pieces[case.index - 2].start, before.end, " " + before.text)
        return at(before, "E118", _NO_COMMA, _HELP, cure)
    if bad.kind == "word" and before is not None:
        if case.next() == "in":
            joined = Patch(before.end, bad.end, "-" + bad.text)
            return at(bad, "E113", "a name must not contain spaces", "join its parts with hyphens", joined)
        return at(bad, "E118", f'"in" is needed, not "{short(bad.text)}"', _HELP, swap(bad, "in"))
    if bad.text in ("=", ":", "∈"):
        touching = before is not None and before.end == bad.start
        return at(bad, "E118", f'"in" is needed, not "{bad.text}"', _HELP, swap(bad, " in" if touching else "in"))
    what = '"in" is missing before the values' if bad.kind == "number" or bad.text in "[({" else "values are missing"
    cures = (Patch(bad.start, bad.start, "in "),) if bad.text else ()
    return at(bad, "E118", what, _HELP, *cures)


def _values(case: FailedStatement) -> Finding:
    """Neither a list nor a range begins behind "in"."""
    bad = case.bad
    if found := signed(case):
        return found
    if bad.text in ("(", "{", "<"):
        numbers = _run(case, case.index + 1)
        cures = [Patch(bad.start, numbers[-1].end, f"[{_listed(numbers)}]")] if numbers else []
        close = case.index + 1 + len(numbers)
        if cures and close < len(case.pieces) and case.pieces[close].text in (")", *_CLOSERS):
            cures = [Patch(bad.start, case.pieces[close].end, f"[{_listed(numbers)}]")]
        return at(bad, "E118", f'a list of values is written in "[ ... ]", not in "{bad.text}"', _HELP, *cures)
    what = (
        "the values are missing" if bad.text in (")", ",", "") else f'"{short(bad.text)}" is neither a list nor a range'
    )
    return at(bad, "E118", what, _HELP)


def _dots(case: FailedStatement) -> Finding:
    """A number behind "in" and no ".." behind it: a list without brackets, or a range with another sign."""
    bad, before = case.bad, case.before
    numbers = _run(case, case.index - 1)
    if bad.text in ("to", "…", "-", "–", "until", ":") and case.rest and case.rest[0].kind == "number":
        start = before.end if before is not None else bad.start
        cure = Patch(start, case.rest[0].start, "..")
        return at(bad, "E118", f'a range has ".." between its ends, not "{bad.text}"', _HELP, cure)
    if before is None or not numbers:
        return at(bad, "E118", "a list of values has brackets", _HELP)
    whole = Piece("number", "", before.start, numbers[-1].end)
    return at(whole, "E118", "a list of values has brackets", _HELP, swap(whole, f"[{_listed(numbers)}]"))


def _step(case: FailedStatement) -> Finding:
    bad = case.bad
    if bad.text in ("by", "every", "steps", "in", "..", ":", ",") and case.rest and case.rest[0].kind == "number":
        padded = "step" if bad.kind == "word" else " step "
        return at(bad, "E118", f'"step" is needed, not "{bad.text}"', _HELP, swap(bad, padded))
    low, high = (case.pieces[place] for place in (case.index - 3, case.index - 1))
    if high.text.startswith("."):
        return at(Piece("mark", "", low.end, high.start + 1), "E118", THREE_DOTS, _HELP)
    whole = Piece("number", "", low.start, high.end)
    try:
        size = float(high.text.replace("−", "-")) - float(low.text.replace("−", "-"))
    except ValueError:
        size = 0.0
    step = "1" if size == int(size) else f"{size:.6g}"
    cures = (Patch(high.end, high.end, f" step {step}"),) if size > 0 else ()
    return at(whole, "E118", 'this range has no "step"', _HELP, *cures)


def _more(case: FailedStatement) -> Finding:
    """Within a list, behind one of its numbers."""
    bad = case.bad
    first = max(place for place in range(case.index) if case.pieces[place].text == "[")
    if bad.text in _ALL_UNITS and any(piece.text == "]" for piece in case.rest):
        return _unit_inside(case, first)
    if bad.text == "..":
        dots = THREE_DOTS if case.next().startswith(".") else 'a range has no brackets: "1..3 step 0.5 °C"'
        return at(bad, "E118", dots, _HELP)
    numbers = _run(case, first + 1)
    whole = Patch(case.pieces[first].start, numbers[-1].end, f"[{_listed(numbers)}")
    if bad.kind == "number":
        return at(bad, "E118", "a comma is missing between these values", _HELP, whole)
    before = case.pieces[case.index - 1]
    if bad.text in (")", *_CLOSERS):
        # ")" closes the list by mistake, or the list is open and ")" closes the parentheses.
        cures = [swap(bad, "]"), Patch(before.end, before.end, "]")][: 2 if bad.text == ")" else 1]
        return at(bad, "E118", f'a list ends with "]", not with "{bad.text}"', _HELP, *cures)
    what = f'"]" is missing before "{short(bad.text)}"' if bad.text else '"]" is missing here'
    return at(bad, "E118", what, _HELP, Patch(before.end, before.end, "]"))


def _unit_inside(case: FailedStatement, first: int) -> Finding:
    bad = case.bad
    close = next(n for n in range(case.index, len(case.pieces)) if case.pieces[n].text == "]")
    inside = case.pieces[first + 1 : close]
    units = {piece.text for piece in inside if piece.text in _ALL_UNITS}
    behind = close + 1 < len(case.pieces) and case.pieces[close + 1].text in units
    text = f"[{_listed(inside)}]" + ("" if behind else f" {bad.text}")
    cures = (Patch(case.pieces[first].start, case.pieces[close].end, text),) if len(units) == 1 else ()
    return at(bad, "E118", "the unit comes once, after the list", "for example: amount in [1, 2] °C", *cures)


def _number(case: FailedStatement) -> Finding:
    bad, before = case.bad, case.before
    if bad.text == "]" and before is not None:
        if before.text == "[":
            return at(bad, "E118", "this list is empty", _HELP)
        return at(bad, "E118", "a value is missing after the comma", _HELP, Patch(before.start, bad.start, ""))
    if found := signed(case):
        return found
    what = f'a number is needed, not "{short(bad.text)}"' if bad.text else "a number is missing here"
    return at(bad, "E106", what, "numbers look like 6, 0.5 or 1e-3; the unit comes once, after them")


def _end(case: FailedStatement) -> Finding:
    """Behind the values of a parameter: its unit, a comma or the closing parenthesis."""
    bad, before = case.bad, case.before
    end = before.end if before is not None else bad.start
    if bad.kind == "word" and case.next() in ("in", "=") and case.index + 1 < len(case.pieces):
        return at(bad, "E118", "a comma is missing before this parameter", _HELP, Patch(end, end, ","))
    if "UNIT" in case.accepts and bad.kind in ("word", "other") and bad.text not in _OPENERS + _CLOSERS:
        kinds = [close for kind in UNITS if kind != "count" and (close := nearest_unit(bad.text, kind))]
        cures = tuple(swap(bad, close) for close in dict.fromkeys(kinds))
        help = f"units are: {', '.join(_ALL_UNITS)}; values without one are counts"
        return at(bad, "E103", f'"{short(bad.text)}" is not a unit', help, *cures)
    if bad.text in _CLOSERS:
        return at(bad, "E118", f'the parameters end with ")", not with "{bad.text}"', _HELP, swap(bad, ")"))
    if bad.text == ",":
        return at(bad, "E118", "the comma belongs at the end of the line before", _HELP)
    what = f'")" or "," is needed, not "{short(bad.text)}"' if bad.text else '")" is missing after the parameters'
    separate = ((swap(bad, ","),) if bad.text in (";", "and") else ()) + (Patch(end, end, ")"),)
    here = bad
    if not bad.text or bad.text in VOCABULARY["header"] or bad.text in VOCABULARY["icon"]:
        what, here = '")" is missing after the parameters', Piece("end", "", max(0, end - 1), end)
    return at(here, "E118", what, _HELP, *separate)


def _run(case: FailedStatement, start: int) -> list[Piece]:
    found: list[Piece] = []
    for piece in case.pieces[start:]:
        if piece.kind != "number" and piece.text != ",":
            break
        found.append(piece)
    while found and found[-1].text == ",":
        found.pop()
    return found


def _listed(pieces: list[Piece]) -> str:
    return ", ".join(piece.text for piece in pieces if piece.kind == "number")


# By a terminal that the grammar could take; the first that fits decides, so the order matters.
_RULES = {
    "IN": _in,
    "LSQB": _values,
    "_DOTS": _dots,
    "STEP": _step,
    "RSQB": _more,
    "RPAR": _end,
    "NAME": _name,
    "NUMBER": _number,
}
