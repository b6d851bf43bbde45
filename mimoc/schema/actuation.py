"""The `actuation` of a spec and of a manifest."""

from collections.abc import Mapping
from typing import Annotated, Self

from pydantic import Field, model_validator
from pydantic.fields import FieldInfo

from mimoc.schema.base import KeyedError, Model, choice_field, composed, omitting, own_sections
from mimoc.schema.entries import Actuator, Amount, Body, Hinge, Label, Number
from mimoc.schema.kinds import ACTUATIONS
from mimoc.schema.names import STRENGTH_GROUPS, GroupName, Groups, single_groups
from mimoc.schema.quantities import Age, Real, keys_among


def _fields() -> dict[str, FieldInfo]:
    about = (
        "Joint torques (`torque`), two muscles per joint (`muscle`), or servos that track a commanded joint angle, as "
        "strong as the muscles (`position`)."
    )
    return {"model": choice_field(ACTUATIONS, "torque", about), **own_sections(ACTUATIONS)}


@composed(_fields)
class ActuationSpec(Model):
    """How the joints are actuated."""

    model: str = "torque"
    """Actuation model."""
    arousal: Annotated[Real, Field(ge=0, le=2)] = 1.0
    """How awake the infant is: its muscle tone is in proportion to it. 1 is quiet, 0 slack. `published` has no tone."""
    bandwidth_hz: Annotated[Real, Field(ge=0.1, le=100, json_schema_extra={"unit": "hz"})] | None = None
    """Frequency above which commands hardly reach the muscles: they pass two low-pass filters of first order with this
    cut-off, one after the other. By default no limit, and 5 Hz in the tasks that are skills."""
    strength_age_months: Age | None = None
    """Age for which strength is computed; by default that of the infant."""
    strength: Mapping[GroupName, Annotated[Real, Field(ge=0, le=10)]] = Field(
        default_factory=dict, json_schema_extra=keys_among(STRENGTH_GROUPS)
    )
    """Strength factors by muscle group. `arms` applies to both arms; a factor for one arm takes precedence over it.
    The wrist belongs to the hand, ankle and toes to the leg."""
    regions: Groups | None = None
    """Muscle groups that the action controls; the others stay at rest. By default, all groups."""
    locked: Groups = ()
    """Muscle groups whose joints are locked at the angles of the starting pose."""
    voice: Annotated[bool, Field(strict=True)] = False
    """Whether the infant has a voice: the action ends with two more commands then, pitch and loudness."""

    _serialized = omitting("voice")

    @model_validator(mode="after")
    def _what_is_locked_takes_no_commands(self) -> Self:
        for index, group in enumerate(self.regions or ()):
            if both := single_groups([group]) & single_groups(self.locked):
                message = (
                    f"{' and '.join(sorted(both))} cannot be both commanded and locked; remove it here or from 'locked'"
                )
                raise KeyedError(("regions", index), message, against=("locked",))
        return self


class ActuatorEntry(Model):
    """One actuator of the model."""

    name: Actuator
    """Name in the model."""
    mimo_actuator: Label
    """The actuator of MIMo that it replaces, alone or with others."""
    joint: Hinge
    """The hinge joint that it drives."""
    action_low: Number
    """Smallest command."""
    action_high: Number
    """Largest command."""
    commanded: bool = True
    """Whether the action has an entry for it; otherwise it stays at rest."""
    tone: tuple[Number, ...] = ()
    """What muscle tone adds, in proportion to arousal: to its three bias parameters, or, as two numbers, to the
    stiffness of its hinge and to stiffness x rest angle."""

    _serialized = omitting("tone")

    @model_validator(mode="after")
    def _is_a_range(self) -> Self:
        if self.action_low > self.action_high:
            raise ValueError(f"the range of the command, [{self.action_low:g}, {self.action_high:g}], is reversed")
        return self


class VoiceEntry(Model):
    """The infant's voice."""

    head: Body
    """Body with the mouth."""
    mouth_m: tuple[Number, Number, Number]
    """Place of the mouth in the frame of that body, [m]."""
    low_hz: Annotated[Amount, Field(ge=20, le=20_000)]
    """Fundamental frequency at the lowest pitch."""
    high_hz: Annotated[Amount, Field(ge=20, le=20_000)]
    """Fundamental frequency at the highest pitch."""
    loudest_db: Annotated[Number, Field(ge=0, le=140)]
    """Sound pressure level at the largest loudness, at 1 m, re 20 µPa."""


VOICE_COMMANDS = ("voice_pitch", "voice_loudness")  # Names of a voice's commands.


@composed(lambda: {"model": choice_field(ACTUATIONS, "torque", "Actuation model.")})
class ActuationEntry(Model):
    """The infant's actuation."""

    model: str = "torque"
    """Actuation model."""
    arousal: Number = 1.0
    """Arousal that the model is written for."""
    bandwidth_hz: Annotated[Number, Field(ge=0.1, le=1000)] | None = None
    """Cut-off of each of the two low-pass filters that commands pass; None for no limit."""
    actuators: tuple[ActuatorEntry, ...]
    """Actuators in the order of the model; the action has an entry for each commanded one, in this order."""

    voice: VoiceEntry | None = None
    """The voice, whose commands come last in the action; None if it has none."""

    @property
    def commands(self) -> tuple[str, ...]:
        """The name of each number of the action."""
        names = tuple(actuator.name for actuator in self.actuators if actuator.commanded)
        return (*names, *VOICE_COMMANDS) if self.voice else names

    _serialized = omitting("arousal", "bandwidth_hz", "voice")
