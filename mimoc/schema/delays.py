"""The `delays` of a spec and of a manifest: one for each registered sense, and one for the motor commands."""

from collections.abc import Iterable
from typing import Annotated, Literal

from pydantic import Field
from pydantic.fields import FieldInfo

from mimoc.base.errors import KindError
from mimoc.schema.base import Model, omitting
from mimoc.schema.components.senses import SENSES
from mimoc.schema.composition import ComposedModel, composed, described_field
from mimoc.schema.entries import Body, Duration
from mimoc.schema.quantities import Milliseconds

Delay = Annotated[Milliseconds, Field(le=10_000)]
MOTOR = "motor"
"""The signal to the actuators; all others come from senses."""


def signals() -> tuple[str, ...]:
    """Return the names of all signals that can be delayed: those of the senses, then `motor`."""
    if MOTOR in SENSES:
        raise KindError(f"'{MOTOR}' is already the name of commands among the delays; choose another name")
    return (*SENSES, MOTOR)


def _delay_fields() -> dict[str, FieldInfo]:
    about = {name: f"Delay of {name}." for name in SENSES} | {MOTOR: "Delay from command to actuator."}
    return {f"{name}_ms": described_field(Delay | None, None, about[name]) for name in signals()}


@composed(_delay_fields)
class DelaysSpec(ComposedModel):
    """Sensory and motor delays, each a multiple of the physics step; the more specific key takes precedence."""

    preset: Literal["none", "paper", "physiological"] = "none"
    """Delays that apply where none is given: zero (`none`), those of the paper (`paper`), or those of an infant of this
    age (`physiological`)."""
    sensory_ms: Delay | None = None
    """Delay of every sense for which no delay is given below."""
    processing: Literal["off", "age", "adult"] | None = None
    """Time that behaviours take to decide besides conduction: none (`off`, the default), that of the infant's age
    (`age`), or of adults (`adult`)."""


def given_keys(spec: DelaysSpec, signal: str) -> list[str]:
    """Return the keys of a spec that give the delay of a signal; the first takes precedence."""
    common = () if signal == MOTOR else ("sensory_ms",)
    return [key for key in (f"{signal}_ms", *common) if getattr(spec, key) is not None]


def is_delayed(spec: DelaysSpec, senses: Iterable[str]) -> bool:
    """Return whether the commands or one of some senses can have a delay."""
    for signal in (*senses, MOTOR):
        keys = given_keys(spec, signal)
        if getattr(spec, keys[0]) if keys else spec.preset != "none":
            return True
    return False


class PartDelay(Model):
    """Delay of one signal to or from a part of the body."""

    body: Body
    """The first body of the part."""
    ms: Duration
    """Delay."""


class DelayEntry(Model):
    """Delay of one signal, in whole physics steps."""

    ms: Duration = 0.0
    """Delay."""
    legs_ms: Duration | None = None
    """Delay to or from legs and feet, if it differs."""
    parts: tuple[PartDelay, ...] = ()
    """Delays to or from other parts, if they differ; later ones may be in earlier ones."""

    _serialized = omitting("parts")


class ProcessingEntry(Model):
    """How long decisions take, besides conduction."""

    look_ms: Duration
    """Mean decision to look at a new target."""
    reach_ms: Duration
    """Mean decision to reach for a new target."""
    look_variation: Annotated[float, Field(ge=0, le=10)]
    """Standard deviation of a decision to look, as a share of its mean."""
    reach_variation: Annotated[float, Field(ge=0, le=10)]
    """Standard deviation of a decision to reach, as a share of its mean."""


@composed(lambda: {name: described_field(DelayEntry, DelayEntry(), f"Delay of {name}.") for name in signals()})
class DelaysEntry(ComposedModel):
    """The delay of each signal."""

    legs: tuple[Body, ...] = ()
    """The first body of each leg."""
    processing: ProcessingEntry | None = None
    """How long decisions of behaviours take; None is no time."""

    _serialized = omitting("processing")
