"""A screen."""

from mimoc.base.units import cm_to_m
from mimoc.compiler.objects.boards import board, finish, fixed_object, show
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings, object_name
from mimoc.components.objects.screen import ScreenSpec

THICKNESS_M, POST_M, FOOT_M = 0.02, 0.02, 0.01
"""Thickness of the panel, breadth of the post behind it, and thickness of its foot."""
FOOT = 0.4
"""Length of its foot, for one width of the screen."""


def build(spec: ScreenSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a screen: a panel, its picture, and a stand."""
    name, paint = object_name(spec.name), finish(object_name(spec.name), spec.colour)
    half_y_m, half_z_m, z_m = cm_to_m(spec.width_cm) / 2, cm_to_m(spec.tall_cm) / 2, cm_to_m(spec.middle_cm)
    pictures, looks = show(name, spec, surroundings.folder, (-THICKNESS_M / 2, 0.0, z_m), glows=True)
    half_post_m, half_foot_m = POST_M / 2, FOOT * half_y_m
    behind_m = THICKNESS_M / 2 + half_post_m
    pieces = (
        board(name, (THICKNESS_M / 2, half_y_m, half_z_m), (0.0, 0.0, z_m), paint),
        board(f"{name}_post", (half_post_m, half_post_m, z_m / 2), (behind_m, 0.0, z_m / 2), paint),
        board(f"{name}_foot", (half_foot_m, half_foot_m, FOOT_M / 2), (behind_m, 0.0, FOOT_M / 2), paint),
    )
    return fixed_object(name, (*pieces, *pictures), (paint,), "wood", pictures=looks)
