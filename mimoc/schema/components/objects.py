"""Objects at places of the user's choice; each kind is a folder."""

from mimoc.base.kinds import Kinds
from mimoc.schema.kinds import ObjectKind

OBJECTS: Kinds[ObjectKind] = Kinds(
    "kind of object",
    {
        "shape": "mimoc.components.objects.shape",
        "mobile": "mimoc.components.objects.mobile",
        "mat": "mimoc.components.objects.mat",
        "seat": "mimoc.components.objects.seat",
        "rail": "mimoc.components.objects.rail",
        "table": "mimoc.components.objects.table",
        "stairs": "mimoc.components.objects.stairs",
        "slope": "mimoc.components.objects.slope",
        "wall": "mimoc.components.objects.wall",
        "screen": "mimoc.components.objects.screen",
        "water": "mimoc.components.objects.water",
    },
)
