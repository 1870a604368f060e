"""Mistakes and what people must be told about them: source, code, line, column, words of the message."""

from typing import NamedTuple


class Mistake(NamedTuple):
    source: str
    code: str
    line: int
    column: int
    words: str
    suggestion: str | None = None  # "" where there must be none


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
    Mistake(body("cool by 6 % at 3 °C/s"), "E103", 3, 13, "is not a unit"),
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
    Mistake(
        f"cue 1\nicon big dip {{ {DOWN} }}", "E113", 2, 10, "must not contain spaces", f"icon big-dip {{ {DOWN} }}"
    ),
    Mistake(f"cue 1\nicon x\n  {DOWN}\n}}", "E114", 2, 6, 'no "{" opens the block', "icon x {"),
    Mistake(body("repeat 3 times { hold for 1 s }"), "E114", 3, 12, 'a "{" is needed', "repeat 3  { hold for 1 s }"),
    Mistake(body("repeat 1 { " * 25 + "hold for 1 s" + " }" * 25), "E115", 3, 221, "more than 20 deep"),
    Mistake(body("hold 4 s"), "E116", 3, 8, '"for" is needed', "hold for 4 s"),
    Mistake(body("cool 6 °C at 3 °C/s"), "E116", 3, 8, '"by" or "to"', DOWN),
    Mistake(body("hold"), "E116", 3, 3, '"for" is missing', "hold for 1 s"),
    Mistake(f"cue 1\nicon x means y {{ {DOWN} }}", "E117", 2, 14, "quotation marks", f'icon x means "y" {{ {DOWN} }}'),
    Mistake(f'cue 1\nicon x means "" {{ {DOWN} }}', "E117", 2, 14, "the text is empty"),
]

NOTATION = [
    *(
        Mistake(body(f"change by {sign}6 °C at 3 °C/s"), "E106", 3, 13, words, "change by -6 °C at 3 °C/s")
        for sign, words in {
            "–": '^^ "–" (U+2013) is not a minus sign',
            "— ": '^^^ "—" (U+2014) is not a minus sign',
            "‐": "(U+2010)",
            "‑": "(U+2011)",
            "‒": "(U+2012)",
            "- ": "^^^ there is a space between the sign and its number",
            "− ": "^^^ there is a space between",
        }.items()
    ),
    Mistake(body("change –6 °C at 3 °C/s"), "E106", 3, 10, "U+2013", "change by -6 °C at 3 °C/s"),
    Mistake(body("change by ±6 °C at 3 °C/s"), "E106", 3, 13, 'not "±"', ""),
    Mistake(body("hold for 1m30s"), "E103", 3, 13, '"m30s" is not a unit', ""),
    Mistake(body("hold for 1 s, 2 s"), "E105", 3, 15, "U+002C", ""),
    Mistake(body("repeat 2,000 { hold for 1 s }"), "E207", 3, 10, "is not a count", ""),
    Mistake(body("cool from 32 to 26 °C at 3 °C/s"), "E116", 3, 8, "needed", "cool to 26 °C at 3 °C/s"),
    Mistake(body("hold for 500 µs"), "E103", 3, 16, '"µs" is not a unit', "hold for 0.5 ms"),
    Mistake(body("hold for 500 us"), "E103", 3, 16, '"us" is not a unit', "hold for 0.5 ms"),
    Mistake(body("hold for 1 h"), "E103", 3, 14, '"h" is not a unit', "hold for 60 min"),
    Mistake(body("change by 3 mK at 1 K/s"), "E103", 3, 15, '"mK"', "change by 0.003 K at 1 K/s"),
    Mistake(body("cool by 3 °C at 3 °C/ms"), "E103", 3, 21, '"°C/ms"', "cool by 3 °C at 3000 °C/s"),
    Mistake(body("cool by 3 °C at 3 °C/h"), "E103", 3, 21, '"°C/h" is not a unit', ""),
    Mistake(body("cool by 3 degF at 3 °C/s"), "E103", 3, 13, '"degF" is not a unit', ""),
    Mistake(body("cool by 3 deg C at 1 deg C/s"), "E103", 3, 13, "^^^^^ ", "cool by 3 °C at 1 °C/s"),
    Mistake(body("cool by 3 °C at 1 °C per minute"), "E104", 3, 21, "a rate", "cool by 3 °C at 1 °C/min"),
    Mistake(body("hold for 1,000 ms"), "E106", 3, 12, '"1,000" may be 1000 or 1.000', ""),
    Mistake(body("hold for 1,500 ms"), "E106", 3, 12, "thousands are not separated", ""),
    Mistake(body("hold for 0,125 s"), "E106", 3, 12, "is not a number", "hold for 0.125 s"),
    Mistake(body("hold for 2 500 ms"), "E106", 3, 12, "a space within the number", "hold for 2500 ms"),
    Mistake(body("hold for 2 77 ms"), "E102", 3, 12, "no unit", ""),
    Mistake(body(DOWN + " and hold for 4 s"), "E108", 3, 26, '"and" joins no', DOWN + "; hold for 4 s"),
    Mistake(body(DOWN + ", then hold for 4 s"), "E108", 3, 25, '"," joins no', DOWN + "; hold for 4 s"),
    Mistake(body(DOWN + " then hold for 4 s"), "E108", 3, 26, '"then" joins no', DOWN + "; hold for 4 s"),
    Mistake(body("cool by 6 °C and hold for 4 s"), "E107", 3, 16, "needed", DOWN + "; hold for 4 s"),
    Mistake(body(DOWN + " for 4 s"), "E108", 3, 26, "complete before", DOWN + "; hold for 4 s"),
    Mistake(body("hold for 4 s or 5 s"), "E108", 3, 16, "complete before", ""),
    Mistake(body("hold for 1 min 30 s"), "E108", 3, 12, "one number with one unit", "hold for 90 s"),
    Mistake(body("hold for 1 min and 30 s"), "E108", 3, 12, "one number with one unit", "hold for 90 s"),
    Mistake(body("hold for 4 s // slow"), "E105", 3, 16, 'begins with "#"', "hold for 4 s # slow"),
    Mistake(body("hold for 4 s -- slow"), "E105", 3, 16, 'begins with "#"', "hold for 4 s # slow"),
    Mistake(body("hold for 0:30"), "E106", 3, 12, "there is no clock notation", ""),
    Mistake(body("hold for 1/2 s"), "E106", 3, 12, "there is no arithmetic", "hold for 0.5 s"),
    Mistake(body("hold for 1/3 s"), "E106", 3, 12, "there is no arithmetic", ""),
    Mistake(body("hold for 2+3 s"), "E106", 3, 12, "^^^ ", ""),
    Mistake(body("hold for 1–2 s"), "E106", 3, 12, "^^^ ", ""),
    *(
        Mistake(f"cue 1\nicon x means {said} {{ hold for 1 s }}", "E117", 2, 14, "straight and double", cured)
        for said, cured in {
            "“hello there”": 'icon x means "hello there" { hold for 1 s }',
            "‘hello’": 'icon x means "hello" { hold for 1 s }',
            "'hello'": 'icon x means "hello" { hold for 1 s }',
            "“a baby’s”": 'icon x means "a baby’s" { hold for 1 s }',
            "'a b' tags “c, d”": 'icon x means "a b" tags "c, d" { hold for 1 s }',
        }.items()
    ),
    Mistake("cue 1\nset “a b” { }\n" + STEP, "E117", 2, 5, "straight and double", 'set "a b" { }'),
    Mistake("time_s,skin_C\n0,32\n1,31\n", "E101", 1, 1, "thermicon convert makes an icon"),
    Mistake("Time;Temp\n0;32.5\n1;31\n", "E101", 1, 1, "this is a table, perhaps a recording"),
    Mistake("%PDF-1.7\n1 0 obj\n", "E101", 1, 1, "this is a PDF document"),
    Mistake("<!DOCTYPE html>\n<p>cue 1\n", "E101", 1, 1, "this is a web page"),
]

SINE = "sine by 3 °C every 4 s for 12 s"

SHAPES = [
    Mistake(body("on thumb { hold for 1 s }"), "E120", 3, 3, "several elements"),
    Mistake(body("warm to baseline at 3 °C/s", DOWN), "E120", 3, 11, "is not a target", "return at 3 °C/s"),
    Mistake(body("step to baseline", DOWN, "hold for 1 s"), "E120", 3, 11, "such as: step to 32 °C"),
    Mistake(body("hold for a while"), "E106", 3, 12, 'a number is needed, not "a"'),
    Mistake(body("hold for a second"), "E106", 3, 12, 'a time such as "4 s"', "hold for 1 s"),
    Mistake(body("cool by six °C at 3 °C/s"), "E106", 3, 11, 'a number is needed, not "six"', DOWN),
    Mistake(body("cool by 6 °C at speed"), "E106", 3, 19, 'a rate such as "3 °C/s"'),
    Mistake(body("sine by 3 °C for 12 s"), "E116", 3, 16, '"every" is needed', "sine by 3 °C every 3 s for 12 s"),
    Mistake(body("sine 3 °C every 4 s for 12 s"), "E116", 3, 8, '"by" is needed', SINE),
    Mistake(body("sine by 3 °C every 4 s"), "E116", 3, 3, '"for" is missing', SINE),
    Mistake(body("sine by 3 °C each 4 s for 12 s"), "E116", 3, 16, '"every" is needed, not "each"', SINE),
    Mistake(body("sine by 3 °C at 0.25 Hz for 12 s"), "E116", 3, 16, '"every" is needed, not "at"', SINE),
    Mistake(body("sine by 3 °C every 0.25 Hz for 12 s"), "E103", 3, 27, "a wave has a period", SINE),
    Mistake(body("sine by 3 °C every 4 s for 3 periods"), "E103", 3, 32, "a wave lasts a time", SINE),
    Mistake(body("sine cool by 3 °C every 4 s for 12 s"), "E116", 3, 8, 'not "cool"', SINE + " starting cool"),
    Mistake(body(SINE + " starting hot"), "E116", 3, 44, '"warm" or "cool" is needed', SINE + " starting warm"),
    Mistake(body(SINE + " starting"), "E116", 3, 3, '"warm" or "cool" is missing', SINE + " starting warm"),
    Mistake(body(SINE + " cold"), "E116", 3, 35, '"starting" is missing', SINE + " starting cool"),
    Mistake(body(SINE + " cutt"), "E116", 3, 35, 'is expected here, not "cutt"', SINE + " cut"),
    Mistake(body(SINE + " cut starting cool"), "E214", 3, 39, 'before "cut"', SINE + " starting cool cut"),
    Mistake(body("sinus by 3 °C every 4 s for 12 s"), "E101", 3, 3, '"sinus" is not understood', SINE),
    Mistake(body("pulse by 3 °C"), "E116", 3, 3, '"for" is missing', "pulse by 3 °C for 500 ms"),
    Mistake(body("pulse by 3 °C over 1 s"), "E116", 3, 17, '"for" is needed, not "over"', "pulse by 3 °C for 1 s"),
    Mistake(body("step 3 °C; hold for 1 s"), "E116", 3, 8, 'for example: "step by', "step by 3 °C; hold for 1 s"),
    Mistake(body("step down by 3 °C; hold for 1 s"), "E116", 3, 8, 'not "down"', "step cool by 3 °C; hold for 1 s"),
    Mistake(body("step by 3 °C at 3 °C/s"), "E108", 3, 16, 'takes no "at"', "change by 3 °C at 3 °C/s"),
    Mistake(body("step cool by 3 °C for 1 s"), "E108", 3, 21, 'takes no "for"', "pulse cool by 3 °C for 1 s"),
    Mistake(body("change cool by 6 °C at 3 °C/s"), "E116", 3, 10, 'not "cool"', DOWN),
    Mistake(body(DOWN + " over 2 s"), "E108", 3, 26, 'either "at" a rate or "over" a time', DOWN),
    Mistake(body("total at 10 s", "hold for 10 s"), "E116", 3, 12, '"most" or "least" is needed', "total 10 s"),
    Mistake(body("total most 10 s", "hold for 9 s"), "E116", 3, 9, '"at" is missing before', "total at most 10 s"),
    Mistake(body("total <= 10 s", "hold for 9 s"), "E116", 3, 9, '"<=" does not fit', "total at most 10 s"),
    Mistake(body("total of 10 s", "hold for 10 s"), "E106", 3, 9, 'needed, not "of"', "total 10 s"),
    Mistake(body("play"), "E113", 3, 7, 'a name is missing after "play"'),
    Mistake(body("play y") + "\nicon yy { hold for 1 s }", "E230", 3, 8, "names an icon of this file", "play yy"),
    Mistake(body('play "y"') + "\nicon y { hold for 1 s }", "E113", 3, 8, "no quotation marks", "play y"),
    Mistake(body("play y 3 times") + "\n" + STEP.replace("x", "y"), "E108", 3, 10, "3 {", "repeat 3 { play y }"),
    Mistake(
        body("play big dip") + "\n" + STEP.replace("x", "big-dip"),
        "E113",
        3,
        12,
        "must not contain spaces",
        "play big-dip",
    ),
]


def family(parameters: str, statement: str = "change by a at 1 K/s") -> str:
    """A family whose line 2 holds the parameters, from column 8 on, and line 3 a statement."""
    return f"cue 1\nicon x({parameters} {{\n  {statement}\n  hold for 1 s\n}}"


def header(parameters: str, *rest: object) -> Mistake:
    code, column, words, *cured = rest
    suggestion = (f"icon x({cured[0]} {{" if cured[0] else "") if cured else None
    return Mistake(family(parameters), str(code), 2, int(str(column)), str(words), suggestion)


FAMILIES = [
    header("a in 1, 2 °C)", "E118", 13, "a list of values has brackets", "a in [1, 2] °C)"),
    header("a [1,2] °C)", "E118", 10, '"in" is missing before the values', "a in [1,2] °C)"),
    header("a = [1, 2] °C)", "E118", 10, '"in" is needed, not "="', "a in [1, 2] °C)"),
    header("a from 1..3 step 1 K)", "E118", 10, '"in" is needed, not "from"', "a in 1..3 step 1 K)"),
    header("a in [1 2] °C)", "E118", 16, "a comma is missing between", "a in [1, 2] °C)"),
    header("a in [1, 2, ] °C)", "E118", 20, "a value is missing after the comma", "a in [1, 2] °C)"),
    header("a in [] °C)", "E118", 14, "this list is empty"),
    header("a in °C)", "E118", 13, "neither a list nor a range"),
    header("a in)", "E118", 12, "the values are missing"),
    header("a in [1 °C, 2 °C])", "E118", 16, "the unit comes once, after the list", "a in [1, 2] °C)"),
    header("a in [1, 2], °C)", "E118", 21, "without a comma", "a in [1, 2] °C)"),
    header("a in [1, 2 °C)", "E118", 19, '"]" is missing before "°C"', "a in [1, 2] °C)"),
    header("a in [1, 2) °C)", "E118", 18, 'a list ends with "]"', "a in [1, 2] °C)"),
    header("a in (1, 2) °C)", "E118", 13, 'is written in "[ ... ]", not in "("', "a in [1, 2] °C)"),
    header("a in {1, 2} °C)", "E118", 13, 'is written in "[ ... ]", not in "{"', "a in [1, 2] °C)"),
    header("a in [1,5, 2,7] °C)", "E118", 14, 'is "1,5" one value or two?'),
    header("a in [1, 2,5] °C)", "E118", 17, "the decimal mark is a point: 2.5"),
    header("a in 0.1...5 step 0.1 K)", "E118", 16, "two dots between its ends, not three"),
    header("a in 1...3 K)", "E118", 14, "two dots between its ends, not three"),
    header("a in [1...3] K)", "E118", 15, "two dots between its ends, not three"),
    header("a in [1..3] K)", "E118", 15, "a range has no brackets"),
    header("a in [–3, 3] °C)", "E106", 14, "(U+2013) is not a minus sign", "a in [-3, 3] °C)"),
    header("a in –3..3 step 1 K)", "E106", 13, "(U+2013) is not a minus sign", "a in -3..3 step 1 K)"),
    header("a in [3] mK)", "E103", 17, '"mK" is not a unit', ""),
    header("a in [1, x] K)", "E106", 17, 'a number is needed, not "x"'),
    header("a in 1..3 °C)", "E118", 13, 'this range has no "step"', "a in 1..3 step 1 °C)"),
    header("a in 1 to 3 step 1 °C)", "E118", 15, 'a range has ".." between', "a in 1..3 step 1 °C)"),
    header("a in 1..3 by 1 °C)", "E118", 18, '"step" is needed, not "by"', "a in 1..3 step 1 °C)"),
    header("a in [1] K", "E118", 17, '")" is missing', "a in [1] K)"),
    header("a in [1] K]", "E118", 18, 'the parameters end with ")"', "a in [1] K)"),
    header("a in [1] K b in [2] K)", "E118", 19, "a comma is missing before this parameter"),
    header("a in [1] K, )", "E118", 20, "no parameter follows", "a in [1] K)"),
    header(")", "E118", 8, "there is no parameter"),
    header("a in [1] foo)", "E103", 17, '"foo" is not a unit'),
    header("a in [1] kelvin)", "E103", 17, "values without one are counts", "a in [1] K)"),
    header("my_a in [1] K)", "E113", 8, '"my_a" is not a name'),
    header("big a in [1] K)", "E113", 12, "must not contain spaces"),
    header("a in [1] K, s in [1] s)", "E113", 20, '"s" is a unit, and cannot be'),
    header("a in [1] K, a in [2] K)", "E213", 20, '"a" is already on line 2, column 8'),
    header("a in [1, 1] K)", "E213", 17, "1 is already in this list", "a in [1] K)"),
    header("a in [1e99] K)", "E218", 14, "at most 1e+09"),
    header("a in 3..1 step 1 K)", "E228", 13, "1 does not lie above 3", "a in 1..3 step 1 K)"),
    header("a in 1..3 step 0.7 K)", "E228", 13, "3 is not reached from 1 in steps of 0.7"),
    header("a in 1..3 step 0 K)", "E228", 13, "a step is positive"),
    header("a in 0..9999999 step 1e-3 K)", "E228", 13, "more than 100,000 values"),
    header("a in [1] K, b in [1] s)", "E227", 20, "b is never used"),
    header('a in [1] K) means "{b} x"', "E226", 27, '"b" is not a parameter', 'a in [1] K) means "{a} x"'),
    Mistake("cue 1\nicon x(a\n in [1] K) { " + DOWN + " }", "E118", 2, 8, "a parameter is on one line"),
    Mistake("cue 1\nicon x[a in [1] K] { warm by a at 1 K/s }", "E118", 2, 7, 'in "( ... )", not in "["'),
    Mistake('cue 1\nicon x means "y" (a in [1] K) { hold for 1 s }', "E118", 2, 18, "directly after the name"),
    Mistake(family("a in [1] K)", "change by b at 1 K/s"), "E226", 3, 13, "are: a", "change by a at 1 K/s"),
    Mistake(family("rate in [1] K/s)", "cool by 6 K at rat"), "E226", 3, 18, '"rat"', "cool by 6 K at rate"),
    Mistake(family("a in [1] K)", "warm by a K at 1 K/s"), "E104", 3, 13, "has its unit already"),
    Mistake(family("a in [1] K)", "warm by 2 a at 1 K/s"), "E103", 3, 13, "no arithmetic", "warm by a at 1 K/s"),
    Mistake(family("a in [1] K)", "warm by 2*a at 1 K/s"), "E106", 3, 11, "^^^ ", ""),
    Mistake(family("a in [1] K)", "warm by a*2 at 1 K/s"), "E106", 3, 11, "there is no arithmetic", ""),
    Mistake(family("a in [1] K)", "warm by a/2 at 1 K/s"), "E106", 3, 11, "there is no arithmetic", ""),
    Mistake(family("a in 1...3 K)") + "\nicon y { play x_a=1 }", "E118", 2, 14, "not three"),
    Mistake(family("a in [1] K)", "warm by -a at 1 K/s"), "E105", 3, 11, "no sign before it"),
    Mistake(
        family("a in [1] K)", "warm by {a} at 1 K/s"), "E105", 3, 11, "braces are not allowed", "warm by a at 1 K/s"
    ),
    Mistake(family("a in [1] K)", "hold for a"), "E104", 3, 12, "a is in K; a time is needed here"),
    Mistake(family("a in [1])", "hold for a"), "E104", 3, 12, "a has no unit; a time is needed"),
    Mistake(family("n in [1, 2] s)", "repeat n { hold for 1 s }"), "E104", 3, 10, "a count is needed here"),
    Mistake(family("n in [1, 2.5])", "repeat n { hold for 1 s }"), "E207", 3, 10, "2.5 is not a positive whole"),
    Mistake(family("n in [1, 2])", "repeat m { hold for 1 s }"), "E226", 3, 10, '"m" is not a parameter'),
    Mistake(family("a in [0, 1] K)", "step by a"), "E202", 3, 11, "its values: a in [0, 1] K"),
    Mistake(family("a in [-1, 1] K)", "sine by a every 1 s for 1 s"), "E202", 3, 11, "an amplitude is positive"),
    Mistake(family("a in [-6, 6] K)", "warm by a at 1 K/s"), "E202", 3, 11, "a change has a positive size"),
    Mistake(family("a in 1..40 step 1 K)"), "E219", 3, 13, "leads to 61 °C (with a=29, one of 12 such members of 40)"),
    Mistake(family("a in [30, 34] °C)", "warm to a at 1 K/s"), "E201", 3, 11, "30 °C is below the 32 °C"),
    Mistake(family("t in [1, 2] s)", "hold for t; total 2 s"), "E222", 3, 21, "with t=2"),
    Mistake(family("t in [1, 5, 4] s)", "hold for t; total at most 2 s"), "E222", 3, 29, "with t=5, one of"),
    Mistake(family("t in [3, 5, 4] s)", "hold for t; total 2 s"), "E222", 3, 21, "leaves no member out"),
    Mistake(family("a in [1, 2] K)") + "\nicon y { play x }", "E230", 6, 15, "family of 2", "icon y { play x_a=1 }"),
    Mistake(family("a in [1, 2] K)") + "\nicon y { play x_a=3 }", "E230", 6, 15, "this is not one of them"),
    Mistake(family("a in [1, 2] K)") + "\n" + STEP.replace("x", "x_a=1"), "E211", 6, 6, "a member of family x"),
    Mistake("cue 1\nicon y_a=1(a in [1] K) { warm by a at 1 K/s }", "E113", 2, 6, "a name for a member"),
    Mistake(
        family("a in 0.001..3 step 1e-3 K, b in 1..10 step 1e-3 s)", "warm by a over b"),
        "E231",
        2,
        7,
        "27,003,000 members",
    ),
]

MEANING = [
    Mistake("cue 1\nset a { site thenar }\n", "E008", 2, 21, "ends without an icon"),
    Mistake(STEP, "E009", 1, 1, "version of the language is missing", "cue 1"),
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
    Mistake(body("repeat 99999999999 { hold for 1 s }"), "E207", 3, 10, "too large"),
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
    Mistake("cue 1\nset a { }\nset b { }\n" + STEP, "E212", 3, 1, "already on line 2"),
    Mistake("cue 1\nset a { site b\n site c }\n" + STEP, "E213", 3, 2, '"site" is already on line 2'),
    Mistake('cue 1\nicon x by "a" by "b" { hold for 1 s }', "E213", 2, 15, '"by" is already on line 2'),
    Mistake("cue 1\ncue 1\n" + STEP, "E213", 2, 1, "already on line 1"),
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
    Mistake(
        body("step cool to 36 °C; hold for 1 s"), "E201", 3, 16, "above the 32 °C", "step warm to 36 °C; hold for 1 s"
    ),
    Mistake(body("step by 0 K; hold for 1 s"), "E202", 3, 11, "a change must not be zero"),
    Mistake(body("sine by -3 °C every 4 s for 12 s"), "E202", 3, 11, "an amplitude is positive", SINE),
    Mistake(body("sine by 3 A every 4 s for 12 s"), "E210", 3, 11, "controls the skin"),
    Mistake(AMPS + "step by 1 A; sine by 1 A every 1 s for 2 s starting cool\n}", "E210", 4, 55, '"up" or "down"'),
    Mistake(body("total 10 s; hold for 3 s"), "E222", 3, 9, "it is 7 s too short", "total 3 s; hold for 3 s"),
    Mistake(body("total at most 2 s", "hold for 3 s"), "E222", 3, 17, "it is 1 s too long", "total at most 3 s"),
    Mistake(body("step by 3 °C"), "E223", 2, 6, "a step takes no time"),
    Mistake(body("play y", DOWN) + "\n" + STEP.replace("x", "y"), "E224", 3, 3, "y begins at baseline"),
    Mistake(body("sine by 3 °C every 4 s for 11 s"), "E225", 3, 30, "2.75 periods", SINE),
    Mistake(body("repeat 2 { hold for 1 s; total 2 s }"), "E229", 3, 28, "the whole icon, not a repeat"),
    Mistake(body("play unknwon"), "E230", 3, 8, 'no icon is called "unknwon"'),
    Mistake(body("play x"), "E232", 3, 8, "x plays x"),
    Mistake(body("play y") + "\nicon y { play x }", "E232", 5, 15, "x plays y plays x"),
]

ALL = [*SYNTAX, *NOTATION, *SHAPES, *FAMILIES, *MEANING]
