"""Diagnosis of words that are wrong or missing in a statement or surplus behind it."""

import math
import re

from ..model.units import UNITS, decimal_text, exact_number
from ..model.words import EXAMPLES, JOINERS, LACKING, STARTS, VOCABULARY, WAVES, nearest, unit_kinds
from .failed_statement import FailedStatement, at, either, short, swap
from .source import Finding, Patch

_CONNECTIVES = {"AT": "at", "OVER": "over", "BY": "by", "TO": "to", "FOR": "for", "EVERY": "every"}
_TAKES = {"at": "rate", "by": "difference", "to": "absolute"}
"""Kinds of quantity behind a connective; behind the others there is a time."""
_PEAKS = re.compile(r"(peak[ -]to[ -]peak|pp|p-p|pk-pk)(?!\S)", re.IGNORECASE)
_PACE_ALIASES = {"in": "over", "during": "over", "for": "over", "within": "over", "with": "at", "@": "at"}
_TAILS = {"hold": "for 1 s", "rest": "for 1 s", "pulse": "for 500 ms"}


def word(case: FailedStatement) -> Finding | None:
    """A word missing that is one of two: most or least, warm or cool, up or down."""
    bad = case.bad
    if "MOST" in case.accepts:
        words, help = ["most", "least"], EXAMPLES["total"]
        close = nearest(bad.text, words)
        cures = [swap(bad, close)] if close else [Patch(case.pieces[1].start, bad.start, "")]
    elif "START" in case.accepts:
        ampere = any("current" in unit_kinds(piece.text) for piece in case.pieces[2:5])
        words, help = ["up", "down"] if ampere else ["warm", "cool"], "a wave starts upwards or downwards"
        meant = STARTS.get(bad.text.casefold())
        cures = [swap(bad, words[meant == "cool"])] if meant else []
    else:
        return None
    if bad.kind == "end":
        cure = Patch(bad.end, bad.end, f" {words[0]}")
        return Finding("E116", case.pieces[0].start, bad.end, f"{either(words)} is missing", help, (cure,))
    return at(bad, "E116", f'{either(words)} is needed, not "{short(bad.text)}"', help, *cures)


def joined(case: FailedStatement) -> Finding | None:
    """``and``, ``then`` or a comma between two statements."""
    bad, before = case.bad, case.before
    if "_NEWLINE" not in case.accepts or before is None or bad.text not in JOINERS:
        return None
    behind = _statement_behind(case)
    if behind is None or case.where not in ("icon", "repeat"):
        return None
    cure = Patch(before.end, behind, "; ")
    return at(bad, "E108", f'"{bad.text}" joins no statements', 'put ";" or a new line between them', cure)


def _statement_behind(case: FailedStatement) -> int | None:
    for piece in case.pieces[case.index :]:
        if piece.text in VOCABULARY[case.where]:
            return piece.start
        if piece.text not in JOINERS:
            return None
    return None


def _two_times(case: FailedStatement) -> Finding | None:
    """``1 min 30 s``: a time in two parts."""
    place = case.index + (case.bad.text in JOINERS)
    first, second = case.quantity(case.index - 2), case.quantity(place)
    times = UNITS["time"]
    if case.index < 3 or first is None or second is None:
        return None
    if times.get(first[1], 0) <= times.get(second[1], 10**6):
        return None
    begin, end = case.pieces[case.index - 2], case.pieces[place + 1]
    try:
        value = sum(exact_number(case.pieces[n].text) * times[case.pieces[n + 1].text] for n in (case.index - 2, place))
    except ValueError:
        return None
    cure = Patch(begin.start, end.end, f"{decimal_text(float(value / times[second[1]]))} {second[1]}")
    return Finding("E108", begin.start, end.end, "a time is one number with one unit", EXAMPLES["time"], (cure,))


def extra(case: FailedStatement) -> Finding | None:
    """Something behind a statement that is complete."""
    bad, before = case.bad, case.before
    if "_NEWLINE" not in case.accepts or before is None or bad.kind == "end":
        return None
    if case.first in ("site", "control"):
        what = f'"{short(bad.text)}" is too much: {case.first} takes one name'
        help = "a name must not contain spaces; join its parts with hyphens"
        return at(bad, "E108", what, help, Patch(before.end, bad.start, "-"))
    own = {"play": _behind_play, "step": _behind_step, **dict.fromkeys(WAVES, _behind_wave)}.get(case.first)
    if own is not None and (found := own(case)):
        return found
    if bad.text in VOCABULARY[case.where]:
        cure = Patch(before.end, before.end, ";")
        return at(bad, "E108", "a second statement begins here", 'put ";" or a new line between them', cure)
    if found := _two_times(case):
        return found
    help = "one statement per line"
    twice = bad.text in ("at", "over") and (case.find("at") or case.find("over") or case.index) < case.index
    if twice:
        help = 'either "at" a rate or "over" a time: one follows from the other'
    # A suggestion leaves nothing out that was meant.
    rest = case.pieces[case.index :]
    kept = False
    if twice and len(rest) == 3:  # rate and time may say the same: 6 °C at 3 °C/s over 2 s
        by, pace, over = (case.quantity((case.find(word) or 0) + 1) for word in ("by", "at", "over"))
        if by and pace and over and f"{by[1]}/{over[1]}" == pace[1]:
            kept = math.isclose(abs(by[0]), pace[0] * over[0])
    cures = (Patch(before.end, case.pieces[-1].end, ""),) if kept or case.idle(rest) else ()
    if bad.text == "for" and case.first in ("cool", "warm", "change", "to", "return"):
        cures = (Patch(before.end, bad.start, "; hold "),)
    return at(bad, "E108", f'the statement is complete before "{short(bad.text)}"', help, *cures)


def _behind_play(case: FailedStatement) -> Finding | None:
    bad, name = case.bad, case.pieces[1]
    if bad.text in VOCABULARY[case.where]:
        return None
    if bad.kind == "word":
        joined = Patch(name.end, bad.end, "-" + bad.text)
        return at(bad, "E113", "a name must not contain spaces", "join its parts with hyphens", joined)
    count = Patch(case.pieces[0].start, case.pieces[-1].end, f"repeat {bad.text} {{ play {name.text} }}")
    cures = (count,) if bad.kind == "number" else ()
    help = f"to play it several times: repeat 3 {{ play {short(name.text)} }}"
    return at(bad, "E108", f'the statement is complete before "{short(bad.text)}"', help, *cures)


def _behind_step(case: FailedStatement) -> Finding | None:
    first, second = case.pieces[:2]
    pace = case.bad.text in ("at", "over")
    if not pace and case.bad.text != "for":
        return None
    headed = second.text in ("warm", "cool")
    change = Patch(first.start, second.start, "") if headed else swap(first, "change")
    what = f'a step is as fast as the driver can: it takes no "{case.bad.text}"'
    help = 'with a rate or a time, write "change"; with a step back after it, write "pulse"'
    return at(case.bad, "E108", what, help, change if pace else swap(first, "pulse"))


def _behind_wave(case: FailedStatement) -> Finding | None:
    bad, last = case.bad, case.pieces[-1]
    if bad.text == "starting" and case.find("cut") == case.index - 1:
        behind = case.text_from(case.index)
        cure = Patch(case.pieces[case.index - 1].start, last.end, f"{behind} cut")
        return at(bad, "E214", '"starting" comes before "cut"', EXAMPLES["sine"], cure)
    if bad.kind != "word" or "CUT" not in case.accepts or (bad.text in VOCABULARY[case.where] and case.next()):
        return None
    if bad.text.casefold() in STARTS and "STARTING" in case.accepts:
        cure = Patch(bad.start, bad.start, "starting ")
        return at(bad, "E116", f'"starting" is missing before "{bad.text}"', "a wave starts upwards or downwards", cure)
    if close := nearest(bad.text, ("starting", "cut")):
        help = 'a wave may end with "starting warm" or "starting cool", and with "cut"'
        return at(bad, "E116", f'"starting" or "cut" is expected here, not "{short(bad.text)}"', help, swap(bad, close))
    return None


def pace(case: FailedStatement) -> Finding | None:
    """No rate and no time where one of them belongs."""
    if not case.accepts & {"AT", "OVER"}:
        return None
    bad, pieces = case.bad, case.pieces
    unit = "A/s" if "A" in "".join(piece.text for piece in pieces[-1:]) else "°C/s"
    rate = f"at {3 if unit == '°C/s' else 1} {unit}"
    help = f'how fast, such as "{rate}", or how long, such as "over 2 s"'
    if bad.kind == "end":
        cure = Patch(bad.end, bad.end, f" {rate}")
        return Finding("E107", pieces[0].start, bad.end, "the rate or the time is missing", help, (cure,))
    cures = []
    if bad.kind == "number":
        cures = [Patch(bad.start, bad.start, "at "), Patch(bad.start, bad.start, "over ")]
    elif bad.kind == "word":
        close = _PACE_ALIASES.get(bad.text) or nearest(bad.text, ("at", "over"))
        if close and bad.text != "every":
            cures = [swap(bad, close)]
        elif (behind := _statement_behind(case)) is not None:
            cures = [Patch(bad.start, behind, f"{rate}; ")]
        elif case.idle(pieces[case.index :]):
            cures = [Patch(bad.start, pieces[-1].end, rate)]
    return at(bad, "E107", f'"at" or "over" is needed, not "{short(bad.text)}"', help, *cures)


def unit_twice(case: FailedStatement) -> Finding | None:
    """A unit behind a parameter, which has one already."""
    bad, before = case.bad, case.before
    if before is None or before.text not in (case.names or ()) or case.index < 2 or not unit_kinds(bad.text):
        return None
    what = f'"{before.text}" has its unit already'
    return at(bad, "E104", what, "the unit of a parameter is in the header, after its values", swap(bad, ""))


def peaks(case: FailedStatement) -> Finding | None:
    """An amplitude that is given from peak to peak."""
    size, found = case.quantity(case.index - 2), _PEAKS.match(case.text_from(case.index))
    if case.index < 4 or "EVERY" not in case.accepts or found is None or not size or abs(size[0]) > 1e9:
        return None
    begin, end = case.pieces[case.index - 2], case.pieces[case.index + found[0].count(" ")]
    cure = Patch(begin.start, end.end, f"{decimal_text(size[0] / 2.0)} {size[1]}")
    said = "the size of a wave is its amplitude", LACKING["peak-to-peak"]
    return Finding("E116", case.bad.start, end.end, *said, (cure,))


def connective(case: FailedStatement) -> Finding | None:
    """Another word, or none, where a connective belongs."""
    words = [text for terminal, text in _CONNECTIVES.items() if terminal in case.accepts]
    if not words or not case.index:
        return None
    bad = case.bad
    help = EXAMPLES.get(case.first, "")
    if bad.kind == "end":
        tail = _tail(case)
        cures = [Patch(bad.end, bad.end, f" {tail}")] if tail else []
        return Finding("E116", case.pieces[0].start, bad.end, f"{either(words)} is missing", help, tuple(cures))
    return at(bad, "E116", f'{either(words)} is needed, not "{short(bad.text)}"', help, *_joined(case, words))


def _tail(case: FailedStatement) -> str:
    if case.first in WAVES and case.index > 2:
        period = case.quantity(5) if "FOR" in case.accepts else None
        if period:
            return f"for {3 * period[0]:.6g} {period[1]}"
        return "every 4 s for 12 s" if "EVERY" in case.accepts else ""
    return _TAILS.get(case.first, "") if "FOR" in case.accepts else ""


def _joined(case: FailedStatement, words: list[str]) -> list[Patch]:
    bad = case.bad
    cures = []
    if "EVERY" in case.accepts and bad.text == "for" and (time := case.quantity(case.index + 1)):
        cures.append(Patch(bad.start, bad.start, f"every {time[0] / 4:.6g} {time[1]} "))
    if bad.text in ("warm", "cool") and case.first == "change":
        cures.append(Patch(case.pieces[0].start, bad.start, ""))
    if bad.text in ("warm", "cool") and case.first in WAVES:
        cures.append(Patch(bad.start, case.pieces[-1].end, f"{case.text_from(case.index + 1)} starting {bad.text}"))
    if "DIRECTION" in case.accepts and (meant := STARTS.get(bad.text.casefold())):
        cures.append(swap(bad, meant))
    later = next((piece for piece in case.rest if piece.text in words), None)
    between = [piece for piece in case.rest if later is not None and piece.start < later.start]
    # Where a change begins need not be said; any other number must not get lost.
    if later is not None and (bad.text == "from" or case.idle([bad, *between])):
        cures.append(Patch(bad.start, later.start, ""))
    quantity = case.quantity(case.index + (bad.kind != "number"))
    kinds = set(unit_kinds(quantity[1])) if quantity else set()
    words = [text for text in words if not kinds or kinds & {_TAKES.get(text, "time"), "current", "current_rate"}]
    words = ["to"] if bad.text == "at" and "to" in words else words
    if bad.kind == "number":
        cures += [Patch(bad.start, bad.start, f"{text} ") for text in words]
    elif bad.kind == "word":
        cures += [swap(bad, close)] if (close := nearest(bad.text, words)) else []
        if bad.text in ("at", "over", *_PACE_ALIASES) or case.idle([bad]):
            cures += [swap(bad, text) for text in words]
    return cures
