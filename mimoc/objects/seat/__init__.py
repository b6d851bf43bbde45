"""A seat that fits the infant."""

from mimoc.base.kinds import ObjectKind
from mimoc.objects.seat.spec import SeatSpec

KIND = ObjectKind(
    "seat",
    "A seat that fits the infant.",
    SeatSpec,
    "mimoc.objects.seat.build",
    start="mimoc.objects.seat.build",
    poses=("sitting",),
)
