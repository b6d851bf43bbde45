"""The `actuation` of a spec and of a manifest."""

from collections.abc import Mapping
from typing import Annotated, Self

from pydantic import Field, model_validator
from pydantic.fields import FieldInfo

from mimoc.actuation import ACTUATIONS
from mimoc.schema.base import KeyedError, Model
from mimoc.schema.composition import choice_field, composed, own_sections
from mimoc.schema.groups import GroupName, Groups
from mimoc.schema.names import single_groups
from mimoc.schema.quantities import Age, Real


def _fields() -> dict[str, FieldInfo]:
    about = (
        "Torque on a spring and damper, two muscles a joint, or a commanded angle that muscles of that strength go to."
    )
    return {"model": choice_field(ACTUATIONS, "torque", about), **own_sections(ACTUATIONS)}


@composed(_fields)
class ActuationSpec(Model):
    """What moves the joints."""

    model: str = "torque"
    """Actuation model."""
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


class ActuatorEntry(Model):
    """One actuator of the model, as the action sees it."""

    name: str
    """Name in the model."""
    mimo_actuator: str
    """The actuator of MIMo that it stands for, alone or with others."""
    joint: str
    """The hinge it moves."""
    action_low: float
    """Least command."""
    action_high: float
    """Largest command."""
    commanded: bool = True
    """Whether the action has a command for it; else it rests."""


@composed(lambda: {"model": choice_field(ACTUATIONS, "torque", "Actuation model.")})
class ActuationEntry(Model):
    """How the infant is moved."""

    model: str = "torque"
    """Actuation model."""
    actuators: tuple[ActuatorEntry, ...]
    """In the order of the model; of those that are commanded, of the action."""
