"""Plain data of files that anyone may have written, whose numbers are none that arithmetic or tables fail at."""

from math import isfinite
from typing import Annotated, Any

from pydantic import AfterValidator, Field, JsonValue

from mimoc.schema.quantities import Real, Whole

INT64 = 2**63


def bounded(data: Any) -> Any:
    """Return plain data, if its whole numbers have at most 64 bits and the others are finite.

    Raises:
        ValueError: If not.
    """
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
