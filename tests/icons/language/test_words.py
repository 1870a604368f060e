"""Words of the language, which editors colour, are those of the grammar."""

import re
from importlib import resources

from thermicon.icons.model.units import UNITS
from thermicon.icons.model.words import CLAUSES, VOCABULARY

GRAMMAR = resources.files("thermicon.icons").joinpath("grammar.lark").read_text(encoding="utf-8")
QUANTITY = re.compile(r"^[A-Z_]*(?:ABSOLUTE|DIFFERENCE|RATE|TIME|CURRENT): .*$", re.MULTILINE)


def test_words_and_units_are_those_of_the_grammar() -> None:
    code = re.sub(r"//[^\n]*", "", GRAMMAR)
    assert set(re.findall(r'"([a-z]+)"', QUANTITY.sub("", code))) == {*CLAUSES}.union(*VOCABULARY.values())
    units = re.findall(r'"([^"]+)"', " ".join(QUANTITY.findall(code)))
    assert set(units) == {unit for kind in UNITS.values() for unit in kind if unit}
