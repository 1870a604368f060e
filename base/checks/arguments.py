"""Checks of the arguments of public functions against their annotations."""

import builtins
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import update_wrapper
from importlib import import_module
from itertools import product
from numbers import Integral, Real
from pathlib import Path
from traceback import walk_tb
from types import FunctionType, MappingProxyType, NoneType, UnionType
from typing import Any, Literal, Self, TypeVar, Union, cast, get_args, get_origin, is_typeddict

from ..words.clean_text import clean
from ..words.near_words import did_you_mean

F = TypeVar("F", bound=Callable[..., Any])
IN_PYTHON = {"intervals": "parameters"}
"""Options of the command line that have another name as arguments."""
LONGEST = 60
WORDS = {str: "a text", bytes: "bytes", Path: "a path", float: "a number", int: "a whole number",
         bool: "True or False", NoneType: "None", Callable: "a function"}  # fmt: skip
DOORS: dict[str, None] = {}
"""Packages whose names annotations use, in the order in which they came."""
MADE_BY: dict[str, str] = {}
"""How an object of a class is made, for those who gave something else."""


def register(*doors: str, **made_by: str) -> None:
    """Look names of annotations up at front doors, and tell people how objects of their classes are made.

    A package registers itself and those upstream whose names it uses, when it is imported.
    """
    DOORS.update(dict.fromkeys(doors))
    MADE_BY.update(made_by)


Changes = Mapping[str, Any]
"""What to change, by the names of arguments in Python, and to what."""


def advised(text: str, changes: Changes, writers: Mapping[str, Callable[[Any], str]] = MappingProxyType({})) -> str:
    """A sentence with the changes that would help, each by its writer where it is read, or as in Python."""
    ways = [writers[name](to) if name in writers else f"{name}={to!r}" for name, to in changes.items()]
    return f"{text} ({', '.join(ways)})" if ways else text


class InputError(ValueError):
    """Bad input, reported in plain words (what, where, value, limit, unit, cure) without control characters.

    `text` is the sentence, `changes` what would help.

    Examples
    --------
    >>> str(InputError("hand.toml: contact.area_cm2 = 0; it must be above 0 cm²"))
    'hand.toml: contact.area_cm2 = 0; it must be above 0 cm²'
    """

    changes: Changes = MappingProxyType({})

    def __init__(self, *texts: object) -> None:
        super().__init__(*(clean(text) if isinstance(text, str) else text for text in texts))

    @property
    def text(self) -> str:
        """The sentence without the changes."""
        return super().__str__()

    def to(self, **changes: object) -> Self:
        """The same error with the changes that would help."""
        self.changes = changes
        return self

    def __str__(self) -> str:
        return advised(self.text, self.changes)


def checked(function: F) -> F:
    """Refuse arguments of another type than the annotation of a function, or of a class's fields, with an `InputError`.

    >>> @checked
    ... def cooled(by: float) -> float:
    ...     return -by
    >>> cooled("6 °C")
    Traceback (most recent call last):
    ...
    thermicon.base.checks.arguments.InputError: cooled: by takes a number, not '6 °C'
    """
    if isinstance(function, type):
        setattr(function, "__init__", checked(vars(function)["__init__"]))  # noqa: B010
        return function
    own, hints, error, walk = cast(FunctionType, function), dict[str, Any](), InputError, walk_tb
    place = own.__qualname__.removesuffix(".__init__")
    names = own.__code__.co_varnames[: own.__code__.co_argcount]
    rest = own.__code__.co_varnames[own.__code__.co_argcount + own.__code__.co_kwonlyargcount :][:1]

    def check(args: tuple[Any, ...], given: dict[str, Any]) -> None:
        if not hints:
            hints.update(_hints(own))
        values = [*zip(names, args, strict=False), *product(rest, args[len(names) :])]
        for name, value in (*values, *given.items()):
            if name not in hints and name in given:
                other = IN_PYTHON.get(name)
                cure = f"is called {other} in Python" if other else f"is not an argument; {did_you_mean(name, hints)}"
                raise InputError(f"{place}: {name} {cure}")
            if not _fits(value, hints.get(name, Any)):
                raise InputError(f"{place}: {name} takes {_words(hints[name])}, {_refused(name, value, hints[name])}")

    def call(*args: Any, **given: Any) -> Any:
        check(args, given)
        try:
            return function(*args, **given)
        except ValueError as wrong:
            theirs = {getattr(each, "__code__", None) for each in (*args, *given.values())}
            if type(wrong) is not ValueError or any(frame.f_code in theirs for frame, _ in walk(wrong.__traceback__)):
                raise  # as a function raised it that was handed in
            raise error(f"{place}: {wrong}") from wrong

    # With the function's own globals: doctest looks by them for the examples of a module.
    made = FunctionType(call.__code__, own.__globals__, own.__name__, None, call.__closure__)
    return cast(F, update_wrapper(made, function))


class _Names(dict[str, Any]):
    """Names that annotations use; those imported for type checkers alone are looked up at the front doors."""

    def __missing__(self, name: str) -> Any:
        doors = map(import_module, DOORS)
        found = next((getattr(door, name) for door in doors if name in door.__all__), Any)
        return import_module("pandas") if name == "pd" else found


def _hints(function: Any) -> dict[str, Any]:
    """The annotation of each argument; of keywords that a typed dictionary describes, each."""
    found, names = dict[str, Any](), _Names({**vars(builtins), **vars(sys.modules[function.__module__])})
    for name, text in function.__annotations__.items():
        text = getattr(text, "__forward_arg__", text)
        hint = eval(text, {}, names) if isinstance(text, str) else text
        words = [each for each in get_args(hint) if is_typeddict(each)]
        found |= _hints(words[0]) if words else {} if name == "return" else {name: hint}
    return found


def _fits(value: Any, hint: Any) -> bool:
    """Whether a value is of the type that an annotation names; an annotation that is not understood takes anything."""
    origin, inner = get_origin(hint) or hint, get_args(hint)
    if origin in (Union, UnionType):
        return _numeric(value) if _is_array(inner) else any(_fits(value, each) for each in inner)
    if origin is Literal:
        return isinstance(value, str) and value in inner
    if origin in (int, float):
        return isinstance(value, Integral if origin is int else Real) and not isinstance(value, bool)
    if origin in (Sequence, Iterable, tuple):
        some = hasattr(value, "__getitem__" if origin is Sequence else "__iter__")
        if not some or isinstance(value, str | bytes | Mapping) or getattr(value, "ndim", 1) != 1:
            return False
        if iter(value) is value:
            return True
        each = {type(one): one for one in value}.values() if isinstance(inner[0], type) else value  # may be 100,000
        return all(_fits(one, inner[0]) for one in each)
    if origin is Callable or origin is Any or not isinstance(origin, type):
        return origin is not Callable or callable(value)
    return isinstance(value, origin)


def _is_array(inner: tuple[Any, ...]) -> bool:
    return any(getattr(each, "__module__", "").startswith("numpy._typing") for each in inner)


def _numeric(value: Any) -> bool:
    try:
        import_module("numpy").asarray(value, float)
        return not isinstance(value, str | bytes | NoneType)
    except (TypeError, ValueError):
        return False


def _words(hint: Any) -> str:
    origin, inner = get_origin(hint) or hint, get_args(hint)
    if origin in (Union, UnionType):
        text = "an array of numbers" if _is_array(inner) else _or(dict.fromkeys(map(_words, inner)))
        return text.replace("a text", "a name") if Path in inner else text
    if origin is Literal:
        return _or(map(repr, inner))
    if origin in (Sequence, Iterable, tuple):
        return f"a list, each {_words(inner[0])}"
    name = getattr(origin, "__name__", str(origin))
    made = f" such as {MADE_BY[name]}" if name in MADE_BY else ""
    return WORDS.get(origin) or _a(name) + made


def _or(parts: Iterable[str]) -> str:
    *most, last = parts
    return f"{', '.join(most)} or {last}" if most else last


def _a(name: str) -> str:
    return f"a{'n' if name[0] in 'AEIO' else ''} {name}"


def _refused(name: str, value: Any, hint: Any) -> str:
    """The value that was given instead; of a list, its first item that does not fit."""
    inner = [get_args(each)[0] for each in (hint, *get_args(hint)) if get_origin(each) in (Sequence, Iterable, tuple)]
    for place, each in enumerate(value if inner and isinstance(value, list | tuple) else ()):
        if not _fits(each, inner[0]):
            return f"but {name}[{place}] is {_shown(each)}"
    return f"not {_shown(value)}"


def _shown(value: object) -> str:
    if isinstance(value, str | bytes | bool | int | float | list | tuple | NoneType):
        text = repr(value)
        return text if len(text) <= LONGEST else f"{text[: LONGEST - 2]}…{text[-1]}"
    return f"the class {value.__name__}" if isinstance(value, type) else _a(type(value).__name__)
