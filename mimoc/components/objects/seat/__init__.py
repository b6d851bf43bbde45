"""A seat that fits the infant."""

from mimoc.components.objects.seat.spec import SeatSpec
from mimoc.schema.kinds import ObjectKind

KIND = ObjectKind(
    "seat",
    "A seat that fits the infant.",
    SeatSpec,
    "mimoc.components.objects.seat.build",
    start="mimoc.components.objects.seat.build",
    poses=("sitting",),
)
