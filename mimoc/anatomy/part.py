"""Parts of the body: what does not grow about them, what their sizes follow, and sizes and places as plain values."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from mimoc.base.errors import GeometryError
from mimoc.base.geometry.rotations import Vec3
from mimoc.base.kinds import Code, Component


@dataclass(frozen=True, slots=True)
class GeomShape:
    """Size and centre of a geom, as in MuJoCo."""

    size_m: tuple[float, ...]
    pos_m: Vec3


@dataclass(frozen=True, slots=True)
class BodyGeometry:
    """Sizes and positions of the right side, by the names in `anatomy`."""

    origins: Mapping[str, Vec3] = field(default_factory=dict)
    """Origins of bodies, in the frame of their parent."""
    shapes: Mapping[str, GeomShape] = field(default_factory=dict)
    """Shapes of geoms, in the frame of their body."""
    anchors: Mapping[str, Vec3] = field(default_factory=dict)
    """Anchors of the joints that are not at the origin of their body."""

    def __or__(self, other: "BodyGeometry") -> "BodyGeometry":
        return BodyGeometry(
            {**self.origins, **other.origins}, {**self.shapes, **other.shapes}, {**self.anchors, **other.anchors}
        )


def along(
    what: str, length_m: float, radius_m: float, embed_m: float, y_m: float = 0.0, down: bool = False
) -> GeomShape:
    """Return a capsule on z from a joint to *embed_m* beyond the next; GeometryError if it is wider than long."""
    axis_m = length_m + embed_m - radius_m
    if axis_m <= 0:
        raise GeometryError(f"{what}: a limb {length_m:.3f} m long cannot be {2 * radius_m:.3f} m thick")
    return GeomShape((radius_m, axis_m / 2), (0.0, y_m, -axis_m / 2 if down else axis_m / 2))


GeomType = Literal["sphere", "capsule", "cylinder", "ellipsoid", "box"]
Development = Literal["maturing", "published"]  # The laws of everything that changes with age besides size.
Region = Literal["trunk", "head", "limb"]
"""Bodies that limbs hang on, the head, and all others, which an infant may lack."""

MATURING_GROUPS = ("neck", "trunk", "arm", "hand", "hip", "knee", "ankle", "eyes")
"""Groups whose strength matures together (`strength.STRENGTH`)."""

ALONG_Y: Vec3 = (90.0, 0.0, 0.0)
ALONG_X: Vec3 = (0.0, 90.0, 0.0)
UPRIGHT: Vec3 = (0.0, 0.0, 0.0)

REFERENCE_AGE_MONTHS = 18.0  # Age at which children have MIMo's masses and the gears of its motors.
REST_ABDUCTION_DEG = 13.0
"""Angle between hanging upper arms and the vertical when all joints are at zero, such that they clear the chest (D;
MIMo 10, with thinner chests)."""

WRIST = ("elbow_hand_length", "hand_length", "hand_breadth", "upper_arm_circumference", "forearm_circumference")
"""What the place of the hand on the forearm follows."""

TRUNK_HEIGHT = ("crown_rump_length", "head_circumference", "hip_circumference", "hip_breadth")
"""What the spacing of the trunk's parts follows: what head and pelvis leave of the crown-rump length."""
SHOULDERS = ("shoulder_breadth", "upper_arm_circumference", "chest_circumference", "chest_breadth", *TRUNK_HEIGHT)
"""What places the shoulders: arms may be nearer to the midline the higher above the chest they are."""
THIGH_LENGTH = (
    *("crown_sole_length", "crown_rump_length", "hip_circumference", "hip_breadth", "rump_knee_length"),
    *("knee_sole_length", "mid_thigh_circumference", "calf_circumference"),
)
"""What the length of the thigh follows."""
LEG_LENGTH = (*THIGH_LENGTH, "foot_length", "foot_breadth")
"""What the length of the shank follows; a foot's length and breadth make its height."""
AXIAL_RULE = "trunk height (crown_rump_length less head and pelvis) in the reference body's proportions"
"""The rule that places the parts of the trunk, and the head."""
LEG_SHARE = (
    "leg length (crown_sole_length less trunk and foot), shared such that rump_knee_length and knee_sole_length, with "
    "the flesh behind the hip, before the knee and above it, are in proportion"
)
"""The rule that places knee and ankle."""


@dataclass(frozen=True, slots=True)
class ReferenceGeom:
    """What does not grow about a geom, and what its size follows."""

    name: str
    type: GeomType
    mass_kg: float
    """In MIMo, at the size that it has there."""
    size_from: tuple[str, ...]
    """The measurements its size comes from."""
    rule: str
    """How its size comes from them, for people."""
    euler_deg: Vec3 = UPRIGHT
    friction: Vec3 = (1.0, 0.005, 0.0002)
    contype: int = 1
    conaffinity: int = 1
    condim: int = 3
    position_from: tuple[str, ...] = ()
    """The measurements that only its place comes from."""
    material: str = "skin"
    """Name of its material (`mimoc.compiler.looks.appearance`)."""
    grips: bool = False
    """Whether its contacts are those of a hand that holds on (`mimoc.anatomy.anatomy.GRIP`)."""
    slippery: bool = False
    mass_at_m: tuple[float, ...] = ()
    """The size at which it has this mass, where that is not its size in the average child of 18 months."""


@dataclass(frozen=True, slots=True)
class ReferenceJoint:
    """A hinge of the right side; none of its figures grow."""

    name: str
    axis: Vec3
    range_deg: tuple[float, float]
    stiffness_nm_per_rad: float
    damping_nms_per_rad: float
    frictionloss_nm: float
    armature_kgm2: float
    springref_deg: float = 0.0
    left_axis: Vec3 | None = None
    """Axis of the left side, where it is not the mirror image of the right one's."""


@dataclass(frozen=True, slots=True)
class ReferenceMotor:
    """What moves a joint, at 18 months."""

    name: str
    joint: str
    gear_nm: float
    """Torque at full command."""
    force_range: tuple[float, float]
    """Fraction of the gear that is available towards negative and positive angles."""
    vmax_lengths_per_s: float
    """The fastest that its muscles shorten, in optimal lengths a second; it does not grow."""
    driven_geom: str
    """The geom whose volume its gear grows with."""
    fmax: tuple[float, ...] = ()
    """FMAX of the muscles in its place, towards negative and positive angles, if it does not follow from the gear."""


@dataclass(frozen=True, slots=True)
class ReferencePart:
    """A body of the reference model: all that there is to say of it but its shape."""

    name: str
    parent: str | None
    geoms: tuple[ReferenceGeom, ...]
    joints: tuple[ReferenceJoint, ...] = ()
    euler_deg: Vec3 = UPRIGHT
    position_from: tuple[str, ...] = ()
    """The measurements its place in its parent comes from."""
    rule: str = "at the origin of its parent"
    """How its place comes from them, for people."""
    keeps_clear_of: str = ""
    """Another part than its parent that moves it when a spec scales either of them."""
    motors: tuple[ReferenceMotor, ...] = ()
    """What moves its joints, in MIMo's order."""
    region: Region = "limb"
    """No infant is without trunk and head; a limb can be removed."""
    group: str = ""
    """Muscle group of its joints, and of the parts below it that have none of their own; empty is its parent's."""
    matures_with: str = ""
    """Group whose strength matures together (`strength.STRENGTH`); empty is its muscle group's, or its parent's."""
    skin_spacing_m: float | None = field(kw_only=True)
    """Distance of neighbouring skin points of the average child of 18 months: its two-point discrimination (MIMo).
    None is a single point, at its front."""
    torque_site: str = ""
    """MIMo's name of the site that measures the torque between it and its parent; empty is none."""
    runs_along_x: bool = False
    """Whether its length runs along x; that of other parts runs along z."""


@dataclass(frozen=True, slots=True, eq=False)
class PartKind(Component):
    """Parts of the body that belong together: a tail, a pair of wings, other hands."""

    name: str
    """Name in the spec's `body.extra`, or value of its `body.hands`."""
    about: str
    parts: "tuple[ReferencePart, ...]"
    """Their joints, geoms and motors at 18 months, parents first; a name with `{side}` is on both sides."""
    shape: Code
    """`shape(proportions) -> Dimensions`: sizes and places of the geoms, and places of the parts, of the right side."""
    replaces: Literal["hands"] | None = None
    """What it is in place of; None is an addition. Hands begin with `{side}_hand`, which is on `{side}_lower_arm`."""
    excluded: tuple[tuple[str, str], ...] = ()
    """Pairs of bodies without contacts."""
    masses_kg: Mapping[str, float] = field(default_factory=dict)
    """Masses at 18 months that geoms of other parts have with these, where they are not the usual ones."""
