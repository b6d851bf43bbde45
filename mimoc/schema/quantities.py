"""Types of the numbers in a spec, each with its unit and its widest range, and of plain data that anyone may write."""

from collections import Counter
from collections.abc import Callable, Sequence
from math import isfinite
from typing import Annotated, Any, Literal, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    Discriminator,
    Field,
    JsonValue,
    StringConstraints,
)
from pydantic.fields import FieldInfo

Number = TypeVar("Number", int, float)

Real = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Whole = Annotated[int, Field(strict=True)]

Months = Annotated[Real, Field(ge=0, json_schema_extra={"unit": "months"})]
Centimetres = Annotated[Real, Field(gt=0, json_schema_extra={"unit": "cm"})]
Metres = Annotated[Real, Field(gt=0, json_schema_extra={"unit": "m"})]
Kilograms = Annotated[Real, Field(gt=0, json_schema_extra={"unit": "kg"})]
Degrees = Annotated[Real, Field(json_schema_extra={"unit": "deg"})]
Milliseconds = Annotated[Real, Field(ge=0, json_schema_extra={"unit": "ms"})]
Pixels = Annotated[Whole, Field(ge=1, json_schema_extra={"unit": "px"})]
CyclesPerDegree = Annotated[Real, Field(gt=0, json_schema_extra={"unit": "cpd"})]
MIN_PERCENTILE, MAX_PERCENTILE = 0.0001, 99.9999
"""One child in a million is smaller, or larger: 4.75 standard deviations. 0 and 100 would be infinitely small and large
children."""
Percentile = Annotated[Real, Field(ge=MIN_PERCENTILE, le=MAX_PERCENTILE, json_schema_extra={"unit": "percentile"})]
"""Percentile of the WHO Child Growth Standards; of a child that is farther out, give the measurement."""

Direction = Literal["left", "right", "up", "down"]  # A side of the line of sight.

LAST_MONTH = 24
Age = Annotated[Months, Field(le=LAST_MONTH)]  # Ages at which infants can be built.

Identifier = Annotated[str, StringConstraints(strict=True, pattern="^[a-z][a-z0-9_]*$", max_length=64)]
"""Name of an infant or of a cohort."""
PathText = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=4096)]
"""Path of a file or folder, relative to the folder of the spec."""


def version_one(what: str) -> BeforeValidator:
    """Return what marks a version of a language of files, of which there is one."""

    def known(value: Any) -> Any:
        if type(value) is not int or value != 1:
            raise ValueError(f"this mimoc reads version 1 of {what}; write 'mimoc: 1'")
        return value

    return BeforeValidator(known)


def _rising(ends: tuple[Number, Number]) -> tuple[Number, Number]:
    lowest, highest = ends
    if lowest > highest:
        raise ValueError(f"the range [{lowest:g}, {highest:g}] is reversed; write the smaller number first")
    return ends


def _distinct(names: Sequence[str]) -> Sequence[str]:
    repeated = sorted(name for name, count in Counter(names).items() if count > 1)
    if repeated:
        raise ValueError(f"{', '.join(map(repr, repeated))} more than once; name each once")
    return names


Rising = AfterValidator(_rising)  # Marks two numbers as a range, the lowest first.
Distinct = Field(json_schema_extra={"uniqueItems": True}), AfterValidator(_distinct)
"""Mark a list in which no name may be repeated."""


def among(names: Callable[[], Sequence[str]]) -> FieldInfo:
    """Return what tells editors which names there are, of kinds that may be registered later."""

    def add(schema: dict[str, Any]) -> None:
        if known := names():
            schema["enum"] = [*known]

    return Field(json_schema_extra=add)


def keys_among(names: Sequence[str]) -> dict[str, JsonValue]:
    """Return what tells editors which keys a section may have whose keys are names."""
    return {"propertyNames": {"enum": list(names)}}


INT64 = 2**63


def bounded(data: Any) -> Any:
    """Return plain data, or raise a ValueError if whole numbers have more than 64 bits or others are not finite."""
    if isinstance(data, dict | list):
        for item in data.values() if isinstance(data, dict) else data:
            bounded(item)
    elif isinstance(data, int) and not -INT64 <= data < INT64:
        raise ValueError(f"a whole number of {data.bit_length()} bits is too large")
    elif isinstance(data, float) and not isfinite(data):
        raise ValueError(f"{data} is not a finite number")
    return data


Int64 = Annotated[Whole, Field(ge=-INT64, lt=INT64)]
Count = Annotated[Whole, Field(ge=0, lt=INT64)]
NotNegative = Annotated[Real, Field(ge=0)]
Plain = Annotated[JsonValue, AfterValidator(bounded)]


def by_shape(wanted: str) -> tuple[Discriminator, FieldInfo]:
    """Return what marks alternatives that differ in shape, the `Tag` of each: `a word`, `a list` or `a section`.

    Args:
        wanted: What a message says of a value that is none of them.
    """
    return Discriminator(_shape), Field(json_schema_extra={"wanted": wanted})


def _shape(value: Any) -> str | None:
    shapes = {"a word": str, "a list": list | tuple, "a section": dict | BaseModel}
    return next((shape for shape, types in shapes.items() if isinstance(value, types)), None)
