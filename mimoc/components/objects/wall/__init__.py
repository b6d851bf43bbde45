"""A wall."""

from mimoc.components.objects.wall.spec import WallSpec
from mimoc.schema.kinds import ObjectKind

KIND = ObjectKind("wall", "A wall, which can have a picture on it.", WallSpec, "mimoc.components.objects.wall.build")
