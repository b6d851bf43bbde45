"""What can be asked of touch, and what the runtime must know of it."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.groups import Groups
from mimoc.schema.quantities import Real

TouchQuantity = Literal["force_vector", "force_vector_global", "normal"]
TouchResponse = Literal["linear", "nearest"]

POINTS = "touch/points_m"
"""Array of the bundle: the skin points of all bodies, one body after the other, shape (n, 3), in the frames of their
bodies."""


class TouchSpec(Model):
    """The sense of touch, all over the skin."""

    density: Annotated[Real, Field(ge=0.1, le=10)] = 1.0
    """Number of skin points, relative to what an infant's two-point discrimination asks for."""
    quantity: TouchQuantity = "force_vector"
    """Force in the part's own frame, in the world's, or only its normal part."""
    response: TouchResponse = "linear"
    """Whether the skin points around a contact share its force, or the nearest gets all of it."""
    regions: Annotated[Groups, Field(min_length=1)] | None = None
    """Groups of muscles whose parts have skin, the head's under `neck`; left out, all of the body has."""


class SkinEntry(Model):
    """The skin points of one body."""

    body: str
    """The body."""
    points: Annotated[int, Field(ge=0)]
    """How many there are."""
    spacing_m: float
    """Distance of neighbouring points."""


class TouchEntry(Model):
    """The sense of touch."""

    kind: Literal["touch"] = "touch"
    """Which sense this is."""
    quantity: TouchQuantity
    """What each skin point measures: the force in its body's frame, in the world's, or only its normal part."""
    response: TouchResponse
    """Whether the skin points around a contact share its force, or the nearest gets all of it."""
    skin: tuple[SkinEntry, ...]
    """The bodies that have skin points, in the order of the model and of the array `touch/points_m`."""
