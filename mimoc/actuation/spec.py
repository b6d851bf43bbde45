"""What moves the joints, and how strongly."""

from collections.abc import Mapping
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from mimoc.errors import suggestion
from mimoc.schema.base import KeyedError, Model
from mimoc.schema.names import STRENGTH_GROUPS, single_groups
from mimoc.schema.quantities import Age, Distinct, Real

OTHER_WORDS = {"head": "neck", "body": "trunk", "chest": "trunk", "fingers": "hands", "feet": "legs", "toes": "legs"}
"""What else one may call some groups, or parts of them."""


def _known_group(name: str) -> str:
    if name not in STRENGTH_GROUPS:
        meant = OTHER_WORDS.get(name)
        advice = f"write '{meant}'" if meant else suggestion(name, STRENGTH_GROUPS)
        raise ValueError(f"unknown group of muscles; {advice}")
    return name


GroupName = Annotated[str, AfterValidator(_known_group)]
Groups = Annotated[tuple[GroupName, ...], Distinct]


class ActuationSpec(Model):
    """What moves the joints."""

    model: Literal["torque", "muscle", "position"] = "torque"
    """Torque on a spring and damper, two muscles a joint, or a commanded angle that muscles of that strength go to."""
    strength_age_months: Age | None = None
    """Age that strength is taken from; left out, that of the body."""
    strength: Mapping[GroupName, Annotated[Real, Field(ge=0, le=10)]] = Field(default_factory=dict)
    """Factors on strength by group of muscles; `arms` means both, but an arm named as well goes by its own factor.
    The wrist is the hand's, ankle and toes are the leg's."""
    regions: Groups | None = None
    """Groups of muscles that take commands; the others rest. Left out, all do."""
    locked: Groups = ()
    """Groups of muscles whose joints stay at the angles that the infant starts with."""

    @model_validator(mode="after")
    def _what_is_locked_takes_no_commands(self) -> Self:
        for index, group in enumerate(self.regions or ()):
            if both := single_groups([group]) & single_groups(self.locked):
                message = f"{' and '.join(sorted(both))} cannot be moved and locked; leave it out here or in 'locked'"
                raise KeyedError(("regions", index), message, against=("locked",))
        return self
