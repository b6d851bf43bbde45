"""A slope."""

from mimoc.base.kinds import ObjectKind
from mimoc.objects.slope.spec import SlopeSpec

KIND = ObjectKind(
    "slope",
    "A board that leads up.",
    SlopeSpec,
    "mimoc.objects.slope.build",
    start="mimoc.objects.slope.build",
    poses=("supine", "prone"),
)
