"""A simple shape, a toy or a mesh of the user's own."""

from mimoc.base.kinds import ObjectKind
from mimoc.objects.shape.spec import ShapeSpec

KIND = ObjectKind("shape", "A simple shape.", ShapeSpec, "mimoc.objects.shape.build")
