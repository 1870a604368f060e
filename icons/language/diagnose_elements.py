"""Diagnosis of names of display elements, and of the blocks that address them."""

from ..model.words import CLAUSES, EXAMPLES, FILLERS, JOINERS, VOCABULARY
from .failed_statement import FailedStatement, at, short, swap
from .source import Finding, Patch

_HEADS = ("on", "along", "together", "elements")
_JOINERS = (*JOINERS, ".", "+", "/", "|")
_NO_NAMES = FILLERS | {"element", "elements", "only"}


def elements(case: FailedStatement) -> Finding | None:
    """Names that are missing or not parted by commas, and what stands where the block of a statement begins."""
    bad, before = case.bad, case.before
    if case.first not in _HEADS or before is None or not case.accepts & {"COMMA", "NAME", "LBRACE", "EVERY"}:
        return None
    help = EXAMPLES[case.first]
    if case.first == "together":
        return at(bad, "E114", 'a "{" is needed here: "together" names no elements itself', help)
    if "NAME" in case.accepts:
        return _missing(case, help)
    if bad.text in VOCABULARY["icon"] and bad.text not in CLAUSES and "LBRACE" in case.accepts:
        return at(bad, "E114", 'a "{" is needed here', help, Patch(before.end, before.end, " {"))
    joined = bad.text in _JOINERS or (bad.kind == "word" and bad.text not in CLAUSES)
    if before.text == "all" and joined:
        return at(bad, "E108", '"all" means every element, and stands alone', help)
    if before.text.casefold() in _NO_NAMES and bad.kind == "word":
        return at(before, "E108", f'"{before.text}" names no element', help, Patch(before.start, bad.start, ""))
    if bad.text in _JOINERS and case.rest[:1] and case.rest[0].kind == "word":
        comma = Patch(before.end, case.rest[0].start, ", ")
        return at(bad, "E108", f'names have a comma between them, not "{bad.text}"', help, comma)
    if bad.kind == "word" and bad.text not in CLAUSES:
        comma = Patch(before.end, bad.start, ", ")
        return at(bad, "E116", f'there is no comma before "{short(bad.text)}"', help, comma)
    if case.first == "along" and bad.kind == "end":
        return at(before, "E116", '"every" is missing', help, Patch(before.end, before.end, " every 300 ms"))
    if case.first == "on" and bad.kind in ("word", "number"):
        return at(bad, "E108", 'nothing but names of elements stands before the "{"', help)
    return None


def _missing(case: FailedStatement, help: str) -> Finding | None:
    """No name where one belongs."""
    bad, before = case.bad, case.before
    assert before is not None
    if bad.kind == "number":
        return at(bad, "E113", f'"{short(bad.text)}" is not the name of an element', help)
    if bad.kind != "end":
        return None
    if before.text == ",":
        return at(before, "E113", "an element is missing behind the comma", help, swap(before, ""))
    cures = (Patch(before.end, before.end, " all"),) if "ALL" in case.accepts else ()
    return at(before, "E113", f'an element is missing after "{short(before.text)}"', help, *cures)
