"""A seat that fits an infant, and the infant in it."""

from collections.abc import Iterator, Mapping

import numpy as np

from mimoc.base.units import cm_to_m
from mimoc.body.kinematics import FloatArray
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.furniture import WorldMaterial
from mimoc.compiler.mjcf.world import ObjectGeom
from mimoc.compiler.objects.boards import board, finish, fixed_object
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings
from mimoc.compiler.objects.names import object_name
from mimoc.compiler.objects.starts import FurnitureStart, State
from mimoc.compiler.task_setup import Hold
from mimoc.components.objects.seat.build_fit import SHANKS, THIGHS, Fit, fit
from mimoc.components.objects.seat.spec import SeatSpec
from mimoc.schema.object_furniture import WOOD

THICKNESS_M = 0.02
"""Of its boards."""
ABOVE_HEAD_M, BESIDE_M, BEFORE_KNEE_M = 0.03, 0.01, 0.005
"""How far the back is above the head, the side boards are from the hips, and the shanks from the bottom."""
FEET_M = 0.03
"""How far the feet are above the floor, unless the spec says."""
FOOT = 0.6
"""Length and width of the foot of the seat, for one of its bottom."""


def build(spec: SeatSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a seat: back, bottom, a board on either side, and a foot on the floor; the hip is above the origin."""
    seated, name = fit(surroundings.tree, spec.recline_deg), object_name(spec.name)
    cloth, wood = finish(name, spec.colour, specular=0.0), finish(f"{name}_wood", WOOD)
    pieces = list(_boards(name, seated, seated.corner_m + np.array([0.0, 0.0, hip_height(spec, seated)]), cloth, wood))
    rule = "of its back, which leans on trunk and head; all boards are as large as the infant that they touch"
    size: Entry = {"value": pieces[0].sizes[0][1], "unit": "m", "rule": rule, "from": ["child.length_cm"]}
    return fixed_object(name, pieces, (cloth, wood), "wood", origins={"size": size})


def start(spec: SeatSpec, tree: BodyTree, states: Mapping[str, State]) -> FurnitureStart:
    """Return how an infant sits in the seat."""
    seated = fit(tree, spec.recline_deg)
    belts = () if spec.belt is None else (Hold(tree.home(spec.belt)),)
    return FurnitureStart({"sitting": seated.state(hip_height(spec, seated))}, holds=belts)


def hip_height(spec: SeatSpec, seated: Fit) -> float:
    """Return the height of the hip above the floor, in [m]."""
    if spec.seat_cm is None:
        return seated.reach_m(np.array([0.0, 0.0, -1.0])) + FEET_M
    edge_m = seated.corner_m + _length(seated) * seated.ahead
    return cm_to_m(spec.seat_cm) - float(edge_m[2])


def _length(seated: Fit) -> float:
    """Return the length of the bottom, before whose lower edge the shanks hang, in [m]."""
    level_m = seated.girth_m(SHANKS) + BEFORE_KNEE_M + THICKNESS_M * float(seated.ahead[2])
    from_corner_m = seated.knee_m - seated.corner_m
    return max(float(from_corner_m[0] - level_m) / float(seated.ahead[0]), 2 * THICKNESS_M)


def _boards(
    name: str, seated: Fit, corner_m: FloatArray, cloth: WorldMaterial, wood: WorldMaterial
) -> Iterator[ObjectGeom]:
    """Yield the boards of a seat, the surfaces of whose back and bottom meet in a corner."""
    up, ahead, behind, below = seated.up, seated.ahead, seated.behind, seated.below
    half_m, long_m = THICKNESS_M / 2, _length(seated)
    wide_m = seated.reach_m(np.array([0.0, 1.0, 0.0]), ("hip", *THIGHS)) + BESIDE_M
    high_m = seated.reach_m(up) - float(seated.corner_m @ up) + ABOVE_HEAD_M
    arm_m = max(2 * seated.girth_m(THIGHS), THICKNESS_M)
    middle_m = corner_m + up * (high_m / 2 - half_m) + behind * half_m
    yield board(f"{name}_back", (half_m, wide_m, high_m / 2 + half_m), middle_m, cloth, seated.recline_deg)
    bottom_m = corner_m + ahead * (long_m / 2 - half_m) + below * half_m
    yield board(f"{name}_bottom", (long_m / 2 + half_m, wide_m, half_m), bottom_m, cloth, seated.tilt_deg)
    for side, sign in ("left", 1.0), ("right", -1.0):
        beside_m = np.array([0.0, sign * (wide_m + half_m), 0.0])
        middle_m = corner_m + ahead * long_m / 2 - below * (arm_m / 2 - half_m) + beside_m
        half_side_m = (long_m / 2, half_m, arm_m / 2 + half_m)
        yield board(f"{name}_side_{side}", half_side_m, middle_m, wood, seated.tilt_deg)
    foot_m = float(bottom_m[2]) - FOOT * long_m / 2 * float(ahead[2] / ahead[0]) - half_m
    if foot_m > 0:
        half_foot_m = (FOOT * long_m / 2, FOOT * wide_m, foot_m / 2)
        yield board(f"{name}_foot", half_foot_m, (float(bottom_m[0]), 0.0, foot_m / 2), wood)
