"""Mistakes and what people must be told about them: source, code, line, column, words of the message."""

from typing import NamedTuple


class Mistake(NamedTuple):
    source: str
    code: str
    line: int
    column: int
    words: str
    suggestion: str | None = None


def body(statement: str, *before: str) -> str:
    """A file whose line 3 is the statement; what leads up to it stands on line 2."""
    return "\n".join(["cue 1", "icon x { " + "; ".join(before), "  " + statement, "}"])


def block(setting: str) -> str:
    return f"cue 1\nset a {{\n  {setting}\n}}\nicon x {{ hold for 1 s }}"


DOWN = "cool by 6 °C at 3 °C/s"
AMPS = "cue 1\nset { control current }\nicon x {\n  "
STEP = "icon x { hold for 1 s }"

SYNTAX = [
    Mistake(body("dance for 4 s"), "E101", 3, 3, '"dance" is not understood'),
    Mistake(body("coool by 6 °C at 3 °C/s"), "E101", 3, 3, "statements begin with: cool", "cool by 6 °C at 3 °C/s"),
    Mistake(body("holdfor 4 s"), "E101", 3, 3, '"holdfor"', "hold for 4 s"),
    Mistake("cue 1\ncool by 6 °C at 3 °C/s\n" + STEP, "E101", 2, 1, "belongs inside the braces of an icon"),
    Mistake(f"cue 1\nicn x {{ {DOWN} }}", "E101", 2, 1, '"icn"', f"icon x {{ {DOWN} }}"),
    Mistake(f'cue 1\nicon x mean "y" {{ {DOWN} }}', "E101", 2, 8, "is not a key", f'icon x means "y" {{ {DOWN} }}'),
    Mistake(body("{ hold for 1 s }"), "E101", 3, 3, "a block needs a word before it"),
    Mistake(body("cool to 26 at 3 °C/s"), "E102", 3, 11, "this number has no unit", "cool to 26 °C at 3 °C/s"),
    Mistake(body("cool by 6 at 3"), "E102", 3, 11, "this number has no unit", "cool by 6 °C at 3 °C/s"),
    Mistake(body("hold for 4"), "E102", 3, 12, 'a time such as "4 s"', "hold for 4 s"),
    Mistake(body("cool by 6 °C at 3"), "E102", 3, 19, 'a rate such as "3 °C/s"', "cool by 6 °C at 3 °C/s"),
    Mistake(AMPS + "to 1 at 1 A/s\n}", "E102", 4, 6, 'a current such as "0.5 A"', "to 1 A at 1 A/s"),
    Mistake(AMPS + "to 1 A at 1\n}", "E102", 4, 13, 'a rate such as "1 A/s"', "to 1 A at 1 A/s"),
    Mistake(body("hold for 4 seconds"), "E103", 3, 14, '"seconds" is not a unit', "hold for 4 s"),
    Mistake(body("cool by 6 ℃ at 3 °C/s"), "E103", 3, 13, "degC", DOWN),
    Mistake(body("cool by 6 % at 3 °C/s"), "E103", 3, 13, "no unit of this language"),
    Mistake(body("cool by 6 °C at 3 °C"), "E104", 3, 21, "a rate of temperature is needed", DOWN),
    Mistake(body("warm to 300 K at 1 K/s"), "E104", 3, 15, "K is for differences"),
    Mistake(body("cool to 26 K at 1 K/s"), "E104", 3, 14, "in °C", "cool to 26 °C at 1 K/s"),
    Mistake(body("cool by 6 A at 3 °C/s"), "E104", 3, 13, "a current; a temperature difference is needed"),
    Mistake(body("hold for 4 °C"), "E104", 3, 14, "a time is needed"),
    Mistake(body("hold for 4 s @"), "E105", 3, 16, "U+0040", "hold for 4 s"),
    Mistake(f'cue 1\nicon x means "a\x07b" {{ {DOWN} }}', "E105", 2, 14, "U+0007"),
    Mistake(body("hold for 1,5 s"), "E106", 3, 12, '"1,5" is not a number', "hold for 1.5 s"),
    Mistake(body("cool by °C at 3 °C/s"), "E106", 3, 11, "a number is needed"),
    Mistake("cue one\n" + STEP, "E106", 1, 5, "a number is needed", "cue 1"),
    Mistake(body("cool by 6 °C"), "E107", 3, 3, "how fast", DOWN),
    Mistake(body("cool by 6 °C 3 °C/s"), "E107", 3, 16, '"at" or "over" is needed', DOWN),
    Mistake(body("cool by 6 °C in 2 s"), "E107", 3, 16, "how long", "cool by 6 °C over 2 s"),
    Mistake(body("hold for 4 s hold for 1 s"), "E108", 3, 16, "second statement", "hold for 4 s; hold for 1 s"),
    Mistake(body("hold for 4 s long"), "E108", 3, 16, 'complete before "long"', "hold for 4 s"),
    Mistake(block("site left thumb"), "E108", 3, 13, "takes one name", "site left-thumb"),
    Mistake(f"cue 1\nicon x {{\n  {DOWN}\nicon y {{ {DOWN} }}", "E109", 2, 1, 'lacks a "}" at line 4'),
    Mistake(f"cue 1\nicon x {{\n  {DOWN}\n", "E109", 2, 1, "the end of the file"),
    Mistake("cue 1\n" + STEP + "\n}", "E110", 3, 1, "no block is open"),
    Mistake(f'cue 1\nicon x means "y {{\n{DOWN}\n}}', "E111", 2, 14, "no closing quotation", 'icon x means "y" {'),
    Mistake(f'cue 1\nicon x means "C:\\temp" {{ {DOWN} }}', "E112", 2, 17, "means nothing"),
    Mistake(f"cue 1\nicon my_icon {{ {DOWN} }}", "E113", 2, 6, "not a name", f"icon my-icon {{ {DOWN} }}"),
    Mistake(f"cue 1\nicon 3rd {{ {DOWN} }}", "E113", 2, 6, "begins with a letter"),
    Mistake(f"cue 1\nicon {{ {DOWN} }}", "E113", 2, 5, "a name is missing"),
    Mistake(f"cue 1\nicon big dip {{ {DOWN} }}", "E113", 2, 10, "no blanks", f"icon big-dip {{ {DOWN} }}"),
    Mistake(f"cue 1\nicon x\n  {DOWN}\n}}", "E114", 2, 6, 'no "{" opens the block', "icon x {"),
    Mistake(body("repeat 3 times { hold for 1 s }"), "E114", 3, 12, 'a "{" is needed', "repeat 3  { hold for 1 s }"),
    Mistake(body("repeat 1 { " * 25 + "hold for 1 s" + " }" * 25), "E115", 3, 221, "more than 20 deep"),
    Mistake(body("hold 4 s"), "E116", 3, 8, '"for" is needed', "hold for 4 s"),
    Mistake(body("cool 6 °C at 3 °C/s"), "E116", 3, 8, '"by" or "to"', DOWN),
    Mistake(body("hold"), "E116", 3, 3, '"for" is missing', "hold for 1 s"),
    Mistake(f"cue 1\nicon x means y {{ {DOWN} }}", "E117", 2, 14, "quotation marks", f'icon x means "y" {{ {DOWN} }}'),
    Mistake(f'cue 1\nicon x means "" {{ {DOWN} }}', "E117", 2, 14, "the text is empty"),
]

NOT_YET = [
    *(
        Mistake(body(line), "E120", 3, 3, words)
        for line, words in [
            ("sine by 3 °C every 4 s for 12 s", "write its corners"),
            ("square by 3 °C every 4 s for 12 s", "wave-shapes"),
            ("triangle by 3 °C every 4 s for 12 s", "wave-shapes"),
            ("sawtooth by 3 °C every 4 s for 12 s", "wave-shapes"),
            ("step by 3 °C", "over 100 ms"),
            ("pulse by 3 °C for 1 s", "three lines"),
            ("play other-icon", "write the statements"),
            ("change by 3 °C at 1 °C/s", "write the direction"),
            ("total 10 s", "rest for 2 s"),
            ("on thumb { hold for 1 s }", "several elements"),
        ]
    ),
    Mistake(f"cue 1\nicon x(a in [1, 2] °C) {{ {DOWN} }}", "E120", 2, 7, "families"),
    Mistake(body("warm to baseline at 3 °C/s", DOWN), "E120", 3, 11, "no target", "return at 3 °C/s"),
]

MEANING = [
    Mistake("cue 1\nset a { site thenar }\n", "E008", 2, 21, "ends without an icon"),
    Mistake(STEP, "E009", 1, 1, "version is not said", "cue 1"),
    Mistake("cue 2\n" + STEP, "E010", 1, 5, "version 1", "cue 1"),
    Mistake(body("warm to 26 °C at 3 °C/s"), "E201", 3, 11, "below the 32 °C", "cool to 26 °C at 3 °C/s"),
    Mistake(body("cool to 30 °C at 3 °C/s", DOWN), "E201", 3, 11, "above the 26 °C", "warm to 30 °C at 3 °C/s"),
    Mistake(body("cool to 32 °C at 3 °C/s"), "E201", 3, 11, "32 °C already"),
    Mistake(body("repeat 2 { warm to 36 °C at 3 °C/s; hold for 1 s }"), "E201", 3, 22, "36 °C already"),
    Mistake(AMPS + "to 0 A over 1 s\n}", "E201", 4, 6, "0 A already"),
    Mistake(body("cool by -6 °C at 3 °C/s"), "E202", 3, 11, "positive size", DOWN),
    Mistake(body("cool by 0 °C at 3 °C/s"), "E202", 3, 11, "positive size"),
    Mistake(body("hold for -4 s"), "E203", 3, 12, "a time is positive", "hold for 4 s"),
    Mistake(body("hold for 0.0001 ms"), "E203", 3, 12, "microsecond"),
    Mistake(body("cool by 1e-8 K at 1 K/s"), "E203", 3, 21, "less than a microsecond"),
    Mistake(body("cool by 6 °C at -3 °C/s"), "E204", 3, 19, "a rate is positive", DOWN),
    Mistake(body("return at 0 °C/s", DOWN), "E204", 3, 13, "a rate is positive"),
    Mistake(body("rest for 2 s", DOWN), "E205", 3, 3, "26 °C here, baseline is 32 °C", "hold for 2 s"),
    Mistake(body("return over 2 s"), "E206", 3, 3, "at baseline already", "rest for 2 s"),
    Mistake(body("return at 2 °C/s"), "E206", 3, 3, 'write "rest for 2 s"'),
    Mistake(body("repeat 0 { hold for 1 s }"), "E207", 3, 10, "not a positive whole number"),
    Mistake(body("repeat 2.5 { hold for 1 s }"), "E207", 3, 10, "not a positive whole number"),
    Mistake(body("repeat -1 { hold for 1 s }"), "E207", 3, 10, "not a positive whole number"),
    Mistake(body("repeat { hold for 1 s }"), "E207", 3, 9, "how often is missing"),
    Mistake(body("repeat twice { hold for 1 s }"), "E207", 3, 10, "not a count"),
    Mistake(AMPS + DOWN + "\n}", "E208", 4, 3, "controls the current"),
    Mistake(body("to 0.5 A at 1 A/s"), "E209", 3, 3, "controls the skin"),
    Mistake(body("to 26 °C at 3 °C/s"), "E209", 3, 3, "temperatures take a direction", "cool to 26 °C at 3 °C/s"),
    Mistake(body("return at 1 A/s", DOWN), "E210", 3, 13, "controls the skin", "return at 1 °C/s"),
    Mistake(AMPS + "to 1 A over 1 s; return at 1 °C/s\n}", "E210", 4, 30, "controls the current"),
    Mistake("cue 1\n" + STEP + "\n" + STEP, "E211", 3, 6, "line 2 has an icon", "icon x-2 { hold for 1 s }"),
    Mistake("cue 1\nset a { }\nset b { }\n" + STEP, "E212", 3, 1, "line 2 already"),
    Mistake("cue 1\nset a { site b\n site c }\n" + STEP, "E213", 3, 2, '"site" stands on line 2 already'),
    Mistake('cue 1\nicon x by "a" by "b" { hold for 1 s }', "E213", 2, 15, '"by" stands on line 2 already'),
    Mistake("cue 1\ncue 1\n" + STEP, "E213", 2, 1, "line 1 already"),
    Mistake(f"{STEP}\ncue 1", "E214", 2, 1, "after something else"),
    Mistake(f"cue 1\n{STEP}\nset a {{ site b }}", "E214", 3, 1, "above the first icon"),
    Mistake(block("control skn"), "E215", 3, 11, "one of: skin, display, current", "control skin"),
    Mistake(block("baselin 32 °C"), "E216", 3, 3, "settings are: site", "baseline 32 °C"),
    Mistake("cue 1\nicon x { }", "E217", 2, 6, "nothing between the braces"),
    Mistake(body("repeat 2 { }"), "E217", 3, 3, "braces of this repeat"),
    Mistake(body("hold for 1e999 s"), "E218", 3, 12, "at most 1e+09"),
    Mistake(body("hold for 1e-400 s"), "E218", 3, 12, "at least 1e-09"),
    Mistake(body("hold for 0." + "1" * 60 + " s"), "E218", 3, 12, "at most 40 characters"),
    Mistake(body("warm to 70 °C at 1 °C/s"), "E219", 3, 11, "−10 to 60 °C that the language allows"),
    Mistake(body("cool by 50 °C at 9 °C/s"), "E219", 3, 11, "this leads to -18 °C"),
    Mistake(body("repeat 40 { warm by 1 °C at 1 °C/s }"), "E219", 3, 23, "this leads to 72 °C"),
    Mistake(body("cool by 80 °C at 9 °C/s"), "E219", 3, 11, "more than the whole"),
    Mistake(block("baseline 99 °C"), "E219", 3, 12, "99 °C is outside"),
    Mistake(AMPS + "to 21 A at 1 A/s\n}", "E219", 4, 6, "±20 A"),
    Mistake(body("repeat 1000000 { repeat 1000000 { hold for 1 s } }"), "E220", 3, 3, "1,000,000,000,000 corners"),
    Mistake(body("hold for 61 min"), "E221", 3, 12, "the hour that an icon may last"),
    Mistake(body("repeat 70 { hold for 1 min }"), "E221", 2, 6, "this icon lasts 4,200 s"),
]

ALL = [*SYNTAX, *NOT_YET, *MEANING]
