"""How long signals travel between the body and what controls it."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.quantities import Milliseconds

Delay = Annotated[Milliseconds, Field(le=10_000)]


class DelaysSpec(Model):
    """Delays one way, each a whole number of physics steps; what is more particular wins."""

    preset: Literal["none", "paper", "physiological"] = "none"
    """Where delays come from that are not given: none, those of the paper, or those of an infant of this age."""
    sensory_ms: Delay | None = None
    """Of every sense that has none of its own below."""
    proprioception_ms: Delay | None = None
    """Of proprioception."""
    vestibular_ms: Delay | None = None
    """Of the vestibular sense."""
    touch_ms: Delay | None = None
    """Of touch."""
    vision_ms: Delay | None = None
    """Of vision."""
    motor_ms: Delay | None = None
    """From command to muscle."""
