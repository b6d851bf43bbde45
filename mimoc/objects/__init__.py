"""Objects at places of the user's choice; each kind is a folder."""

from mimoc.base.kinds import Kinds, ObjectKind

OBJECTS: Kinds[ObjectKind] = Kinds(
    "kind of object",
    {
        "shape": "mimoc.objects.shape",
        "mobile": "mimoc.objects.mobile",
        "mat": "mimoc.objects.mat",
        "seat": "mimoc.objects.seat",
        "rail": "mimoc.objects.rail",
        "table": "mimoc.objects.table",
        "stairs": "mimoc.objects.stairs",
        "slope": "mimoc.objects.slope",
        "wall": "mimoc.objects.wall",
        "screen": "mimoc.objects.screen",
        "water": "mimoc.objects.water",
    },
)
