"""Names of muscle groups in a spec."""

from typing import Annotated

from pydantic import AfterValidator, Field

from mimoc.errors import suggestion
from mimoc.schema.names import STRENGTH_GROUPS
from mimoc.schema.quantities import Distinct

OTHER_WORDS = {"head": "neck", "body": "trunk", "chest": "trunk", "fingers": "hands", "feet": "legs", "toes": "legs"}
"""Other words for some groups, or for parts of them, which an error translates."""


def _known_group(name: str) -> str:
    if name not in STRENGTH_GROUPS:
        meant = OTHER_WORDS.get(name)
        advice = f"write '{meant}'" if meant else suggestion(name, STRENGTH_GROUPS)
        raise ValueError(f"unknown muscle group; {advice}")
    return name


GroupName = Annotated[str, AfterValidator(_known_group), Field(json_schema_extra={"enum": list(STRENGTH_GROUPS)})]
Groups = Annotated[tuple[GroupName, ...], *Distinct]
