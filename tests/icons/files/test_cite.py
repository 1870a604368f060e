"""What a paper says of a set: the paragraph, the BibTeX entries, and the bibliography they come from."""

import re
from pathlib import Path

import pytest

from thermicon.icons import IconSet, load_library, parse
from thermicon.icons.files.methods import course, methods
from thermicon.icons.files.references import (
    AUTHORS,
    LICENCE,
    TITLE,
    BibliographyError,
    Reference,
    bibtex,
    cited,
    escaped,
    plain_doi,
    read_references,
    references,
)
from thermicon.icons.files.shipped import library_names

ROOT = Path(__file__).parents[3]
# Every DOI that a page was seen to show; one that is added to the bibliography is added here with the page.
SEEN_DOIS = {
    "shani-lineykin-2023": "10.3390/bioengineering10101156",
    "shani-lineykin-2025": "10.3390/bioengineering12020209",
    "wilson-2013": "10.1007/978-3-642-41068-0_2",
    "wilson-2016": "10.1145/2858036.2858205",
}
ENTRY = """@article{a-2020,
  author = {Ann A. Able and Bo Baker},
  title = {{T}},
  year = {2020},
  seen = {p},
}
"""


def made(text: str) -> IconSet:
    return parse(f"cue 1; {text}")


def entry(text: str, key: str) -> str:
    found = re.search(rf"^@\w+{{{key},\n.*?^}}", text, re.MULTILINE | re.DOTALL)
    assert found, text
    return found[0]


def test_no_doi_is_invented() -> None:
    listed = {each.key: each.doi for each in references() if each.doi}
    assert listed == SEEN_DOIS


def test_what_was_not_seen_is_marked() -> None:
    for each in references():
        assert bool(each.unverified) == (
            "general knowledge" in each.seen
            or "taken from" in each.seen
            or ("from this project's cue sets" in each.seen)
        ), each.key


def test_every_shipped_set_names_sources_that_are_known() -> None:
    for name in library_names():
        found = cited(load_library(name))
        assert not found.unknown, name
        names = {each.key for each in found.references}
        by = load_library(name).metadata.by or ""
        assert bool(names) == (by != "thermicon"), name


@pytest.mark.parametrize(
    ("by", "keys"),
    [
        ("Singhal and Jones, 2015", {"singhal-jones-2015"}),
        ("after Singhal & Jones (2015, 2018)", {"singhal-jones-2015", "singhal-jones-2018"}),
        ("Wilson et al. 2011", {"wilson-2011"}),
        ("Shani and Lineykin, HUCAPP 2021", {"shani-lineykin-2021"}),
        ("Singhal and Jones", {"singhal-jones-2015", "singhal-jones-2018"}),
        ("Singhal", set()),
        ("Wilson, 1999", set()),
        ("Wilsonian, 2011", set()),
    ],
)
def test_author_and_year_name_a_publication(by: str, keys: set[str]) -> None:
    found = cited(made(f'icon a by "{by}" {{ hold for 1 s }}'))
    assert {each.key for each in found.references} == keys
    assert len(found.unknown) == (not keys)
    assert found.undated == (keys if by == "Singhal and Jones" else frozenset())


def test_without_a_year_those_are_meant_that_the_set_dates() -> None:
    text = 'icon a by "Singhal and Jones, 2015" { hold for 1 s }; icon b by "after Singhal and Jones" { hold for 1 s }'
    found = cited(made(text))
    assert [each.key for each in found.references] == ["singhal-jones-2015"]
    assert not found.undated


@pytest.mark.parametrize(
    "doi", ["10.1145/2858036.2858205", "https://doi.org/10.1145/2858036.2858205", "DOI: 10.1145/2858036.2858205"]
)
def test_a_doi_names_a_publication(doi: str) -> None:
    found = cited(made(f'icon a by "who?" doi "{doi}" {{ hold for 1 s }}'))
    assert [each.key for each in found.references] == ["wilson-2016"]
    assert not found.unknown
    assert plain_doi(doi) == "10.1145/2858036.2858205"


def test_bibtex_of_a_known_publication() -> None:
    text = bibtex(load_library("six-icons"))
    assert entry(text, "singhal-jones-2018") == (
        "@article{singhal-jones-2018,\n"
        "  author = {Anshul Singhal and Lynette A. Jones},\n"
        "  title = {{Creating Thermal Icons: A Model-Based Approach}},\n"
        "  journal = {ACM Transactions on Applied Perception},\n"
        "  year = {2018},\n"
        "  note = {details unverified: title, journal and second author},\n"
        "}"
    )
    known = bibtex(made('icon a by "Wilson 2013" { hold for 1 s }'))
    assert "  pages = {10--19},\n  doi = {10.1007/978-3-642-41068-0_2},\n}" in entry(known, "wilson-2013")
    assert "note" not in entry(known, "wilson-2013")
    undated = bibtex(made('icon a by "Singhal and Jones" { hold for 1 s }'))
    assert "note = {details unverified: name of the conference; the cue set does not state the year}" in undated


def test_bibtex_of_an_unknown_source_is_marked() -> None:
    text = bibtex(made('set { by "Miller & Sons, 2019"; doi "doi:10.1234/a_b" }; icon a by "my_self" { hold for 1 s }'))
    assert entry(text, "source-1") == (
        "@misc{source-1,\n"
        "  howpublished = {Miller \\& Sons, 2019},\n"
        "  doi = {10.1234/a_b},\n"
        "  year = {2019},\n"
        "  note = {As the cue set names it; not in the bibliography of thermicon, details unverified},\n"
        "}"
    )
    assert "howpublished = {my\\_self}" in entry(text, "source-2")
    assert escaped("a{b}\\c~d^e\nf") == r"a\{b\}\textbackslash{}c\textasciitilde{}d\textasciicircum{}e f"


def test_thermicon_is_cited_as_its_citation_file_says() -> None:
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f'title: "{TITLE}"' in text
    assert f'- name: "{AUTHORS}"' in text
    assert f"license: {LICENCE}" in text
    version = re.search(r"^version: (\S+)$", text, re.MULTILINE)
    assert version is not None
    own = entry(bibtex(made("icon a { hold for 1 s }")), "thermicon")
    assert f"note = {{Computer program, version {version[1]}, MIT licence}}" in own


def test_methods_of_the_six_icons() -> None:
    said = methods(load_library("six-icons"))
    assert said.startswith(
        "Six thermal icons of the set “Six thermal icons after Singhal and Jones” were used. They prescribe the "
        "temperature of the display at the site “thenar”, from a baseline of 32 °C. They last 8 s and lie within 26 to "
        "37 °C, at rates of up to 4 °C/s. Their courses, from baseline: cooling-step (“a quick, strong cooling”), "
        "cooling by 6 °C at 3 °C/s, a hold of 4 s and a return to baseline at 3 °C/s (8 s, tagged “published”); "
        "warming-step (“a moderate warming”), "
    )
    assert "double-dip (“two short coolings”), 2 times (cooling by 3 °C at 3 °C/s, a hold of 1 s, a return" in said
    assert "Sources, as the set names them: after Singhal and Jones, 2015 and 2018; " in said
    assert (
        "[Check before printing: details of Singhal 2015 and Singhal 2018 are unverified in the bibliography.]" in said
    )
    assert said.endswith(f"content hash {load_library('six-icons').content_hash[:12]}.")
    assert "\n" not in said


def test_methods_of_a_family_and_of_a_current() -> None:
    over = "(size in [-3, 3] K, rate in 1..3 step 0.5 °C/s, n in [1])"
    text = f"icon r{over} {{ repeat n {{ change by size at rate; return at rate }} }}"
    said = methods(made(text))
    assert (
        "r, a family of ten icons over size (−3 and 3 K), rate (1 to 3 °C/s in steps of 0.5 °C/s) and n (1): n × "
        in said
    )
    assert "(a change by size at rate and a return to baseline at rate) (2 to 6 s)" in said
    assert (
        "Ten thermal icons were used. They prescribe the temperature of the skin surface. They last 2 to 6 s." in said
    )
    assert "Sources" not in said
    said = methods(made("set { control current; baseline 32 °C }; icon a { to -0.5 A at 1 A/s; return over 1 s }"))
    assert "It prescribes the drive current, on a display that rests at a baseline of 32 °C." in said
    assert "It lasts 1.5 s within −0.5 to 0 A, at rates of up to 1 A/s." in said
    assert "a, a ramp to −0.5 A at 1 A/s and a return to baseline over 1 s" in said


def test_methods_with_a_doi_and_a_rig() -> None:
    icons = made('icon a by "B. Person, 2024" doi "https://doi.org/10.1234/x" { hold for 1 s }')
    said = methods(icons, "mine: a rig\n  site       arm, 9 cm²\n  note       long and\n             longer.\n")
    assert "Sources, as the set names them: B. Person, 2024, doi:10.1234/x." in said
    assert "The rig was modelled as follows: mine: a rig; site arm, 9 cm²; note long and longer. The icons" in said


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        ("warm to 38 °C over 2 s", "warming to 38 °C over 2 s"),
        ("change by -3 °C at 1 °C/min", "a change by −3 °C at 1 °C/min"),
        ("rest for 500 ms", "a rest of 0.5 s at baseline"),
        ("step cool by 2 °C; hold for 1 s", "a step down by 2 °C and a hold of 1 s"),
        ("step to 33 °C; hold for 1 s", "a step to 33 °C and a hold of 1 s"),
        ("pulse warm by 2 °C for 1 s", "a pulse up by 2 °C for 1 s"),
        (
            "sine by 1 °C every 2 s for 4 s starting cool",
            "a sine wave of ±1 °C and a period of 2 s for 4 s, downwards first",
        ),
        ("sawtooth by 1 °C every 2 s for 4 s", "a sawtooth wave of ±1 °C and a period of 2 s for 4 s, upwards first"),
        ("play other; total 1 s", "the course of other"),
    ],
)
def test_statements_in_words(statement: str, words: str) -> None:
    icons = made(f"set {{ baseline 32 °C }}; icon a {{ {statement} }}; icon other {{ hold for 1 s }}")
    assert course(icons["a"].statements, "skin") == words


def test_the_shipped_bibliography_loads_completely() -> None:
    text = (ROOT / "icons" / "data" / "references.bib").read_text(encoding="utf-8")
    listed = references()
    assert len(listed) == text.count("@") == len({each.key for each in listed})
    rows = [
        f"{name} = {{{getattr(each, name)}}}," for each in listed for name in each.__slots__[2:] if getattr(each, name)
    ]
    assert sorted(rows) == sorted(line.strip() for line in text.splitlines() if line.startswith("  "))
    assert listed[0].surnames == ("Shani", "Lineykin")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a = 1", "b.bib:1: 'a = 1' is neither the head of an entry, @article{key, nor a field, name = {text}"),
        (ENTRY.replace("title", "titel"), "b.bib:3: 'titel = {{T}},' is neither .* fields are: author, title"),
        (ENTRY.replace("{p},", "{p"), "b.bib:5: 'seen = {p' is neither"),
        (ENTRY.replace("seen", "year"), "b.bib:5: 'year = {p},' is neither .* that stands once"),
        (ENTRY.replace("  title = {{T}},\n", ""), "b.bib: a-2020: title is missing; without it an entry does not load"),
        (ENTRY.replace("  seen = {p},\n", ""), "b.bib: a-2020: seen is missing"),
        (ENTRY.replace("@article", "@paper"), "b.bib: a-2020: type = 'paper' must be one of article, inproceedings"),
        (ENTRY.replace("{{T}}", "{ }"), "b.bib: a-2020: title is an empty text; leave it out"),
        (ENTRY.replace("2020}", "20}"), "b.bib: a-2020: year = '20' must be a year such as 2018"),
        (ENTRY.replace("}\n", "  doi = {doi:10.1/x},\n}\n"), "b.bib: a-2020: doi = 'doi:10.1/x' is not a DOI"),
        (ENTRY + ENTRY, "b.bib: two entries have one key; give each a different one"),
    ],
)
def test_a_bibliography_that_cannot_be(text: str, words: str) -> None:
    with pytest.raises(BibliographyError, match=words):
        read_references(text, "b.bib")


def test_another_bibliography_can_be_given() -> None:
    (own,) = read_references(ENTRY, "b.bib")
    assert isinstance(own, Reference)
    assert cited(made('icon a by "Able 2020" { hold for 1 s }'), [own]).references == (own,)
