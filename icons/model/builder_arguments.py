"""Arguments of the statement builders, checked as the language checks its numbers; messages name call and argument."""

from collections.abc import Callable, Mapping
from inspect import cleandoc
from numbers import Real
from typing import TypeVar

from .units import UNITS, Kind
from .value_limits import fault

Builder = TypeVar("Builder", bound=Callable[..., object])


def documented(sections: str) -> Callable[[Builder], Builder]:
    """Return a decorator that puts sections before the examples of a docstring, for builders of one signature."""

    def add(builder: Builder) -> Builder:
        summary, _, examples = cleandoc(builder.__doc__ or "").partition("Examples\n")
        builder.__doc__ = f"{summary}{sections}\nExamples\n{examples}"
        return builder

    return add


def one_of(call: str, given: Mapping[str, object]) -> None:
    """Raise ValueError unless exactly one of these arguments of a call is given."""
    names = [name for name, value in given.items() if value is not None]
    if not names:
        *most, last = given
        raise ValueError(f"{call}() needs either {', '.join(most)} or {last}")
    if len(names) > 1:
        raise ValueError(f"{call}() takes only one of {', '.join(names[:-1])} and {names[-1]}")


def number(call: str, name: str, value: float | None, kind: Kind) -> float | None:
    """Return an argument as a float, None as it is; ValueError for what this kind of quantity may not be."""
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, Real):
        unit = next(iter(UNITS[kind]))
        raise ValueError(f"{call}({name}={value!r}): a number is needed{f', in {unit}' if unit else ''}")
    if problem := fault(float(value), kind):
        raise ValueError(f"{call}({name}={value!r}): {problem[1]}")
    return float(value)


def given(call: str, name: str, value: float, kind: Kind) -> float:
    """As ``number``, for an argument that may not be None."""
    checked = number(call, name, value, kind)
    if checked is None:
        raise ValueError(f"{call}() needs {name}")
    return checked


def amperes(call: str, value: float | None) -> float | None:
    """Return the argument ``by_A`` as a float, None as it is; ValueError for 0 and beyond ±20 A."""
    checked = number(call, "by_A", value, "current")
    if checked == 0:
        raise ValueError(f"{call}(by_A={value!r}): a change must not be zero")
    return checked
