"""Still water of some depth."""

from mimoc.components.objects.water.spec import WaterSpec
from mimoc.schema.kinds import ObjectKind

KIND = ObjectKind(
    "water",
    "Still water of some depth, which lifts and slows what is in it.",
    WaterSpec,
    "mimoc.components.objects.water.build",
    start="mimoc.components.objects.water.build",
    poses=("supine", "prone", "sitting", "standing"),
    run="mimoc.components.objects.water.run",
)
