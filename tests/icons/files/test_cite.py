"""The methods paragraph about a set."""

import re
from pathlib import Path

import pytest

from tests.builders import missing
from thermicon.icons import IconSet, load_library, parse
from thermicon.icons.files.cite import YEAR, bibtex, cited, methods, references

ROOT = Path(__file__).parents[3]
# Every DOI that a page was seen to show; one that is added to the bibliography is added here with the page.
SEEN_DOIS = {
    "shani-lineykin-2023": "10.3390/bioengineering10101156",
    "shani-lineykin-2025": "10.3390/bioengineering12020209",
    "wilson-2013": "10.1007/978-3-642-41068-0_2",
    "wilson-2016": "10.1145/2858036.2858205",
}


def made(text: str) -> IconSet:
    return parse(f"cue 1; {text}")


def test_the_shipped_bibliography_loads_completely_and_says_where_each_entry_was_seen() -> None:
    assert {each["key"]: each["doi"] for each in references() if "doi" in each} == SEEN_DOIS, "no DOI is invented"
    text = (ROOT / "icons" / "data" / "references.bib").read_text(encoding="utf-8")
    assert len(references()) == text.count("@") == len({each["key"] for each in references()})
    rows = [f"{name} = {{{value}}}," for each in references() for name, value in list(each.items())[2:]]
    assert sorted(rows) == sorted(line.strip() for line in text.splitlines() if line.startswith("  "))
    for each in references():
        assert {"author", "title", "year", "seen"} <= set(each)
        assert each["type"] in ("article", "inproceedings", "book", "phdthesis", "misc")
        assert re.fullmatch(r"(19|20)\d\d", each["year"])
        unseen = ("general knowledge", "taken from", "from this project's cue sets")
        assert ("unverified" in each) == any(words in each["seen"] for words in unseen), each["key"]


@pytest.mark.parametrize(
    ("by", "keys"),
    [
        ("Singhal and Jones, 2015", {"singhal-jones-2015"}),
        ("after Singhal & Jones (2015, 2018)", {"singhal-jones-2015", "singhal-jones-2018"}),
        ("Wilson et al. 2011", {"wilson-2011"}),
        ("Singhal and Jones", {"singhal-jones-2015", "singhal-jones-2018"}),
        ("Singhal", set()),
        ("Wilson, 1999", set()),
        ("Wilsonian, 2011", set()),
        ('who?" doi "10.1145/2858036.2858205', {"wilson-2016"}),
        ('who?" doi "https://doi.org/10.1145/2858036.2858205', {"wilson-2016"}),
        ('who?" doi "DOI: 10.1145/2858036.2858205', {"wilson-2016"}),
    ],
)
def test_author_and_year_or_doi_name_a_publication(by: str, keys: set[str]) -> None:
    assert {each["key"] for each in cited(made(f'icon a by "{by}" {{ hold for 1 s }}'))} == keys


def test_methods_of_the_six_icons() -> None:
    said = methods(load_library("six-icons"))
    assert said.startswith(
        "Six thermal icons of the set “Six thermal icons after Singhal and Jones” were used. They prescribe the "
        "temperature of the display at the site “thenar”, from a baseline of 32 °C. They last 8 s and lie within 26 to "
        "37 °C, at rates of up to 4 °C/s. Their courses, from baseline: cooling-step (“a quick, strong cooling”; "
        "tagged published): cool by 6 °C at 3 °C/s, hold for 4 s, return at 3 °C/s; warming-step ("
    )
    assert "repeat 2 { cool by 3 °C at 3 °C/s, hold for 1 s, return at 3 °C/s, rest for 1 s }. Sources, as the" in said
    assert "[Check before printing: details of Singhal 2015, Singhal 2018 are unverified in the bibliography.]" in said
    assert said.endswith(f"content hash {load_library('six-icons').content_hash[:12]}.")
    icons, predicted = said.split("\n\n")
    assert "*predicted*, not measured" in predicted and "predicted" not in icons


def test_bibtex_has_the_program_and_every_source_with_what_is_not_verified() -> None:
    said = bibtex(made('icon a by "Singhal, 2015" doi "doi:10.1/x" { hold for 1 s }'))
    assert [line for line in said.splitlines() if line.startswith("@")] == ["@software{thermicon,", "@misc{10-1-x,"]
    assert missing(["doi = {10.1/x}", "note = {Singhal, 2015}", "year = {2026}"], said) == []
    assert f"date-released: {YEAR}-" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    said = bibtex(load_library("six-icons"))
    assert said.count("@") == 1 + len(cited(load_library("six-icons"))) and "seen =" not in said
    assert said.count("% to be checked: ") == sum("unverified" in each for each in cited(load_library("six-icons")))


def test_methods_of_a_family_and_of_a_current() -> None:
    over = "(size in [-3, 3] K, rate in 1..3 step 0.5 °C/s, n in [1])"
    said = methods(made(f"icon r{over} {{ repeat n {{ change by size at rate; return at rate }} }}"))
    assert "a family of ten icons over size in [−3, 3] K and rate in 1..3 step 0.5 °C/s and n in [1]: repeat n" in said
    assert "They prescribe the temperature of the skin surface. They last 2 to 6 s." in said and "Sources" not in said
    said = methods(made("set { control current; baseline 32 °C }; icon a { to -0.5 A at 1 A/s; return over 1 s }"))
    assert "It prescribes the drive current, on a display that rests at a baseline of 32 °C." in said
    assert "It lasts 1.5 s within −0.5 to 0 A, at rates of up to 1 A/s." in said
    assert "a: to −0.5 A at 1 A/s, return over 1 s" in said


def test_methods_with_a_doi_and_a_rig() -> None:
    icons = made('icon a by "B. Person, 2024" doi "https://doi.org/10.1234/x" { hold for 1 s }')
    said = methods(icons, "mine: a rig\n  site       arm, 9 cm²\n  note       long and\n             longer.\n")
    assert "Sources, as the set names them: B. Person, 2024, doi:10.1234/x." in said
    assert "The rig was modelled as follows: mine: a rig; site arm, 9 cm²; note long and longer. The icons" in said
