"""A soft mat to lie on."""

from mimoc.components.objects.mat.spec import MatSpec
from mimoc.schema.kinds import ObjectKind

KIND = ObjectKind(
    "mat",
    "A soft mat on the floor.",
    MatSpec,
    "mimoc.components.objects.mat.build",
    start="mimoc.components.objects.mat.build",
    poses=("supine", "prone", "sitting", "standing"),
)
