"""A slope."""

from mimoc.components.objects.slope.spec import SlopeSpec
from mimoc.schema.kinds import ObjectKind

KIND = ObjectKind(
    "slope",
    "A board that leads up.",
    SlopeSpec,
    "mimoc.components.objects.slope.build",
    start="mimoc.components.objects.slope.build",
    poses=("supine", "prone"),
)
