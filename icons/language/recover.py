"""Error recovery: a parse of the whole file that continues after every error."""

import re
from collections.abc import Iterator, Sequence
from functools import cache, lru_cache
from itertools import islice
from typing import TYPE_CHECKING, Any

from thermicon.base.files.kinds_of_files import other_kind

from ..model.errors import MOST_ERRORS, MOST_READ
from ..model.words import VOCABULARY
from .diagnose import diagnose
from .failed_statement import FailedStatement
from .grammar import grammar
from .source import Finding, Patch, Piece, Source

if TYPE_CHECKING:
    from lark import Token, Tree

DEEPEST = 20
_OPENERS = {"ICON": "icon", "SET": "set", **dict.fromkeys(("REPEAT", "ON", "TOGETHER", "ALONG"), "repeat")}
_BRACED = re.compile(r"\{[ \t]*([^\W\d_][\w-]*)[ \t]*\}")
_CELL = re.compile(r"[-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?")
_LISTED = re.compile(r"[\w .-]+([,\t][\w .-]+)+")
_NAMED = re.compile(r"icon\s+([^\W\d][\w-]*)")
# Characters of a line that are looked at: a file may be one endless line.
_WIDE = 2000
# How files of other formats begin, in lower case.
_FORMATS = {
    "%pdf-": "this is a PDF document",
    "{\\rtf": "this is a document of a word processor (RTF)",
    "<!doctype": "this is a web page",
    "<html": "this is a web page",
    "<?xml": "this is XML",
    '{"': "this is JSON, which thermicon writes for other programs",
}
_HEADER = re.compile(r"(icon|set)\b[^\n;{}]*\{")


def read(source: Source) -> tuple["Tree[Any]", tuple[Finding, ...], int]:
    """The tree of a source, with BROKEN for what could not be read, the errors by offset, and how many more."""
    return _Reader(source).run()


def other_format(source: Source) -> tuple[str, str] | None:
    """The format of a text that is clearly not a cue, with advice, reported once instead of line by line."""
    rows = list(islice((line for line in source.lines if line.strip() and not line.startswith(("#", "sep="))), 2))
    if not rows:
        return None
    head = "".join(row[:_WIDE].strip() for row in rows).casefold()
    if head.startswith("cue"):
        return None
    if found := other_kind(source.text, "cue file"):
        return found
    what = next((what for mark, what in _FORMATS.items() if head.startswith(mark)), None)
    help = "a cue file is plain text; save it as such, in UTF-8"
    tables = [[cell.strip(' "') for cell in re.split(r"[,;\t]", row[:_WIDE])] for row in rows]
    if any(len(cells) > 1 and all(map(_CELL.fullmatch, cells)) for cells in tables) or (
        "time_s" in tables[0] or all(_LISTED.fullmatch(row[:_WIDE]) for row in rows)
    ):
        what = "this is a table, perhaps a recording"
        help = "thermicon convert makes an icon of a recording in CSV"
        if {"presented", "responded", "kind"}.intersection(tables[0]):
            what, help = "this is a table of answers or measurements", "thermicon pilot takes it beside a set of icons"
    return None if what is None else (what, help)


class _Reader:
    def __init__(self, source: Source) -> None:
        self.source = source
        self.text = source.text
        self.findings: list[Finding] = []
        self.more = 0
        self.blocks: list[tuple[str, int, int]] = []
        self.opener = "icon"
        self.begin = 0
        self.line = (0, 0)
        self.fresh = True
        self.heading = self.listing = False
        # The parameters of the icon that is being read; None when they could not be.
        self.names: set[str] | None = set()
        self.last = ""
        self.parser: Any = grammar().parse_interactive(source.text)
        self.tokens: Iterator[Token] = iter(())

    def run(self) -> tuple["Tree[Any]", tuple[Finding, ...], int]:
        from lark.exceptions import UnexpectedCharacters, UnexpectedToken

        self.jump(0)
        while len(self.findings) + self.more < MOST_READ:
            try:
                token = next(self.tokens, None)
            except (UnexpectedCharacters, UnexpectedToken) as error:
                self.recover(self.seen(error.pos_in_stream or 0))
                continue
            if token is None:
                break
            start = self.seen(token.start_pos or 0)
            if self.runs_on(token) or self.unnamed(token):
                self.recover(start)
            elif token.type == "LBRACE" and len(self.blocks) >= DEEPEST:
                what = f"blocks are nested more than {DEEPEST} deep"
                self.report(Finding("E115", start, start + 1, what, "repeat counts multiply: merge inner repeats"))
                self.feed("LBRACE", "BROKEN", "RBRACE", at=start)
                self.jump(min(self.source.close(start) + 1, len(self.text) - 1))
            else:
                try:
                    self.parser.feed_token(token)
                except UnexpectedToken:
                    self.recover(start)
                else:
                    self.follow(token.type, start)
                    self.collect(token)
        self.finish()
        return self.parser.feed_eof(), tuple(self.findings), self.more

    # -- following the text ---------------------------------------------------------------------------------------

    def seen(self, offset: int) -> int:
        if self.fresh and self.text[offset] != "\n":
            self.begin, self.fresh = offset, False
        return offset

    def runs_on(self, token: "Token") -> bool:
        # The lexer takes "to" out of "tox" and "1" out of "1,5": a reader would not.
        if token.type == "_NEWLINE":
            return False
        after = self.text[token.end_pos or 0]
        if token.type == "NUMBER":
            if self.listing:  # the values of a parameter: 1..3, or [1,2]
                return after == "_" or after.isdigit()
            return after in ".,_" or after.isdigit()
        last = token[-1]
        return (last.isalnum() or last == "-") and (after.isalnum() or after in "_-/°")

    def unnamed(self, token: "Token") -> bool:
        # The grammar lets any name stand for a number; only the names of parameters do.
        if token.type != "NAME" or self.names is None or self.listing or not self.blocks:
            return False
        return token not in self.names and self.takes("NUMBER")

    def collect(self, token: "Token") -> None:
        """Keep the names between the parentheses of a family."""
        if token.type == "ICON":
            self.names = set()
        elif token.type in ("LPAR", "RPAR"):
            self.listing = token.type == "LPAR"
        elif self.listing and token.type == "IN" and self.names is not None:
            self.names.add(self.last)
        self.last = str(token)

    def follow(self, kind: str, offset: int) -> None:
        if kind in _OPENERS:
            self.opener = _OPENERS[kind]
            self.heading = True
        elif kind == "LBRACE":
            self.blocks.append((self.opener, self.begin, offset))
            self.fresh, self.heading = True, False
        elif kind == "RBRACE":
            self.blocks.pop()
        elif kind in ("_NEWLINE", "SEMICOLON") and not self.heading:
            self.fresh = True

    def jump(self, offset: int) -> None:
        self.parser.lexer_thread.state.line_ctr.char_pos = offset
        self.tokens = self.parser.lexer_thread.lex(self.parser.parser_state)

    def feed(self, *kinds: str, at: int, text: str = "") -> None:
        from lark import Token

        for kind in kinds:
            self.parser.feed_token(Token(kind, text, at, 1, 1, 1, 1, at))
            self.last = "}" if kind == "RBRACE" else ""
            self.follow(kind, at)

    # -- behind an error ------------------------------------------------------------------------------------------

    def recover(self, at: int) -> None:
        where = self.blocks[-1][0] if self.blocks else "file"
        if self.text[at] == "}" and not self.blocks:
            self.report(
                Finding("E110", at, at + 1, "no block is open here", 'remove this "}"', (Patch(at, at + 1, ""),))
            )
            self.jump(at + 1)
            return
        if self.blocks and at == self.begin and _HEADER.match(self.text, at):
            self.unclosed(at)
            self.feed(*["RBRACE"] * len(self.blocks), "_NEWLINE", at=at)
            self.fresh = True
            self.jump(at)
            return
        if not self.blocks and not self.listing and self.takes("LBRACE") and _HEADER.match(self.text, at):
            end = self.text.rfind("\n", self.begin, at)
            if end > self.begin:  # the next block begins on a line of its own, before this one was opened
                place = self.begin, self.begin + len(self.text[self.begin : end].split("\n")[0])
                what = 'no "{" opens the block after this'
                self.report(Finding("E114", *place, what, 'statements and settings are written in "{ ... }"'))
                self.resume(end, "file")
                return
        braces = self.listing and self.text[at] == "{" and self.takes("LSQB")
        pieces = self.source.pieces(self.begin, at, self.listing, braces)
        stop = self.source.stop_listing(at, braces) if self.listing else self.stop(at)
        index = next((i for i, piece in enumerate(pieces) if piece.end > at and piece.start < stop), len(pieces))
        word = pieces[index].text if index < len(pieces) else ""
        header = self.takes("LBRACE")
        inside = self.opener if header else where
        if self.listing and self.text[at] == "\n":
            pieces.insert(index, Piece("newline", "", at, at))
        closed = self.last == "}"  # a whole block stands before: what was read of it stays
        braced = None if header or self.listing or closed else _BRACED.match(self.text, at)
        if braced and where in ("icon", "repeat"):
            help = "a parameter is written without braces in statements, and with braces in a text"
            edit = Patch(at, braced.end(), braced[1])
            self.report(Finding("E105", at, braced.end(), "braces are not allowed here", help, (edit,)))
            self.resume(self.stop(braced.end()), where)
            return
        code = self.report_statement(pieces, index, at, where)
        if header and word in VOCABULARY[inside] and word not in VOCABULARY["header"]:
            self.feed("LBRACE", at=at)
            self.jump(at)
            return
        # Complete, but something else was meant: kept, it would draw further errors.
        first = pieces[0].text if pieces else ""
        spoilt = code == "E104" or (first in ("play", "step", "total") and word not in VOCABULARY[where])
        if not header and not self.listing and self.takes("_NEWLINE") and (closed or not spoilt):
            # The statement is complete: keep it, and read what follows as if it stood on a line of its own.
            begin = self.begin
            self.feed("_NEWLINE", at=at)
            self.begin, self.fresh = at, False
            if at != begin and (word in VOCABULARY[where] or self.text[stop] != "{"):
                self.jump(at if word in VOCABULARY[where] else stop)
                return
        self.resume(stop, where)

    def resume(self, stop: int, where: str) -> None:
        """Put BROKEN in the place of the statement, or of the header of a block, and go on at ``stop``."""
        state = self.parser.parser_state
        while not self.takes("BROKEN"):  # what was read of the broken part goes
            state.state_stack.pop()
            state.value_stack.pop()
        header = not self.takes("SEMICOLON")  # headers may go on over line ends, statements end there
        if header and (self.opener == "icon" or self.listing):
            self.names = None
        self.listing = False
        brace = stop < len(self.text) and self.text[stop] == "{"
        if header:
            # A name that can be read stays, so that a ``play`` of it draws no further error.
            named = _NAMED.match(self.text, self.begin)
            self.feed("BROKEN", at=self.begin, text=named[1] if named else "")
            if not brace and self.text[self.begin : stop].rstrip().endswith("{"):
                self.feed("LBRACE", at=stop - 1)  # swallowed by a text that was never closed
            elif not brace:
                self.feed("LBRACE", "BROKEN", "RBRACE", at=self.begin)
        elif brace and where == "set":
            self.feed("BROKEN", at=self.begin)
            stop = min(self.source.close(stop) + 1, len(self.text) - 1)
        elif brace:
            opener = "REPEAT" if self.blocks else ("SET" if self.text.startswith("se", self.begin) else "ICON")
            self.names = self.names if self.blocks else None
            self.feed(opener, "BROKEN", at=self.begin)
        else:
            self.feed("BROKEN", at=self.begin)
        self.jump(stop)

    def stop(self, at: int) -> int:
        # Remembered, as many errors may share one endless line.
        if not self.line[0] <= at <= self.line[1] or self.line[1] == 0:
            self.line = (at, self.source.stop(at))
        return self.line[1]

    def takes(self, kind: str) -> bool:
        return _takes(self.parser.parser_state.state_stack, kind)

    def finish(self) -> None:
        end = len(self.text) - 1
        if len(self.findings) + self.more >= MOST_READ:
            self.feed(*["LBRACE"] * self.takes("LBRACE"), "_NEWLINE", at=end)
            self.feed(*["RBRACE"] * len(self.blocks), at=end)
            return
        if self.takes("LBRACE") or self.listing:
            pieces = self.source.pieces(self.begin, end, self.listing)
            self.report_statement(pieces, len(pieces), end, "file")
            self.resume(end, "file")
            self.feed("_NEWLINE", at=end)
        if self.blocks:
            self.unclosed(end)
            self.feed(*["RBRACE"] * len(self.blocks), at=end)

    # -- reporting ------------------------------------------------------------------------------------------------

    def unclosed(self, at: int) -> None:
        _, start, brace = self.blocks[0]
        line, _ = self.source.place(at)
        where = "the end of the file" if at >= len(self.text) - 1 else f"line {line}"
        what = f'this block still lacks a "}}" at {where}'
        self.report(Finding("E109", start, brace + 1, what, 'every "{" needs its own "}"; icons cannot be nested'))

    def report(self, finding: Finding) -> None:
        if len(self.findings) < MOST_ERRORS:
            self.findings.append(finding)
        else:
            self.more += 1

    def report_statement(self, pieces: list[Piece], index: int, at: int, where: str) -> str:
        """Add what is wrong with a statement; returns the code."""
        if len(self.findings) >= MOST_ERRORS:
            self.more += 1
            return ""
        accepts = _accepted(tuple(self.parser.parser_state.state_stack))
        finding = diagnose(FailedStatement(pieces, index, at, accepts, where, self.names, self.listing))
        self.findings.append(finding)
        return finding.code


@lru_cache(maxsize=4096)
def _accepted(stack: tuple[int, ...]) -> frozenset[str]:
    """Kinds of tokens that a stack of parser states could take: as lark's ``accepts``, without copies of the parser."""
    entries = _states()[stack[-1]]
    return frozenset(kind for kind in entries if kind.isupper() and _takes(stack, kind))


def _takes(stack: Sequence[int], kind: str) -> bool:
    states = _states()
    left = list(stack)
    while (entry := states[left[-1]].get(kind)) is not None:
        rule = entry[1]
        if isinstance(rule, int):
            return True
        if rule.expansion:
            del left[-len(rule.expansion) :]
        left.append(states[left[-1]][rule.origin.name][1])
    return False


@cache
def _states() -> Any:
    return grammar().parse_interactive("").parser_state.parse_conf.states
