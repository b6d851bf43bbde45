"""A soft mat to lie on."""

from mimoc.base.kinds import ObjectKind
from mimoc.objects.mat.spec import MatSpec

KIND = ObjectKind(
    "mat",
    "A soft mat on the floor.",
    MatSpec,
    "mimoc.objects.mat.build",
    start="mimoc.objects.mat.build",
    poses=("supine", "prone", "sitting", "standing"),
)
