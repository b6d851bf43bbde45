"""What can be asked of touch, and what the runtime must know of it."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.groups import Groups
from mimoc.schema.quantities import Real

TouchQuantity = Literal["force_vector", "force_vector_global", "normal"]
TouchResponse = Literal["linear", "nearest"]


class TouchSpec(Model):
    """The sense of touch, all over the skin."""

    density: Annotated[Real, Field(ge=0.1, le=10)] = 1.0
    """Skin points for each that an infant's two-point discrimination asks for."""
    quantity: TouchQuantity = "force_vector"
    """Force in the part's own frame, in the world's, or only the pressure."""
    response: TouchResponse = "linear"
    """Whether a contact is felt by the skin points around it, or by the nearest."""
    regions: Annotated[Groups, Field(min_length=1)] | None = None
    """Groups of muscles whose parts have skin, the head's under `neck`; left out, all of the body has."""


class TouchEntry(Model):
    """The sense of touch."""

    kind: Literal["touch"] = "touch"
    """Which sense this is."""
    quantity: TouchQuantity
    """What each skin point feels: a force in its body's frame, in the world's, or only how hard it is pressed."""
    response: TouchResponse
    """Whether the skin points around a contact feel it, or only the nearest."""
    points_m: Annotated[dict[str, tuple[tuple[float, float, float], ...]], Field(repr=False)]
    """The skin points by body, in its frame; the observation has them in this order, bodies in that of the model."""
    spacing_m: dict[str, float]
    """Distance of neighbouring skin points by body; a contact is felt within twice that."""
