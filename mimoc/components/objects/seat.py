"""A seat that fits an infant, and the infant in it."""

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from mimoc.base.geometry.rotations import matrix_from_axis, quaternion_from_axis
from mimoc.base.geometry.solvers import root
from mimoc.base.units import cm_to_m
from mimoc.body.kinematics import FloatArray, frames, pose
from mimoc.body.origins import Entry
from mimoc.body.poses import CONTACT_DEPTH_M, Pose, clip, pose_angles, poses_of, rollers
from mimoc.body.tree import BodyTree, remove_parts
from mimoc.compiler.mjcf.elements import WorldMaterial
from mimoc.compiler.mjcf.world import ObjectGeom
from mimoc.compiler.objects.boards import ACROSS, board, finish, fixed_object
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings, object_name
from mimoc.compiler.objects.placing import FurnitureStart, State
from mimoc.compiler.task_setup import Hold
from mimoc.components.objects import SeatSpec
from mimoc.schema.names import SIDES
from mimoc.schema.objects import WOOD

LIMBS = tuple(f"{side}_upper_{limb}" for side in SIDES for limb in ("arm", "leg"))
THIGHS, SHANKS = (tuple(f"{side}_{part}_leg" for side in SIDES) for part in ("upper", "lower"))
ARMS = ("shoulder", "elbow", "hand", "finger", "ff_", "mf_", "rf_", "lf_", "th_")
"""What the names of the joints of arms contain."""
TILT = 0.5  # How far the bottom is tilted, for one degree by which the back leans: with friction, nobody slides out.
REST_DEG: Mapping[str, float] = {"{side}_hip2": -15.0, "{side}_hip3": 0.0, "{side}_shoulder_horizontal": -7.0}
"""Thighs are somewhat apart, and upper arms hang back."""
SWUNG_DEG = 6.0  # How far before the vertical shanks hang, since knees are stiff; measured at 1 to 24 months.
SLACK_RAD = 0.6  # How far a thigh can be turned down until it touches a bottom that the hip already touches.
PRECISION_RAD = 1e-6
THICKNESS_M = 0.02  # Thickness of its boards.
ABOVE_HEAD_M, BESIDE_M, BEFORE_KNEE_M = 0.03, 0.01, 0.005
"""How far the back is above the head, the side boards are from the hips, and the shanks from the bottom."""
FEET_M = 0.03  # How far the feet are above the floor, unless the spec says.
FOOT = 0.6  # Length and width of the foot of the seat, for one of its bottom.


@dataclass(frozen=True)
class Fit:
    """An infant in a seat; upright is along z, as in the world, x ahead, with the hip at the origin."""

    tree: BodyTree
    angles_rad: Mapping[str, float]
    pitch_rad: float  # Rotation of the hip about y.
    recline_deg: float  # Angle of the back from the vertical.
    back_m: float  # Distance of the surface of the back from the hip.
    bottom_m: float = 0.0  # Distance of the surface of the bottom from the hip.

    @property
    def tilt_deg(self) -> float:
        """How far the bottom is tilted up in front."""
        return TILT * self.recline_deg

    @property
    def up(self) -> FloatArray:
        """Unit vector along the back, upwards, shape (3,)."""
        return _direction(90.0 + self.recline_deg)

    @property
    def ahead(self) -> FloatArray:
        """Unit vector along the bottom, forwards, shape (3,)."""
        return _direction(self.tilt_deg)

    @property
    def below(self) -> FloatArray:
        """Unit vector out of the bottom, downwards, shape (3,)."""
        return _direction(self.tilt_deg - 90.0)

    @property
    def behind(self) -> FloatArray:
        """Unit vector out of the back, backwards, shape (3,)."""
        return _direction(self.recline_deg + 180.0)

    @property
    def corner_m(self) -> FloatArray:
        """Where the surfaces of back and bottom meet, at y = 0, shape (3,)."""
        depths_m = np.array([self.back_m, self.bottom_m]) - CONTACT_DEPTH_M
        x, z = np.linalg.solve(np.array([self.behind, self.below])[:, ::2], depths_m)
        return np.array([x, 0.0, z])

    @property
    def knee_m(self) -> FloatArray:
        """The knee that is least far ahead, shape (3,); without knees, the point as far ahead as the infant reaches."""
        turn = matrix_from_axis(ACROSS, self.pitch_rad)
        placed = frames(self.tree, self.angles_rad)
        knees_m = [turn @ placed[name][0] for name in SHANKS if name in placed]
        return min(knees_m, key=lambda knee: float(knee[0]), default=self.reach_m(self.ahead) * self.ahead)

    def reach_m(self, direction: FloatArray, bodies: Collection[str] = ()) -> float:
        """Return how far the infant, or some of its bodies, reach from the hip along a direction, in [m]."""
        reaches_m = pose(self.tree, self.angles_rad).reaches(matrix_from_axis(ACROSS, self.pitch_rad).T @ direction)
        owners = [body.name for body in self.tree.bodies for _ in body.geoms]
        return max(r for r, owner in zip(reaches_m.tolist(), owners, strict=True) if not bodies or owner in bodies)

    def girth_m(self, bodies: tuple[str, ...]) -> float:
        """Return the largest radius of the solids of some bodies, in [m]; 0 if there is none."""
        geoms = (geom for body in self.tree.bodies if body.name in bodies for geom in body.geoms)
        return max((geom.size_m[0] for geom in geoms), default=0.0)

    def turned(self, angles_rad: Mapping[str, float]) -> "Fit":
        """Return the same with other angles of some joints."""
        return replace(self, angles_rad={**self.angles_rad, **angles_rad})

    def state(self, height_m: float) -> State:
        """Return the infant with its hip at a height, as qpos."""
        return (0.0, 0.0, height_m, *quaternion_from_axis(ACROSS, self.pitch_rad), *self.angles_rad.values())


def fit(tree: BodyTree, recline_deg: float) -> Fit:
    """Return how an infant sits: trunk and head lean on the back as they lie on a floor, thighs lie on the bottom.

    The forearms are as in the pose `sitting`, above the side boards, and the shanks hang.
    """
    poses = poses_of(tree)
    supine, sitting = poses["supine"], poses["sitting"]
    of_arms = {joint: angle for joint, angle in sitting.angles_deg.items() if any(part in joint for part in ARMS)}
    of_trunk = {joint: angle for joint, angle in supine.angles_deg.items() if "{side}" not in joint}
    angles = pose_angles(tree, Pose(0.0, {**of_trunk, **of_arms, **REST_DEG}))
    trunk = remove_parts(tree, LIMBS)
    lying = rollers(trunk, [{joint: angles[joint] for joint in trunk.joints}])
    ((lying_rad, back_m),) = lying.rest(np.array([math.radians(supine.pitch_deg)]))
    seated = Fit(tree, angles, lying_rad + math.radians(90.0 - recline_deg), recline_deg, back_m)
    for side in SIDES:
        seated = seated.turned(_leg(seated, side))
    present = [body.name for body in tree.bodies if body.name in ("hip", *THIGHS)]
    return replace(seated, bottom_m=seated.reach_m(seated.below, present))


def _leg(seated: Fit, side: str) -> dict[str, float]:
    """Return the angles of hip and knee with the thigh along the bottom, and the shank hanging, in [rad]."""
    hip = f"robot:{side}_hip1"
    knee = f"robot:{side}_knee"
    thigh = f"{side}_upper_leg"
    joints = seated.tree.joints
    if hip not in joints:
        return {}
    hip_m = seated.reach_m(seated.below, ("hip",))

    def deeper_m(angle_rad: float) -> float:
        return seated.turned({hip: angle_rad}).reach_m(seated.below, (thigh,)) - hip_m

    along_rad = -math.radians(90.0 + seated.tilt_deg) - seated.pitch_rad
    is_below = deeper_m(along_rad) >= 0
    bent_rad = along_rad if is_below else root(deeper_m, along_rad, along_rad + SLACK_RAD, PRECISION_RAD)
    bent_deg = clip(joints[hip], round(math.degrees(bent_rad), 4))
    if knee not in joints:
        return {hip: math.radians(bent_deg)}
    hanging_deg = bent_deg + math.degrees(seated.pitch_rad) + SWUNG_DEG
    return {hip: math.radians(bent_deg), knee: math.radians(clip(joints[knee], round(hanging_deg, 4)))}


def _direction(elevation_deg: float) -> FloatArray:
    return np.array([math.cos(math.radians(elevation_deg)), 0.0, math.sin(math.radians(elevation_deg))])


def build(spec: SeatSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a seat: back, bottom, a board on either side, and a foot on the floor; the hip is above the origin."""
    seated = fit(surroundings.tree, spec.recline_deg)
    name = object_name(spec.name)
    cloth = finish(name, spec.colour, specular=0.0)
    wood = finish(f"{name}_wood", WOOD)
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
