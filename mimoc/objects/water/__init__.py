"""Still water of some depth."""

from mimoc.base.kinds import ObjectKind
from mimoc.objects.water.spec import WaterSpec

KIND = ObjectKind(
    "water",
    "Still water of some depth, which lifts and slows what is in it.",
    WaterSpec,
    "mimoc.objects.water.build",
    start="mimoc.objects.water.build",
    poses=("supine", "prone", "sitting", "standing"),
    run="mimoc.objects.water.run",
)
