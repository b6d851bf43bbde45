"""What moves the joints, and how strongly."""

from collections.abc import Mapping
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from mimoc.errors import suggestion
from mimoc.schema.base import KeyedError, Model
from mimoc.schema.names import STRENGTH_GROUPS
from mimoc.schema.quantities import Age, Real


def _known_group(name: str) -> str:
    if name not in STRENGTH_GROUPS:
        raise ValueError(f"unknown group of muscles; {suggestion(name, STRENGTH_GROUPS)}")
    return name


GroupName = Annotated[str, AfterValidator(_known_group)]


class ActuationSpec(Model):
    """What moves the joints."""

    model: Literal["torque", "muscle", "position"] = "torque"
    """Torque on a spring and damper, two muscles a joint, or a commanded angle."""
    strength_age_months: Age | None = None
    """Age that strength is taken from; left out, that of the body."""
    strength: Mapping[GroupName, Annotated[Real, Field(ge=0, le=10)]] = Field(default_factory=dict)
    """Factors on strength by group of muscles; `arms` means both, but an arm named as well goes by its own factor.
    The wrist is the hand's, ankle and toes are the leg's."""

    @model_validator(mode="after")
    def _servos_have_no_strength(self) -> Self:
        for key in ("strength_age_months", "strength"):
            if self.model == "position" and getattr(self, key) not in (None, {}):
                message = (
                    "servos ('model: position') have no strength of their own; leave it out, or choose another model"
                )
                raise KeyedError((key,), message, against=("model",))
        return self
