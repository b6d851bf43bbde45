"""Bodies that say nothing twice, from any keys."""

from typing import Any

from mimoc.schema.body import BodySpec
from mimoc.schema.sizes import pairs


def agreeing(age_months: float, **body: Any) -> dict[str, Any]:
    """Return the keys of a body without factors and measurements of sizes that other keys name with another value."""
    for _, later, agree in pairs(BodySpec.model_validate(body), age_months):
        if not agree:
            section, name = later.path[1:3]
            body = {**body, section: {key: value for key, value in body[section].items() if key != name}}
    return body
