"""Where the values of a JSON text stand, so that errors can point at them; and JSON read without surprises."""

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NoReturn

from ..language.source import MOST_JSON_BYTES, Finding, Source
from ..model.errors import CueErrors, whole_file

Key = str | int
Path = tuple[Key, ...]
Place = tuple[int, int]
DEEPEST_JSON = 100
_NO_NUMBER = re.compile(r"-?(?:NaN|Infinity|[0-9]{1000,}.*)")
_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[{}\[\],:]|[^\s{}\[\],:"]+')


@dataclass(slots=True)
class Places:
    """The offsets of every value and of every key, by path; and the keys that stand twice in one object."""

    values: dict[Path, Place] = field(default_factory=dict)
    keys: dict[Path, Place] = field(default_factory=dict)
    twice: list[Path] = field(default_factory=list)
    deepest: int = 0
    starts: dict[int, Path] = field(default_factory=dict)

    def of(self, path: Path, key: bool = False) -> Place:
        """Return the place of a value, or of its key; of what encloses it when it is not there itself."""
        if key and path in self.keys:
            return self.keys[path]
        while path and path not in self.values:
            path = path[:-1]
        start, end = self.values.get(path, (0, 1))
        return start, end

    def path(self, offset: int) -> Path:
        """Return the path of the value that begins at an offset; that of the whole where none does."""
        if not self.starts:
            self.starts.update({start: path for path, (start, _) in self.values.items()})
        return self.starts.get(offset, ())


def read_json(source: Source) -> tuple[Any, Places]:
    """Return the value of a JSON text with the places of its parts; CueErrors E011 when the text is not JSON.

    >>> read_json(Source("a.json", '{"a": [1, 2]}'))[1].of(("a", 1))
    (10, 11)
    """
    try:
        document = json.loads(source.text, parse_constant=_no_constant)
    except RecursionError:
        raise _too_deep(source) from None
    except json.JSONDecodeError as error:
        raise _fault(source, error.pos, *_in_words(error, source.text)) from None
    except ValueError:  # NaN and its kin, or a number of thousands of digits
        start, end = next(place for token, *place in _tokens(source.text) if _NO_NUMBER.fullmatch(token))
        what = "this is not a number in JSON" if end - start < 10 else "a number has a few digits, not thousands"
        finding = Finding("E011", start, end, what, "numbers are written as 6, 0.5 or 1e-3")
        raise CueErrors((source.error(finding),)) from None
    places = find_places(source.text)
    if places.deepest > DEEPEST_JSON:
        raise _too_deep(source)
    if places.twice:
        found = tuple(
            source.error(Finding("E011", *places.keys[path], f'the key "{path[-1]}" stands twice', "keep one of them"))
            for path in places.twice[:100]
        )
        raise CueErrors(found, len(places.twice) - len(found))
    return document, places


def find_places(text: str) -> Places:
    """Return the places of all parts of a text that is known to be JSON."""
    found = Places()
    path: list[Key] = []
    starts: list[int] = []
    wants_key: list[bool] = []
    for token, start, end in _tokens(text):
        if token in "{[":
            starts.append(start)
            wants_key.append(token == "{")
            path.append(0 if token == "[" else "")
            found.deepest = max(found.deepest, len(path))
        elif token in "}]":
            path.pop()
            wants_key.pop()
            found.values[tuple(path)] = (starts.pop(), end)
        elif token == ",":
            last = path[-1]
            wants_key[-1] = isinstance(last, str)
            path[-1] = last if isinstance(last, str) else last + 1
        elif token != ":" and wants_key and wants_key[-1]:
            path[-1], wants_key[-1] = json.loads(token), False
            here = tuple(path)
            if here in found.keys:
                found.twice.append(here)
            found.keys[here] = (start, end)
        elif token != ":":
            found.values[tuple(path)] = (start, end)
    return found


def path_text(path: Path) -> str:
    """Return a path as people write it.

    >>> path_text(("icons", 0, "statements", 2, "by_K"))
    'icons[0].statements[2].by_K'
    """
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return text.removeprefix(".") or "the file"


def decode_json(data: str | bytes, file: str) -> str:
    """Return the text of a JSON file; CueErrors when it is too large, empty, or not UTF-8."""
    if len(data) > MOST_JSON_BYTES:
        help = f"a cue set in JSON has at most {MOST_JSON_BYTES:,} bytes; split the set"
        raise whole_file("E004", file, f"{len(data):,} bytes", help)
    if isinstance(data, bytes):
        try:
            data = data.decode("utf-8")
        except UnicodeDecodeError as error:
            what = f"byte 0x{error.object[error.start]:02X} at byte offset {error.start} is not UTF-8"
            raise whole_file("E007", file, what, "save the file as UTF-8 in your editor") from None
    text = data.removeprefix("\ufeff")
    if not text.strip():
        raise whole_file("E005", file, "nothing but white space", "thermicon convert writes sets as JSON")
    return text


def _tokens(text: str) -> Iterator[tuple[str, int, int]]:
    return ((match.group(), match.start(), match.end()) for match in _TOKEN.finditer(text))


def _no_constant(name: str) -> NoReturn:
    raise ValueError(name)


def _fault(source: Source, offset: int, what: str, help: str) -> CueErrors:
    return CueErrors((source.error(Finding("E011", offset, offset + 1, what, help)),))


def _too_deep(source: Source) -> CueErrors:
    return whole_file("E115", source.file, "objects and lists are nested too deeply", "a cue set needs fewer levels")


def _in_words(error: json.JSONDecodeError, text: str) -> tuple[str, str]:
    if error.pos >= len(text.rstrip()):
        return "the text ends too soon", "a bracket, a brace or a quotation mark is never closed"
    if text[error.pos] == "'":
        return "texts and keys stand in double quotation marks", "write \"name\", not 'name'"
    if error.msg == "Invalid control character at" and text[error.pos] == "\n":
        return "a text is not closed where its line ends", 'add the closing ", or write \\n for a line break'
    said = {
        "Expecting value": ("a value is needed here", 'a value is a number, "a text", true, false, [ ... ] or { ... }'),
        "Expecting ',' delimiter": ("a comma is missing before this", "commas stand between values"),
        "Expecting ':' delimiter": ("a colon is missing before this", 'a key is followed by a colon: "by_K": 6'),
        "Expecting property name enclosed in double quotes": (
            'a key in double quotation marks is needed here, such as "by_K"',
            "behind the last value of an object stands no comma, and JSON has no comments",
        ),
        "Illegal trailing comma before end of object": ("no comma stands behind the last value", "remove it"),
        "Illegal trailing comma before end of array": ("no comma stands behind the last value", "remove it"),
        "Extra data": ("there is text after the end of the file's object", "a file is one object: { ... }"),
        "Invalid control character at": ("a text holds a control character", "remove it, or write it as \\u0007"),
    }
    return said.get(error.msg, (error.msg[:1].lower() + error.msg[1:], "JSON is described at json.org"))
