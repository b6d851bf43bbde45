"""The child of an experiment."""

from typing import Any

from mimoc.schema.infant import InfantSpec


def child(name: str, age_months: float, **keys: Any) -> InfantSpec:
    """Return the spec of a child whose further keys are as in a file."""
    return InfantSpec.model_validate({"mimoc": 1, "name": name, "age_months": age_months, **keys})
