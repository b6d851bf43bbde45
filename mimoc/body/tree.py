"""The body as plain values, in the order and with the names of MIMo's published models, and places on its surface."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

from mimoc.anatomy.part import Development, GeomType, ReferenceMotor, Region
from mimoc.anatomy.parts.head import REFERENCE_HEAD_RADIUS_M
from mimoc.base.geometry.primitives import girth
from mimoc.base.geometry.rotations import Vec3
from mimoc.base.mujoco_layout import BODY_GROUP
from mimoc.schema.names import SIDES
from mimoc.schema.quantities import Direction

FREE_JOINT = "mimo_location"  # MIMo's name for the joint between the world and the hip.

Attributes = tuple[tuple[str, tuple[float, ...]], ...]  # Attributes in MJCF with their numbers.


@dataclass(frozen=True, slots=True)
class Geom:
    """One solid of a body part."""

    name: str
    type: GeomType
    size_m: tuple[float, ...]
    """Size as in MuJoCo: radius, then half length; half axes of an ellipsoid, half edges of a box."""
    pos_m: Vec3  # Centre, in the frame of its body.
    euler_deg: Vec3  # Intrinsic x-y-z angles in the frame of its body.
    mass_kg: float
    friction: Vec3
    contype: int
    conaffinity: int
    condim: int  # Contact dimension, 1, 3, 4 or 6: the relative motions that friction resists.
    material: str = "skin"
    settings: Attributes = ()  # Its other attributes in MJCF.
    group: int = BODY_GROUP
    """Group in which it is drawn: the body's, that of the solids under a skin, or 1 for what is only seen."""


@dataclass(frozen=True, slots=True)
class Joint:
    """A hinge."""

    name: str
    axis: Vec3
    anchor_m: Vec3  # Anchor, in the frame of its body.
    range_deg: tuple[float, float]
    stiffness_nm_per_rad: float
    damping_nms_per_rad: float
    frictionloss_nm: float
    armature_kgm2: float
    springref_deg: float
    margin_deg: float = 0.0  # How far before the ends of its range its limits act (`mimoc.body.joints`).
    changes: tuple[tuple[str, str, str], ...] = ()
    """What an impairment has changed of it: attribute in MJCF, what is said of it, and the key of the spec."""

    @property
    def settings(self) -> tuple[tuple[str, float], ...]:
        """Its other attributes in MJCF."""
        return (("margin", math.radians(self.margin_deg)),) if self.margin_deg else ()


@dataclass(frozen=True, slots=True)
class Body:
    """A body part, which its joints connect to its parent."""

    name: str
    parent: str | None  # Name of the parent; None for the hip, which is free in the world.
    pos_m: Vec3  # Origin, in the frame of its parent.
    euler_deg: Vec3  # Intrinsic x-y-z angles in the frame of its parent.
    joints: tuple[Joint, ...]
    geoms: tuple[Geom, ...]
    region: Region  # Whether it is of the trunk, the head or a limb.
    group: str  # Muscle group that begins with it; empty is its parent's.
    skin_spacing_m: float | None
    """Distance of neighbouring skin points at 18 months; None is a single point, at its front."""
    torque_site: str  # Name of the site that measures the torque between it and its parent; empty is none.

    @property
    def mass_kg(self) -> float:
        """Mass of the part."""
        return math.fsum(geom.mass_kg for geom in self.geoms)


@dataclass(frozen=True, slots=True)
class Tone:
    """The muscle tone of a joint of a quiet infant: a torque -k (q - q_0) within the strength of its motor."""

    stiffness_nm_per_rad: float  # k.
    angle_deg: float  # q_0, beyond the posture that tone holds, since a flexor does not resist flexion.
    factors: tuple[tuple[str, float], ...] = ()  # Factors of the spec on k: the key of the spec, and its value.


@dataclass(frozen=True, slots=True)
class StretchReflex:
    """What a spastic muscle does when it is stretched: a torque against the speed of its joint."""

    joint: str
    sign: int  # -1 for a torque towards negative angles, 1 for the other.
    slope_nms: float  # Torque by speed beyond the threshold.
    threshold_rad_s: float
    most_nm: float
    key: str  # Key of the spec that asks for it.
    motor: str

    @property
    def name(self) -> str:
        """Name of its actuator in the model."""
        way = "negative" if self.sign < 0 else "positive"
        return f"reflex:{self.joint.removeprefix('robot:')}_{way}"


@dataclass(frozen=True, slots=True)
class Motor(ReferenceMotor):
    """The motor of one joint of an infant, with the names of its side and the strength of its size and age."""

    factors: tuple[tuple[str, float], ...] = ()  # Factors of the spec on the gear: the key of the spec, and its value.
    tone: Tone | None = None  # Its muscle tone; None if it has none, as by the published law.
    fastest_rad_s: float | None = None
    """Speed of the joint at which it no longer pulls at full command; None by the published law."""


@dataclass(frozen=True, slots=True)
class Tendon:
    """A linear combination of joint angles that is limited to a range."""

    name: str
    range_rad: tuple[float, float]
    coefficients: tuple[tuple[str, float], ...]  # Joints and their factors.


@dataclass(frozen=True, slots=True)
class MaturationFactors:
    """What a child's strength and joints mature with, besides its age."""

    relative_length: float  # Standing height, relative to the average child of 18 months.
    relative_volumes: Mapping[str, float]
    """Volume that the strength of each joint's motor follows, relative to 18 months, by joint."""
    head_gain: float  # Mass of head and neck, relative to the published law.
    mature_months: float  # Age of the average child that is as mature: the age times the rate of maturation.
    is_usual: bool = True  # Whether that is its own age.
    lean_gain: float = 1.0  # Lean share of the body, relative to the average child of the same age.
    lean_keys: tuple[str, ...] = ()
    """Keys of the spec that the lean share follows from, where it is not the average child's."""


@dataclass(frozen=True, slots=True)
class BodyTree:
    """An infant's body, standing straight, hip at the origin, x forward, y left, z up."""

    age_months: float
    hands: str  # Kind of its hands, even if they are removed, because feet differ too.
    bodies: tuple[Body, ...]  # Parents before children, in MIMo's order.
    motors: tuple[Motor, ...]
    tendons: tuple[Tendon, ...]
    excluded: tuple[tuple[str, str], ...]  # Pairs of bodies without contacts.
    frictionless: tuple[tuple[str, str], ...] = ()  # Pairs of geoms that slide on each other.
    extra: tuple[str, ...] = ()  # Kinds of parts that it has besides MIMo's.
    development: Development = "maturing"  # The law that strength, joints and proportions follow.
    growth: MaturationFactors | None = field(default=None, hash=False)
    """What the law `maturing` made of the body; None by the published law."""
    reflexes: tuple[StretchReflex, ...] = ()
    acuity: tuple[tuple[str, float], ...] = ()
    """Share of the visual acuity that is left, by body of an eye; all of it where nothing is said."""
    field_deg: tuple[tuple[Direction, float], ...] = ()
    """How far its eyes see to a side of their line of sight: `left`, `right`, `up`, `down`; as far as their pictures
    reach where nothing is said."""
    merged: tuple[tuple[str, str], ...] = ()
    """Parts that are merged into another part, which has their geoms: name of the part and of the other."""
    clothes: str = "shirt_and_trousers"  # What its skin wears (`mimoc/schema/body.py`).

    def home(self, part: str) -> str:
        """Return the body that has a part's geoms: the one of that name, or the one it is merged into."""
        return dict(self.merged).get(part, part)

    def parts_of(self, body: str) -> tuple[str, ...]:
        """Return the names of the parts whose geoms a body has, in the order of these: its own, and those merged."""
        return (body, *(part for part, home in self.merged if home == body))

    @property
    def geoms(self) -> Mapping[str, Geom]:
        """Every geom by name."""
        return {geom.name: geom for body in self.bodies for geom in body.geoms}

    @property
    def joints(self) -> Mapping[str, Joint]:
        """Every hinge by name."""
        return {joint.name: joint for body in self.bodies for joint in body.joints}

    @property
    def body_groups(self) -> Mapping[str, str]:
        """The muscle group that moves each body."""
        groups: dict[str, str] = {}
        for body in self.bodies:
            groups[body.name] = body.group or groups[body.parent or body.name]
        return groups

    @property
    def muscle_groups(self) -> Mapping[str, str]:
        """The muscle group that moves each joint."""
        of_body = self.body_groups
        return {joint.name: of_body[body.name] for body in self.bodies for joint in body.joints}

    @property
    def mass_kg(self) -> float:
        """Mass of the whole infant."""
        return math.fsum(body.mass_kg for body in self.bodies)


def mirror(vector: Vec3, left: bool) -> Vec3:
    """Return a position, mirrored in y for the left side."""
    x, y, z = vector
    return (x, -y, z) if left else vector


def mirror_turn(vector: Vec3, left: bool) -> Vec3:
    """Return an axis or Euler angles, mirrored in y: rotations about x and z change sign, about y they do not."""
    x, y, z = vector
    return (-x, y, -z) if left else vector


def remove_parts(tree: BodyTree, names: Collection[str]) -> BodyTree:
    """Return a body without the named parts, the parts attached to them, and all references to these."""
    if not names:
        return tree
    gone: set[str] = set()
    for body in tree.bodies:
        if body.name in names or body.parent in gone:
            gone.add(body.name)
    bodies = tuple(body for body in tree.bodies if body.name not in gone)
    joints = {joint.name for body in bodies for joint in body.joints}
    return replace(
        tree,
        bodies=bodies,
        motors=tuple(motor for motor in tree.motors if motor.joint in joints),
        reflexes=tuple(reflex for reflex in tree.reflexes if reflex.joint in joints),
        tendons=tuple(tendon for tendon in tree.tendons if all(joint in joints for joint, _ in tendon.coefficients)),
        excluded=tuple(pair for pair in tree.excluded if gone.isdisjoint(pair)),
    )


_REFERENCE_CENTRE_M: Vec3 = (0.01, 0.0, REFERENCE_HEAD_RADIUS_M)  # Centre of MIMo's head, in its frame.


def head_radius(head: Geom) -> float:
    """Return the radius of a circle with the head's circumference, in [m]."""
    return head.size_m[0] if head.type == "sphere" else girth(head.type, head.size_m) / (2 * math.pi)


def on_head(head: Geom, place: Vec3) -> Vec3:
    """Return a place in the frame of the head's body, in [m], from one in half axes: x forward, y left, z up."""
    x, y, z = (middle + half_m * part for middle, half_m, part in zip(head.pos_m, half_axes(head), place, strict=True))
    return x, y, z


def as_on_mimos_head(head: Geom, pos_m: Vec3) -> Vec3:
    """Return the place that corresponds to one on MIMo's head, a sphere; both in the frame of the head's body."""
    if head.type == "sphere":
        size = head.size_m[0] / REFERENCE_HEAD_RADIUS_M
        return pos_m[0] * size, pos_m[1] * size, pos_m[2] * size
    x, y, z = (
        (part_m - middle_m) / REFERENCE_HEAD_RADIUS_M
        for part_m, middle_m in zip(pos_m, _REFERENCE_CENTRE_M, strict=True)
    )
    return on_head(head, (x, y, z))


def half_axes(head: Geom) -> Vec3:
    """Return the half axes of a head, [m]."""
    radius_m = head.size_m[0]
    return (radius_m, radius_m, radius_m) if head.type == "sphere" else (radius_m, head.size_m[1], head.size_m[2])


BEGINS: Mapping[str, str] = {
    part.format(side=side): region.format(side=side)
    for side in SIDES
    for part, region in (
        ("{side}_upper_arm", "{side}_arm"),
        ("{side}_hand", "{side}_hand"),
        ("{side}_upper_leg", "{side}_leg"),
        ("{side}_foot", "{side}_foot"),
    )
}
"""The region that begins with a body, and ends where another begins."""
PALMS_AND_SOLES = frozenset(region for body, region in BEGINS.items() if body.endswith(("hand", "foot")))
"""Regions that count as smooth skin, without hair."""


def region_of_bodies(body: BodyTree) -> dict[str, str]:
    """Return the region of each body by name; parts that no child has are regions of their own names."""
    regions: dict[str, str] = {}
    for part in body.bodies:
        former = regions.get(part.parent or "", "trunk")
        if part.region != "limb":
            regions[part.name] = part.region
        else:
            regions[part.name] = BEGINS.get(part.name, part.name if former == "trunk" else former)
    return regions
