"""A mobile that hangs over the infant, with a ribbon that can be tied to a limb."""

from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, JsonValue

from mimoc.schema.kinds import ObjectKind
from mimoc.schema.objects import ObjectSpec
from mimoc.schema.quantities import Centimetres, Real

Limb = Literal["right_foot", "left_foot", "right_hand", "left_hand"]
Figure = Literal[
    "airplane", "ball", "boat", "bunny", "bus", "car", "chicken", "elephant", "fish", "penguin", "pig", "whale"
]
"""The toys of mimoc's whose sides are worth looking at."""


COUNT: dict[str, JsonValue] = {"minItems": 2, "maxItems": 8}  # Of figures: one alone would pull the mobile askew.


def _counted(figures: Sequence[str]) -> Sequence[str]:
    if not 2 <= len(figures) <= 8:
        raise ValueError(f"a mobile with {len(figures)} of them does not hang well; name 2 to 8 figures")
    return figures


class MobileSpec(ObjectSpec):
    """A mobile whose figures swing about a bell, with a ribbon that can be tied to a hand or a foot."""

    kind: Literal["mobile"]
    """Kind of object."""
    figures: Annotated[tuple[Figure, ...], AfterValidator(_counted), Field(json_schema_extra=COUNT)] = (
        "fish",
        "bunny",
        "whale",
        "chicken",
    )
    """Its figures, 2 to 8, by names of mimoc's toys; each hangs from an arm, its side downwards."""
    size_cm: Annotated[Centimetres, Field(ge=3, le=12)] = 6.0
    """Longest side of a figure."""
    figure_g: Annotated[Real, Field(ge=5, le=200, json_schema_extra={"unit": "g"})] = 15.0
    """Mass of a figure."""
    arm_cm: Annotated[Centimetres, Field(ge=5, le=40)] | None = None
    """Length of an arm, from the middle; by default, and at least, as long as the figures and the bell need room."""
    cord_cm: Annotated[Centimetres, Field(ge=5, le=200)] = 30.0
    """Length of the cord that it hangs from."""
    tied_to: Limb | None = None
    """The foot or the hand that its ribbon is tied to, at the ankle or the wrist; by default, it has none."""
    slack_cm: Annotated[Real, Field(ge=0, le=50, json_schema_extra={"unit": "cm"})] = 0.5
    """By how much the ribbon is longer than its way as the infant starts."""


KIND = ObjectKind(
    "mobile",
    "A mobile whose figures swing about a bell, with a ribbon that can be tied to a hand or a foot.",
    MobileSpec,
    "mimoc.components.objects.mobile.build",
)
