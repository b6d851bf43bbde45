"""A wall."""

from mimoc.base.kinds import ObjectKind
from mimoc.objects.wall.spec import WallSpec

KIND = ObjectKind("wall", "A wall, which can have a picture on it.", WallSpec, "mimoc.objects.wall.build")
