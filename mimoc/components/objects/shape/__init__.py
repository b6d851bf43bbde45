"""A simple shape, a toy or a mesh of the user's own."""

from mimoc.components.objects.shape.spec import ShapeSpec
from mimoc.schema.kinds import ObjectKind

KIND = ObjectKind("shape", "A simple shape.", ShapeSpec, "mimoc.components.objects.shape.build")
