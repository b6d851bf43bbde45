"""What can be asked of the sense of sound, and what the runtime must know of it."""

from typing import Annotated

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.quantities import Real, Whole


class SoundSpec(Model):
    """Level and direction of the loudest sources in the scene, at both ears; each toy is a source."""

    sources: Annotated[Whole, Field(ge=1, le=20)] = 2
    """How many sources are heard: the loudest ones."""
    level_db: Annotated[Real, Field(ge=0, le=120)] = 60.0
    """Sound pressure level of a source at 1 m, in dB."""
    head_shadow_db: Annotated[Real, Field(ge=0, le=40)] = 6.0
    """By how much the head dampens a source that is exactly on the other side of it, in dB."""


class SoundEntry(Model):
    """The sense of sound."""

    left_ear: str
    """Site of the left ear."""
    right_ear: str
    """Site of the right ear."""
    head: str
    """Body in whose frame directions are."""
    sources: int
    """How many sources are heard."""
    level_db: float
    """Level of a source at 1 m."""
    head_shadow_db: float
    """Attenuation of a source on the other side of the head."""
