"""How an infant sits in a seat, and where the planes of the seat touch it."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from mimoc.base.geometry.rotations import matrix_from_axis, quaternion_from_axis
from mimoc.base.geometry.solvers import root
from mimoc.base.units import deg_to_rad, rad_to_deg
from mimoc.body.kinematics import FloatArray, frames, pose
from mimoc.body.poses import CONTACT_DEPTH_M, Pose, clip, pose_angles, poses_of, rollers
from mimoc.body.tree import BodyTree, remove_parts
from mimoc.compiler.objects.boards import ACROSS
from mimoc.compiler.objects.starts import State
from mimoc.schema.names import SIDES

LIMBS = tuple(f"{side}_upper_{limb}" for side in SIDES for limb in ("arm", "leg"))
THIGHS, SHANKS = (tuple(f"{side}_{part}_leg" for side in SIDES) for part in ("upper", "lower"))
ARMS = ("shoulder", "elbow", "hand", "finger", "ff_", "mf_", "rf_", "lf_", "th_")
"""What the names of the joints of arms contain."""
TILT = 0.5
"""How far the bottom is tilted, for one degree by which the back leans: with friction, nobody slides out."""
REST_DEG: Mapping[str, float] = {"{side}_hip2": -15.0, "{side}_hip3": 0.0, "{side}_shoulder_horizontal": -7.0}
"""Thighs are somewhat apart, and upper arms hang back."""
SWUNG_DEG = 6.0
"""How far before the vertical shanks hang, since knees are stiff; measured at 1 to 24 months."""
SLACK_RAD = 0.6
"""How far a thigh can be turned down until it touches a bottom that the hip already touches."""
PRECISION_RAD = 1e-6


@dataclass(frozen=True)
class Fit:
    """An infant in a seat; upright is along z, as in the world, x ahead, with the hip at the origin."""

    tree: BodyTree
    angles_rad: Mapping[str, float]
    pitch_rad: float
    """Rotation of the hip about y."""
    recline_deg: float
    """Of the back from the vertical."""
    back_m: float
    """Distance of the surface of the back from the hip."""
    bottom_m: float = 0.0
    """Distance of the surface of the bottom from the hip."""

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
        turn, placed = matrix_from_axis(ACROSS, self.pitch_rad), frames(self.tree, self.angles_rad)
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
    ((lying_rad, back_m),) = lying.rest(np.array([deg_to_rad(supine.pitch_deg)]))
    seated = Fit(tree, angles, lying_rad + deg_to_rad(90.0 - recline_deg), recline_deg, back_m)
    for side in SIDES:
        seated = seated.turned(_leg(seated, side))
    present = [body.name for body in tree.bodies if body.name in ("hip", *THIGHS)]
    return replace(seated, bottom_m=seated.reach_m(seated.below, present))


def _leg(seated: Fit, side: str) -> dict[str, float]:
    """Return the angles of hip and knee with the thigh along the bottom, and the shank hanging, in [rad]."""
    hip, knee, thigh = f"robot:{side}_hip1", f"robot:{side}_knee", f"{side}_upper_leg"
    joints = seated.tree.joints
    if hip not in joints:
        return {}
    hip_m = seated.reach_m(seated.below, ("hip",))

    def deeper_m(angle_rad: float) -> float:
        return seated.turned({hip: angle_rad}).reach_m(seated.below, (thigh,)) - hip_m

    along_rad = -deg_to_rad(90.0 + seated.tilt_deg) - seated.pitch_rad
    is_below = deeper_m(along_rad) >= 0
    bent_rad = along_rad if is_below else root(deeper_m, along_rad, along_rad + SLACK_RAD, PRECISION_RAD)
    bent_deg = clip(joints[hip], round(rad_to_deg(bent_rad), 4))
    if knee not in joints:
        return {hip: deg_to_rad(bent_deg)}
    hanging_deg = bent_deg + rad_to_deg(seated.pitch_rad) + SWUNG_DEG
    return {hip: deg_to_rad(bent_deg), knee: deg_to_rad(clip(joints[knee], round(hanging_deg, 4)))}


def _direction(elevation_deg: float) -> FloatArray:
    """Return a unit vector in the plane y = 0 by its elevation from x, shape (3,)."""
    return np.array([math.cos(deg_to_rad(elevation_deg)), 0.0, math.sin(deg_to_rad(elevation_deg))])
