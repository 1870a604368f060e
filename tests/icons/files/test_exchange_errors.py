"""What is wrong with a cue set in JSON is named by its JSON path, with value, limit, unit and cure."""

import pytest

from thermicon.icons import CueErrors
from thermicon.icons.files.exchange import from_json


def error(text: str | bytes) -> str:
    with pytest.raises(CueErrors, match=r"E\d\d\d ") as caught:
        from_json(text, "a.json")
    return str(caught.value)


def with_body(statements: str, head: str = "", settings: str = '"baseline_C": 32') -> str:
    """A file whose fourth line holds the statements."""
    return (
        '{"format": "thermicon cue", "version": 1,\n'
        f'"set": {{{settings}}}, "icons": [\n{{"name": "a", {head}"statements": [\n{statements}]}}]}}'
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "a.json:1:2  E011 not valid JSON\n  1 | {\n    |  ^ expecting property name enclosed in double quotes"),
        ('{"a": 1 "b": 2}', "expecting ',' delimiter"),
        ('{"a": }', "expecting value\n  an object is"),
        ('{"a": 1,\n"b": "x', 'a.json:2:6  E011 not valid JSON\n  2 | "b": "x\n    |      ^ unterminated string\n'),
        ('{"a": [1, NaN]}', "a.json  E011 not valid JSON\n  NaN is not a number in JSON"),
        ("1" * 5000, "a number has thousands of digits"),
        ('{"a": 1,\n "a": 2}', 'the key "a" stands twice in one object\n  keep one of them'),
        ("[" * 100_000, "E115 nested too deeply"),
        ("", "a.json  E005 empty file"),
        (b"\xff", "E007 not UTF-8\n  byte 0xFF at byte offset 0"),
        (" " * 1_000_001, "E004 file too large\n  1,000,001 bytes"),
    ],
)
def test_what_is_not_json(text: str | bytes, words: str) -> None:
    assert words in error(text)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[1]", "a.json  E012 not a cue set in JSON\n  the file: a list: an object is needed"),
        ('{"format": "cue", "version": 1, "icons": []}', 'format: "cue" is not allowed here'),
        ('{"format": "thermicon cue", "version": 2}', "E010 unknown version"),
        ('{"format": "thermicon cue", "version": true}', "this is version 1 of the format, not true"),
        ('{"format": "thermicon cue", "version": 1}', 'the file: "icons" is missing\n  add "icons"'),
        ('{"format": "thermicon cue", "version": 1, "icon": []}', 'icon: unknown key "icon"\n  did you mean icons?'),
        ('{"format": "thermicon cue", "version": 1, "icons": []}', "icons: the list is empty"),
        ('{"$schema": 1, "format": "thermicon cue", "version": 1}', "$schema: 1: a text is needed"),
    ],
)
def test_what_is_no_cue_set(text: str, words: str) -> None:
    assert words in error(text)


PATH = "icons[0].statements[0]"
FAMILY = '"parameters": [{"name": "x", "unit": "K", "values": [1, 2]}], '


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        (
            '{"do": "cool", "by": 6, "duration_s": 1}',
            f'a.json  E012|{PATH}.by: unknown key "by"|did you mean by_K?',
        ),
        (
            '{"do": "cool", "by_K": "6 K", "duration_s": 1}',
            f'{PATH}.by_K: "6 K": a number is needed in K|no quotation',
        ),
        ('{"do": "cool", "by_K": true, "duration_s": 1}', "true: a number is needed in K"),
        ('{"do": "cool", "by_K": -6, "duration_s": 1}', f"E202|{PATH}.by_K: -6: a change has a positive size"),
        (
            '{"do": "cool", "by_K": 6}',
            "rate_K_per_s or duration_s is missing|exactly one is given of: rate_K_per_s, dur",
        ),
        ('{"do": "cool", "by_K": 6, "to_C": 3, "duration_s": 1}', "by_K and to_C exclude one another"),
        ('{"do": "heat", "by_K": 6}', f'E012|{PATH}.do: "heat" is not a statement|did you mean warm?'),
        ('{"do": 3}', "3 is not a statement"),
        ('{"by_K": 6}', f'{PATH}: "do" is missing|it says what the statement is: warm, cool'),
        ("3", f"{PATH}: 3: an object is needed"),
        ('{"do": "hold"}', f'{PATH}: "duration_s" is missing|add "duration_s" in s'),
        ('{"do": "hold", "duration_s": null}', "null: a number is needed in s"),
        ('{"do": "return", "duration_s": null}', "null: a number is needed in s|a key without a value is left out"),
        ('{"do": "hold", "duration_s": 0}', "E203|duration_s: 0: a time is positive|the value is in s"),
        ('{"do": "hold", "duration_s": 1e999}', "this number is too large"),
        (f'{{"do": "hold", "duration_s": 1{"0" * 400}}}', "a number is needed in s"),
        ('{"do": "warm", "to_C": 99, "duration_s": 1}', "E219|to_C: 99: 99 °C is outside the −10 to 60 °C|is in °C"),
        ('{"do": "repeat", "count": 2.5, "statements": [{}]}', "count: 2.5: a whole number is needed"),
        ('{"do": "repeat", "count": 0, "statements": [{}]}', "E207|0 is not a positive whole number"),
        ('{"do": "repeat", "count": 2, "statements": []}', f"{PATH}.statements: the list is empty"),
        (
            '{"do": "repeat", "count": 2, "statements": [{"do": "total", "duration_s": 1}]}',
            "E229|concerns the whole icon",
        ),
        ('{"do": "total", "duration_s": 1, "bound": "most"}', '"most" is not allowed|did you mean at most?'),
        (
            '{"do": "sine", "by_K": 3, "period_s": 1, "duration_s": 1, "start": "up"}',
            f'E210|{PATH}.start: "up" is not a way to start|"warm" or "cool"',
        ),
        ('{"do": "sine", "by_A": -3, "period_s": 1, "duration_s": 1}', "E202|-3: an amplitude is positive"),
        ('{"do": "step", "by_A": 0}', "E202|a change must not be zero"),
        ('{"do": "play", "icon": "b c"}', "E113|'b c' is not a name"),
        ('{"do": "play", "icon": "aa"}', 'E230|no icon is called "aa"|did you mean a?'),
        ('{"do": "play", "icon": "xyz"}', "E230|play names an icon of this file"),
        ('{"do": "play", "icon": "a"}', "E232|these icons play each other in a circle: a plays a"),
        (
            '{"do": "return", "rate_A_per_s": 1}',
            f"E210|{PATH}.rate_A_per_s: 1: this set controls|a rate in °C/s",
        ),
        ('{"do": "drive", "to_A": 1, "duration_s": 1}', f"E209|{PATH}.to_A: "),
        ('{"do": "hold", "duration_s": 1}, {"do": "return", "duration_s": 1}', "E206|icons[0].statements[1]: "),
        (
            '{"do": "total", "duration_s": 5}, {"do": "hold", "duration_s": 1}',
            f"E222|{PATH}.duration_s: 5: this icon lasts 1 s, not 5 s",
        ),
        ('{"do": "step", "by_K": 3}', "E223|icons[0].name"),
        (
            '{"do": "hold", "duration_s": {"parameter": "x"}}',
            'E226|"x" is not a parameter|only a family has parameters',
        ),
        ('{"do": "hold", "duration_s": {"paramete": "x"}}', '"parameter" is missing|unknown key "paramete"'),
        (
            '{"do": "repeat", "count": 1000000, "statements": [{"do": "pulse", "by_K": 1, "duration_s": 1}]}',
            "E22",
        ),
    ],
)
def test_what_a_statement_cannot_be(statement: str, words: str) -> None:
    said = error(with_body(statement))
    assert all(word in said for word in words.split("|")), said


@pytest.mark.parametrize(
    ("head", "statement", "words"),
    [
        (FAMILY, '{"do": "hold", "duration_s": 1}', "E227|x is never used"),
        (FAMILY, '{"do": "hold", "duration_s": {"parameter": "x"}}', "E104|x is in K; a time is needed here"),
        (
            FAMILY,
            '{"do": "warm", "by_K": {"parameter": "y"}, "duration_s": 1}',
            "E226|parameters of this icon are: x",
        ),
        (
            FAMILY.replace("2]", "200]"),
            '{"do": "warm", "by_K": {"parameter": "x"}, "duration_s": 1}',
            "E219|200 °C is more",
        ),
        (
            FAMILY.replace("2]", "-2]"),
            '{"do": "warm", "by_K": {"parameter": "x"}, "duration_s": 1}',
            "E202|positive size",
        ),
        (
            FAMILY.replace("2]", "1]"),
            '{"do": "warm", "by_K": {"parameter": "x"}, "duration_s": 1}',
            "E213|icons[0].parameters[0].values: 1 is already in this list",
        ),
        (FAMILY.replace("K", "kelvin"), '{"do": "hold", "duration_s": 1}', "E103|'kelvin' is not a unit"),
        (
            FAMILY.replace('"values": [1, 2]', '"low": 1'),
            '{"do": "hold", "duration_s": 1}',
            "either values, or low, high",
        ),
        (
            FAMILY.replace('"values": [1, 2]', '"low": 1, "high": 2, "step": 0.7'),
            '{"do": "hold", "duration_s": 1}',
            "E228|2 is not reached from 1 in steps of 0.7",
        ),
        (
            FAMILY.replace("}]", '}, {"name": "x", "values": [1]}]'),
            '{"do": "warm", "by_K": {"parameter": "x"}, "duration_s": 1}',
            'E213|"x" is already in this list',
        ),
        (
            FAMILY.replace('"values": [1, 2]', '"low": 1, "high": 50000001, "step": 1').replace("K", "s"),
            '{"do": "hold", "duration_s": {"parameter": "x"}}',
            "E228|more than",
        ),
        (
            '"means": "{z}", ' + FAMILY,
            '{"do": "warm", "by_K": {"parameter": "x"}, "duration_s": 1}',
            'E226|icons[0].means: "z" is not a parameter',
        ),
        (
            FAMILY.replace("2]", "30]"),
            '{"do": "warm", "by_K": {"parameter": "x"}, "duration_s": 1}',
            f"E219|{PATH}.by_K: this leads to 62 °C (with x=30)",
        ),
        ('"means": " ", ', '{"do": "hold", "duration_s": 1}', "E117|the text is empty"),
        ('"means": "a\\u0007", ', '{"do": "hold", "duration_s": 1}', "E105|control character U+0007"),
        ('"means": "\\ud800", ', '{"do": "hold", "duration_s": 1}', "control character U+D800"),
        ('"tags": ["a,b"], ', '{"do": "hold", "duration_s": 1}', "E117|a tag must not contain a comma"),
        ('"tag": "b", ', '{"do": "hold", "duration_s": 1}', "did you mean tags?"),
    ],
)
def test_what_an_icon_cannot_be(head: str, statement: str, words: str) -> None:
    said = error(with_body(statement, head))
    assert all(word in said for word in words.split("|")), said


def test_amplitudes_and_changes_of_current_in_a_family() -> None:
    head = '"parameters": [{"name": "x", "unit": "A", "values": [VALUES]}], '
    wave = '{"do": "sine", "by_A": {"parameter": "x"}, "period_s": 1, "duration_s": 1}'
    amps = '"control": "current"'
    assert "E202 amount not positive" in error(with_body(wave, head.replace("VALUES", "1, -1"), amps))
    pulse = '{"do": "pulse", "by_A": {"parameter": "x"}, "duration_s": 1}'
    assert "a change must not be zero" in error(with_body(pulse, head.replace("VALUES", "1, 0"), amps))


def test_settings_are_told_too() -> None:
    said = error(
        with_body('{"do": "hold", "duration_s": 1}', settings='"control": "surface", "site": "a b", "basline": 1')
    )
    assert '"surface" is not allowed here\n  one of: skin, display, current' in said
    assert "E113 not a name" in said
    assert 'set.basline: unknown key "basline"\n  did you mean baseline_C?' in said


def test_all_that_is_wrong_is_told_in_order() -> None:
    bad = '{"do": "hold", "duration_s": -1},\n' * 150 + '{"do": "rest"}'
    with pytest.raises(CueErrors, match="and 51 more errors") as caught:
        from_json(with_body(bad))
    assert [f".statements[{n}]." in found.what for n, found in enumerate(caught.value.errors)] == [True] * 100
    assert (len(caught.value.errors), caught.value.more) == (100, 51)


def test_icons_that_cannot_be_together() -> None:
    icon = '{"name": "NAME", "statements": [{"do": "play", "icon": "PLAYED"}]}'
    head = '{"format": "thermicon cue", "version": 1, "icons": ['

    def named(*pairs: tuple[str, str]) -> str:
        return head + ", ".join(icon.replace("NAME", a).replace("PLAYED", b) for a, b in pairs) + "]}"

    assert "E232 icons that play each other" in error(named(("a", "b"), ("b", "c"), ("c", "a")))
    assert "a plays b plays c plays a" in error(named(("a", "b"), ("b", "c"), ("c", "a")))
    twice = named(("a", "x"), ("a", "x")).replace('{"do": "play", "icon": "x"}', '{"do": "hold", "duration_s": 1}')
    assert "E211 duplicate icon" in error(twice)
    assert "icons[0] is called a already" in error(twice)
    chain = [(f"a{'b' * n}", f"a{'b' * (n + 1)}") for n in range(30)]
    assert "E115 nested too deeply" in error(named(*chain, ("a" + "b" * 30, "x")))
    family = '{"name": "f", "parameters": [{"name": "x", "values": [2, 3]}], "statements": [BODY]}'.replace(
        "BODY", '{"do": "repeat", "count": {"parameter": "x"}, "statements": [{"do": "hold", "duration_s": 1}]}'
    )
    text = f"{head}{family}, {icon.replace('NAME', 'p')}]}}"
    assert from_json(text.replace("PLAYED", "f_x=3"))["p"].corners().duration_s == 3
    assert "this is not one of them\n  play one of its members, such as f_x=2" in error(text.replace("PLAYED", "f_x=4"))
    assert "f is a family of 2 icons" in error(text.replace("PLAYED", "f"))
    clash = icon.replace("NAME", "f_x=2").replace("PLAYED", "f_x=3")
    assert "E211 duplicate icon" in error(f"{head}{family}, {clash}]}}")


def test_files_have_the_limits_of_cue_files() -> None:
    nested = '{"do": "hold", "duration_s": 1}'
    for _ in range(30):
        nested = f'{{"do": "repeat", "count": 1, "statements": [{nested}]}}'
    assert "nested more than 20 deep" in error(with_body(nested))
    many = '{"do": "repeat", "count": 90000, "statements": [{"do": "hold", "duration_s": 0.01}]}'
    icon = '{"name": "NAME", "statements": [BODY]}'.replace("BODY", many)
    text = '{"format": "thermicon cue", "version": 1, "icons": [%s]}'
    assert "E220 too many corners" in error(text % ", ".join(icon.replace("NAME", name) for name in "abc"))
    family = (
        '{"name": "NAME", "parameters": [{"name": "x", "unit": "ms", "low": 1, "high": 30000, "step": 1}], '
        '"statements": [{"do": "hold", "duration_s": {"parameter": "x"}}]}'
    )
    small, large = (
        family.replace("NAME", "a").replace("30000", "2"),
        family.replace("NAME", "b").replace("30000", "99999"),
    )
    assert "the families up to here have 100,001 members" in error(text % f"{small}, {large}")
    wordy = large.replace("]}", ", " + ", ".join(['{"do": "hold", "duration_s": 0.1}'] * 5) + "]}")
    assert "99,999 members have 599,994 statements to check" in error(text % wordy)
