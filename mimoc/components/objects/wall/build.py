"""A wall."""

from mimoc.base.units import cm_to_m
from mimoc.compiler.objects.boards import board, finish, fixed_object, show
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings, object_name
from mimoc.components.objects.wall import WallSpec


def build(spec: WallSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a wall: a box, and its picture."""
    name, paint = object_name(spec.name), finish(object_name(spec.name), spec.colour)
    half_m = cm_to_m(spec.thickness_cm) / 2, cm_to_m(spec.width_cm) / 2, cm_to_m(spec.tall_cm) / 2
    pictures, looks = show(name, spec, surroundings.folder, (-half_m[0], 0.0, half_m[2]), glows=False)
    box = board(name, half_m, (0.0, 0.0, half_m[2]), paint)
    return fixed_object(name, (box, *pictures), (paint,), "wood", pictures=looks)
