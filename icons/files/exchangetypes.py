"""What stands behind a key of the JSON form: numbers in their units and limits, names, texts, parameters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Tag,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import PydanticCustomError

from ..model.context import name_fault, text_fault
from ..model.parameter import unit_fault
from ..model.units import LARGEST, SMALLEST, UNITS, Kind
from ..model.value_limits import HIGHEST_A, HIGHEST_C, LONGEST_S, LOWEST_C, MOST_REPEATS, SHORTEST_S, fault

Some = TypeVar("Some")
_WIDEST = HIGHEST_C - LOWEST_C
LIMITS: dict[Kind, dict[str, object]] = {
    "absolute": {"minimum": LOWEST_C, "maximum": HIGHEST_C},
    "difference": {"minimum": SMALLEST, "maximum": _WIDEST},
    "change": {"minimum": -_WIDEST, "maximum": _WIDEST, "not": {"const": 0}},
    "rate": {"minimum": SMALLEST, "maximum": LARGEST},
    "current_rate": {"minimum": SMALLEST, "maximum": LARGEST},
    "time": {"minimum": SHORTEST_S, "maximum": LONGEST_S},
    "current": {"minimum": -HIGHEST_A, "maximum": HIGHEST_A},
    "count": {"minimum": 1, "maximum": MOST_REPEATS},
}
"""What the schema says of each kind of number: the language's own limits, those of ``faults``."""


def _limited(kind: Kind) -> tuple[Any, Any]:
    def check(value: float) -> float:
        if found := fault(value, kind):
            raise _told(*found)
        return value

    return AfterValidator(check), WithJsonSchema({"type": "integer" if kind == "count" else "number", **LIMITS[kind]})


def _told(code: str, words: str) -> PydanticCustomError:
    return PydanticCustomError(code, "{words}", {"words": words})


def _name(text: str) -> str:
    if wrong := name_fault(text):
        raise _told("E113", wrong)
    return text


def _text(text: str) -> str:
    if wrong := text_fault(text):
        raise _told("E105" if text.strip() else "E117", wrong)
    return text


def _tag(text: str) -> str:
    if "," in text or text != text.strip():
        raise _told("E117", "a tag must not contain a comma or begin or end with a space")
    return _text(text)


def _unit(text: str) -> str:
    if wrong := unit_fault(text):
        raise _told("E103", wrong)
    return text


def _no_null(value: object) -> object:
    if value is None:
        raise PydanticCustomError("null", "null is not a value here")
    return value


def whole(value: object) -> object:
    """Return a value as it is, but a text for true and for 1.0, which Python takes for 1."""
    return value if type(value) is int else repr(value)


def _which(value: object) -> str:
    return "parameter" if isinstance(value, (Mapping, Use)) else "number"


_UNIT_NAMES = sorted({unit for units in UNITS.values() for unit in units})
Name = Annotated[str, AfterValidator(_name), WithJsonSchema({"type": "string", "minLength": 1})]
Text = Annotated[str, AfterValidator(_text), WithJsonSchema({"type": "string", "pattern": r"\S"})]
TagText = Annotated[str, AfterValidator(_tag), WithJsonSchema({"type": "string", "pattern": r"^[^\s,]([^,]*[^\s,])?$"})]
Unit = Annotated[str, AfterValidator(_unit), WithJsonSchema({"enum": _UNIT_NAMES})]
Given = Annotated[Some | None, BeforeValidator(_no_null)]
"""A key that may be left out, but not be null."""

_TITLES = {
    "by_K": "difference in K",
    "to_C": "temperature in °C",
    "by_A": "difference in A",
    "to_A": "current in A",
    "rate_K_per_s": "rate in K/s",
    "rate_A_per_s": "rate in A/s",
    "duration_s": "time in s",
    "period_s": "period in s",
    "baseline_C": "baseline in °C",
}


class Table(BaseModel):
    """What every object of the file has in common: unknown keys are errors; of some keys exactly one is given."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        strict=True,
        allow_inf_nan=False,
        field_title_generator=lambda name, _: _TITLES.get(name, name.strip("_")),
        model_title_generator=lambda table: table.__name__.removesuffix("Table").lower(),
    )
    ONE_OF: ClassVar[tuple[tuple[str, ...], ...]] = ()

    @model_validator(mode="after")
    def _one_of(self) -> Table:
        for names in self.ONE_OF:
            given = [name for name in names if getattr(self, name) is not None]
            if len(given) != 1:
                found = f"{' and '.join(given)} exclude one another" if given else f"{' or '.join(names)} is missing"
                raise PydanticCustomError("one_of", "{words}", {"words": found, "names": names})
        return self

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> Any:
        made = handler(core_schema)
        if cls.ONE_OF:
            choices = [{"oneOf": [{"required": [name]} for name in names]} for names in cls.ONE_OF]
            handler.resolve_ref_schema(made)["allOf"] = choices
        return made


class Use(Table):
    """Stands for a number: a parameter of the family, whose values carry their own unit."""

    parameter: Name


OrUse = Annotated[Annotated[Some, Tag("number")] | Annotated[Use, Tag("parameter")], Discriminator(_which)]
Absolute = Annotated[float, *_limited("absolute")]
Change_ = OrUse[Annotated[float, *_limited("change")]]
Difference = OrUse[Annotated[float, *_limited("difference")]]
Rate = OrUse[Annotated[float, *_limited("rate")]]
Time = OrUse[Annotated[float, *_limited("time")]]
Current = OrUse[Annotated[float, *_limited("current")]]
CurrentRate = OrUse[Annotated[float, *_limited("current_rate")]]
Count = OrUse[Annotated[int, *_limited("count")]]
Level = OrUse[Absolute]
