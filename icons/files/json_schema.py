"""The JSON form of a cue set at the door: which keys there are, in which units, and the schema of all of it."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator
from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import PydanticCustomError

from ..model.shapes import Heading, Shape, Start
from .exchangetypes import (
    Absolute,
    Change_,
    Count,
    Current,
    CurrentRate,
    Difference,
    Given,
    Level,
    Name,
    Rate,
    Table,
    TagText,
    Text,
    Time,
    Unit,
    whole,
)


class ChangeTable(Table):
    """A ramp of temperature, by a difference or to a temperature, at a rate or over a time."""

    ONE_OF = (("by_K", "to_C"), ("rate_K_per_s", "duration_s"))
    do: Literal["warm", "cool", "change"]
    by_K: Given[Change_] = Field(
        default=None, description="difference in K: signed for change, positive for warm and cool"
    )
    to_C: Given[Level] = Field(default=None, description="target in °C")
    rate_K_per_s: Given[Rate] = Field(default=None, description="rate in K/s, positive")
    duration_s: Given[Time] = Field(default=None, description="how long it takes, in s")


class DriveTable(Table):
    """A ramp of current, under control current."""

    ONE_OF = (("rate_A_per_s", "duration_s"),)
    do: Literal["drive"]
    to_A: Current = Field(description="target in A")
    rate_A_per_s: Given[CurrentRate] = Field(default=None, description="rate in A/s, positive")
    duration_s: Given[Time] = Field(default=None, description="how long it takes, in s")


class HoldTable(Table):
    """Stay at the present level, or rest at baseline."""

    do: Literal["hold", "rest"]
    duration_s: Time = Field(description="how long, in s")


class ReturnTable(Table):
    """Go back to baseline, at a rate or over a time."""

    ONE_OF = (("rate_K_per_s", "rate_A_per_s", "duration_s"),)
    do: Literal["return"]
    rate_K_per_s: Given[Rate] = Field(default=None, description="rate in K/s, positive")
    rate_A_per_s: Given[CurrentRate] = Field(default=None, description="rate in A/s, positive, under control current")
    duration_s: Given[Time] = Field(default=None, description="how long it takes, in s")


class StepTable(Table):
    """To another level as fast as the driver can."""

    ONE_OF = (("by_K", "to_C", "by_A", "to_A"),)
    do: Literal["step"]
    direction: Heading = "change"
    by_K: Given[Change_] = Field(default=None, description="difference in K: signed, but positive with warm and cool")
    to_C: Given[Level] = Field(default=None, description="target in °C")
    by_A: Given[Current] = Field(default=None, description="difference in A, signed")
    to_A: Given[Current] = Field(default=None, description="target in A")


class PulseTable(Table):
    """A step, a hold, and a step back."""

    ONE_OF = (("by_K", "by_A"),)
    do: Literal["pulse"]
    direction: Heading = "change"
    by_K: Given[Change_] = Field(default=None, description="difference in K: signed, but positive with warm and cool")
    by_A: Given[Current] = Field(default=None, description="difference in A, signed")
    duration_s: Time = Field(description="how long the level is held, in s")


class WaveTable(Table):
    """A wave about the present level."""

    ONE_OF = (("by_K", "by_A"),)
    do: Shape
    by_K: Given[Difference] = Field(default=None, description="amplitude in K")
    by_A: Given[Current] = Field(default=None, description="amplitude in A, positive")
    period_s: Time = Field(description="period in s")
    duration_s: Time = Field(description="how long, in s: whole periods unless cut")
    start: Given[Start] = Field(default=None, description="warm (default) or cool for K, up (default) or down for A")
    cut: bool = Field(default=False, description="whether the time may end within a period")


class TotalTable(Table):
    """How long the whole icon must last: checked, it moves nothing."""

    do: Literal["total"]
    duration_s: Time = Field(description="the time in s")
    bound: Literal["exactly", "at most", "at least"] = "exactly"


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
    values: Given[Annotated[list[float], Field(min_length=1)]] = Field(default=None, description="in the unit")
    low: Given[float] = Field(default=None, description="first value of a range, in the unit")
    high: Given[float] = Field(default=None, description="last value of a range, in the unit")
    step: Given[float] = Field(default=None, description="step of a range, in the unit")

    @model_validator(mode="after")
    def _one_way(self) -> ParameterTable:
        ends = [value for value in (self.low, self.high, self.step) if value is not None]
        if len(ends) != (3 if self.values is None else 0):
            raise PydanticCustomError("ways", "either values, or low, high and step, are needed")
        return self


class MetadataTable(Table):
    """Metadata, of the set or of an icon."""

    means: Given[Text] = Field(default=None, description="intent; of a family, {name} stands for a parameter's value")
    by: Given[Text] = Field(default=None, description="author or source")
    doi: Given[Text] = Field(default=None, description="DOI of the source")
    licence: Given[Text] = None
    tags: list[TagText] = Field(default_factory=list)


class SetTable(MetadataTable):
    """What the icons of the file have in common."""

    name: Given[Name] = None
    title: Given[Text] = None
    site: Given[Name] = Field(default=None, description="where on the body")
    control: Literal["skin", "display", "current"] = Field(default="skin", description="what the numbers prescribe")
    baseline_C: Given[Absolute] = Field(default=None, description="the level of rest in °C")


class IconTable(MetadataTable):
    """An icon; with parameters, a family of icons."""

    name: Name
    parameters: Given[Annotated[list[ParameterTable], Field(min_length=1)]] = None
    statements: list[StatementTable] = Field(min_length=1)


class CueTable(Table):
    """A set of thermal icons, as thermicon writes it in JSON. Units stand in the names of the keys."""

    schema_: Given[str] = Field(default=None, alias="$schema", description="for editors; not looked at")
    format: Literal["thermicon cue"]
    version: Annotated[Literal[1], BeforeValidator(whole)]
    set: SetTable = SetTable()
    icons: list[IconTable] = Field(min_length=1)


class _Schema(GenerateJsonSchema):
    def nullable_schema(self, schema: Any) -> Any:
        return self.generate_inner(schema["schema"])

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
