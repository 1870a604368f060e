"""The JSON form of a cue set: which keys there are, in which units and limits, and the JSON Schema of all of it."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Annotated, Any, ClassVar, Literal, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    WithJsonSchema,
    model_validator,
)
from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import PydanticCustomError

from ..model.context import name_fault, text_fault
from ..model.parameter import unit_fault
from ..model.shapes import Heading, Shape, Start
from ..model.statements import Bound
from ..model.units import LARGEST, SMALLEST, UNITS, Kind
from ..model.value_limits import HIGHEST_A, HIGHEST_C, LONGEST_S, LOWEST_C, MOST_REPEATS, SHORTEST_S, Control, fault

Some = TypeVar("Some")
OMITTED: Any = None
"""Default of a key that may be left out; since defaults are not validated, null is an error."""
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
"""What the schema says of each kind of number: the language's own limits, those of ``fault``."""

QUANTITIES: dict[str, tuple[Kind, str]] = {
    **{"by_K": ("change", "K"), "to_C": ("absolute", "°C"), "baseline_C": ("absolute", "°C")},
    **{"by_A": ("current", "A"), "to_A": ("current", "A")},
    **{"rate_K_per_s": ("rate", "K/s"), "rate_A_per_s": ("current_rate", "A/s")},
    **{"duration_s": ("time", "s"), "period_s": ("time", "s"), "count": ("count", "")},
}
"""What kind of number stands behind a key, and its unit."""


def _refusal(code: str, words: str) -> PydanticCustomError:
    return PydanticCustomError(code, "{words}", {"words": words})


def _limited(kind: Kind) -> tuple[Any, Any]:
    def check(value: float) -> float:
        if found := fault(value, kind):
            raise _refusal(*found)
        return value

    return AfterValidator(check), WithJsonSchema({"type": "integer" if kind == "count" else "number", **LIMITS[kind]})


def _checked(code: str, fault_of: Callable[[str], str | None]) -> AfterValidator:
    def check(text: str) -> str:
        if wrong := fault_of(text):
            raise _refusal(code if text.strip() else "E117", wrong)
        return text

    return AfterValidator(check)


def _tag_fault(text: str) -> str | None:
    plain = "," not in text and text == text.strip()
    return None if plain else "a tag must not contain a comma or begin or end with a space"


def _whole(value: object) -> object:
    return value if type(value) is int else f"{value!r}"[:40].lower()  # true and 1.0 are not 1


def _which(value: object) -> str:
    return "parameter" if isinstance(value, (Mapping, Use)) else "number"


_UNIT_NAMES = sorted({unit for units in UNITS.values() for unit in units})
Name = Annotated[str, _checked("E113", name_fault), WithJsonSchema({"type": "string", "minLength": 1})]
Text = Annotated[str, _checked("E105", text_fault), WithJsonSchema({"type": "string", "pattern": r"\S"})]
TagText = Annotated[
    Text, _checked("E117", _tag_fault), WithJsonSchema({"type": "string", "pattern": r"^[^\s,]([^,]*[^\s,])?$"})
]
Unit = Annotated[str, _checked("E103", unit_fault), WithJsonSchema({"enum": _UNIT_NAMES})]


class Table(BaseModel):
    """What every object of the file has in common: unknown keys are errors; of some keys exactly one is given."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        strict=True,
        allow_inf_nan=False,
        field_title_generator=lambda name, _: name.strip("_"),
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
SignedDifference = OrUse[Annotated[float, *_limited("change")]]
Difference = OrUse[Annotated[float, *_limited("difference")]]
Rate = OrUse[Annotated[float, *_limited("rate")]]
Time = OrUse[Annotated[float, *_limited("time")]]
Current = OrUse[Annotated[float, *_limited("current")]]
CurrentRate = OrUse[Annotated[float, *_limited("current_rate")]]
Count = OrUse[Annotated[int, *_limited("count")]]
Level = OrUse[Absolute]


class ChangeTable(Table):
    """A ramp of temperature, by a difference or to a temperature, at a rate or over a time."""

    ONE_OF = (("by_K", "to_C"), ("rate_K_per_s", "duration_s"))
    do: Literal["warm", "cool", "change"]
    by_K: SignedDifference = Field(
        default=OMITTED, description="difference in K: signed for change, positive for warm and cool"
    )
    to_C: Level = Field(default=OMITTED, description="target in °C")
    rate_K_per_s: Rate = Field(default=OMITTED, description="rate in K/s, positive")
    duration_s: Time = Field(default=OMITTED, description="how long it takes, in s")


class DriveTable(Table):
    """A ramp of current, under control current."""

    ONE_OF = (("rate_A_per_s", "duration_s"),)
    do: Literal["drive"]
    to_A: Current = Field(description="target in A")
    rate_A_per_s: CurrentRate = Field(default=OMITTED, description="rate in A/s, positive")
    duration_s: Time = Field(default=OMITTED, description="how long it takes, in s")


class HoldTable(Table):
    """Stay at the present level, or rest at baseline."""

    do: Literal["hold", "rest"]
    duration_s: Time = Field(description="how long, in s")


class ReturnTable(Table):
    """Go back to baseline, at a rate or over a time."""

    ONE_OF = (("rate_K_per_s", "rate_A_per_s", "duration_s"),)
    do: Literal["return"]
    rate_K_per_s: Rate = Field(default=OMITTED, description="rate in K/s, positive")
    rate_A_per_s: CurrentRate = Field(default=OMITTED, description="rate in A/s, positive, under control current")
    duration_s: Time = Field(default=OMITTED, description="how long it takes, in s")


class StepTable(Table):
    """To another level as fast as the driver can."""

    ONE_OF = (("by_K", "to_C", "by_A", "to_A"),)
    do: Literal["step"]
    direction: Heading = "change"
    by_K: SignedDifference = Field(
        default=OMITTED, description="difference in K: signed, but positive with warm and cool"
    )
    to_C: Level = Field(default=OMITTED, description="target in °C")
    by_A: Current = Field(default=OMITTED, description="difference in A, signed")
    to_A: Current = Field(default=OMITTED, description="target in A")


class PulseTable(Table):
    """A step, a hold, and a step back."""

    ONE_OF = (("by_K", "by_A"),)
    do: Literal["pulse"]
    direction: Heading = "change"
    by_K: SignedDifference = Field(
        default=OMITTED, description="difference in K: signed, but positive with warm and cool"
    )
    by_A: Current = Field(default=OMITTED, description="difference in A, signed")
    duration_s: Time = Field(description="how long the level is held, in s")


class WaveTable(Table):
    """A wave about the present level."""

    ONE_OF = (("by_K", "by_A"),)
    do: Shape
    by_K: Difference = Field(default=OMITTED, description="amplitude in K")
    by_A: Current = Field(default=OMITTED, description="amplitude in A, positive")
    period_s: Time = Field(description="period in s")
    duration_s: Time = Field(description="how long, in s: whole periods unless cut")
    start: Start = Field(default=OMITTED, description="warm (default) or cool for K, up (default) or down for A")
    cut: bool = Field(default=False, description="whether the time may end within a period")


class TotalTable(Table):
    """How long the whole icon must last: checked, it moves nothing."""

    do: Literal["total"]
    duration_s: Time = Field(description="the time in s")
    bound: Bound = "exactly"


class PlayTable(Table):
    """All statements of another icon of the file, or of a member of a family, from baseline."""

    do: Literal["play"]
    icon: Name


class RepeatTable(Table):
    """Statements, several times over."""

    do: Literal["repeat"]
    count: Count = Field(description="how many times")
    statements: list[StatementTable] = Field(min_length=1)


StatementTable = Annotated[
    ChangeTable
    | DriveTable
    | HoldTable
    | ReturnTable
    | StepTable
    | PulseTable
    | WaveTable
    | TotalTable
    | PlayTable
    | RepeatTable,
    Field(discriminator="do"),
]


class ParameterTable(Table):
    """What varies in a family: listed values, or a range with both its ends, as numbers in the unit."""

    name: Name
    unit: Unit = Field(default="", description="one of the language's units; left out for a count")
    values: Annotated[list[float], Field(min_length=1)] = Field(default=OMITTED, description="in the unit")
    low: float = Field(default=OMITTED, description="first value of a range, in the unit")
    high: float = Field(default=OMITTED, description="last value of a range, in the unit")
    step: float = Field(default=OMITTED, description="step of a range, in the unit")

    @model_validator(mode="after")
    def _one_way(self) -> ParameterTable:
        ends = [value for value in (self.low, self.high, self.step) if value is not None]
        if len(ends) != (3 if self.values is None else 0):
            names = ("values", "low with high and step")
            words = "either values, or low, high and step, are needed"
            raise PydanticCustomError("one_of", "{words}", {"words": words, "names": names})
        return self


class MetadataTable(Table):
    """Metadata, of the set or of an icon."""

    means: Text = Field(default=OMITTED, description="intent; of a family, {name} stands for a parameter's value")
    by: Text = Field(default=OMITTED, description="author or source")
    doi: Text = Field(default=OMITTED, description="DOI of the source")
    licence: Text = Field(default=OMITTED)
    tags: list[TagText] = Field(default_factory=list)


class SetTable(MetadataTable):
    """What the icons of the file have in common."""

    name: Name = Field(default=OMITTED)
    title: Text = Field(default=OMITTED)
    site: Name = Field(default=OMITTED, description="where on the body")
    control: Control = Field(default="skin", description="what the numbers prescribe")
    baseline_C: Absolute = Field(default=OMITTED, description="the level of rest in °C")


class IconTable(MetadataTable):
    """An icon; with parameters, a family of icons."""

    name: Name
    parameters: Annotated[list[ParameterTable], Field(min_length=1)] = Field(default=OMITTED)
    statements: list[StatementTable] = Field(min_length=1)


class CueTable(Table):
    """A set of thermal icons, as thermicon writes it in JSON. Units stand in the names of the keys."""

    schema_: str = Field(default=OMITTED, alias="$schema", description="for editors; not looked at")
    format: Literal["thermicon cue"]
    version: Annotated[Literal[1], BeforeValidator(_whole)]
    set: SetTable = SetTable()
    icons: list[IconTable] = Field(min_length=1)


class _Schema(GenerateJsonSchema):
    def default_schema(self, schema: Any) -> Any:
        made = self.generate_inner(schema["schema"])
        default = schema.get("default")
        return made if default is None or "$ref" in made else {**made, "default": default}


def schema_text() -> str:
    """Return the JSON Schema (draft 2020-12) of the format, as ``data/cue.schema.json`` has it.

    >>> json.loads(schema_text())["title"]
    'thermicon cue set'
    """
    made = {"$schema": GenerateJsonSchema.schema_dialect, **CueTable.model_json_schema(schema_generator=_Schema)}
    made["title"] = "thermicon cue set"
    return json.dumps(made, indent=2, ensure_ascii=False) + "\n"
