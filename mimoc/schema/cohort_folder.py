"""What the files in the folder of a cohort contain, each of which anyone may have written."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, StringConstraints

from mimoc.schema.base import Model
from mimoc.schema.body import IndividualSpec
from mimoc.schema.quantities import Int64, NotNegative, Plain, Real


def _of_one_child(factors: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return factors, if those that describe a child are numbers, and a text for its sex."""
    for name, value in factors.items():
        if name == "child" or name in IndividualSpec.model_fields:
            kinds = str if name == "sex" else int if name == "child" else (int, float)
            if not isinstance(value, kinds) or isinstance(value, bool):
                raise ValueError(f"'{name}' of a child is {type(value).__name__}")
    return factors


Key = Annotated[str, StringConstraints(pattern="^[0-9a-f]{32}$")]
"""Hash of all that determines the result of a job."""
Measure = None | bool | Int64 | Real | str
Factors = Annotated[Mapping[str, Plain], AfterValidator(_of_one_child)]


MOST_BYTES = 2**20
"""Of a result; 1 MB. Those of mimoc's own steps have one kilobyte."""


class MarkFile(Model):
    """`cohort.json`, which says that a folder is a cohort's."""

    cohort: str
    """Name of the cohort."""
    version: Literal[1]
    """Version of this kind of folder."""


class ResultFile(Model):
    """`results/<first two letters of the key>/<key>.json`: a job and what became of it."""

    job: Key
    cohort: str
    step: str
    seed: Int64 | None
    options: Mapping[str, Plain]
    factors: Factors
    status: Literal["ok", "failed"]
    measures: Mapping[str, Measure]
    versions: Mapping[str, str]
    error: str
    seconds: NotNegative
