"""The grown body as plain values, in the order and with the names of MIMo's published models."""

from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.body.figures import GeomType, Region
from mimoc.geometry.rotations import Vec3

FREE_JOINT = "mimo_location"
"""MIMo's name for the joint between the world and the hip."""


@dataclass(frozen=True, slots=True)
class Geom:
    """One solid of a body part."""

    name: str
    type: GeomType
    size_m: tuple[float, ...]
    """As MuJoCo wants it: radius, then half length; half edges of a box."""
    pos_m: Vec3
    """Centre, in the frame of its body."""
    euler_deg: Vec3
    """Intrinsic x-y-z angles in the frame of its body."""
    mass_kg: float
    friction: Vec3
    """Sliding, torsional and rolling."""
    contype: int
    conaffinity: int
    condim: int
    """1, 3, 4 or 6: which relative motions friction resists."""
    material: str = "skin"
    """Name of its material."""


@dataclass(frozen=True, slots=True)
class Joint:
    """A hinge."""

    name: str
    axis: Vec3
    anchor_m: Vec3
    """Where it turns, in the frame of its body."""
    range_deg: tuple[float, float]
    stiffness_nm_per_rad: float
    damping_nms_per_rad: float
    frictionloss_nm: float
    armature_kgm2: float
    springref_deg: float


@dataclass(frozen=True, slots=True)
class Body:
    """A body part: the segment that moves with its joints."""

    name: str
    parent: str | None
    """None for the hip, which hangs in the world."""
    pos_m: Vec3
    """Origin, in the frame of its parent."""
    euler_deg: Vec3
    """Intrinsic x-y-z angles in the frame of its parent."""
    joints: tuple[Joint, ...]
    geoms: tuple[Geom, ...]
    region: Region
    """Whether it is of the trunk, the head or a limb."""
    group: str
    """Muscle group that begins with it; empty is its parent's."""
    skin_spacing_m: float | None
    """Distance of neighbouring skin points at 18 months; None is a single point, at its front."""
    torque_site: str
    """Name of the site that measures the torque between it and its parent; empty is none."""

    @property
    def mass_kg(self) -> float:
        """Mass of the part."""
        return sum(geom.mass_kg for geom in self.geoms)


@dataclass(frozen=True, slots=True)
class Motor:
    """What moves one joint, and how strongly."""

    name: str
    joint: str
    gear_nm: float
    """Torque at full command."""
    force_range: tuple[float, float]
    """Part of the gear that is reached towards negative and positive angles."""
    vmax_lengths_per_s: float
    """The fastest that its muscles shorten, in optimal lengths a second."""
    mover: str
    """The geom whose volume the gear follows."""
    factors: tuple[tuple[str, float], ...] = ()
    """What the spec multiplies the gear by: the key that says so, and the factor."""


@dataclass(frozen=True, slots=True)
class Tendon:
    """A linear combination of joint angles that is kept within a range."""

    name: str
    range_rad: tuple[float, float]
    coefficients: tuple[tuple[str, float], ...]
    """Joint and factor."""


@dataclass(frozen=True, slots=True)
class BodyTree:
    """An infant's body, standing straight, hip at the origin, x forward, y left, z up."""

    age_months: float
    hands: str
    """`mitten` or `five_finger`, also where hands are absent: feet differ too."""
    bodies: tuple[Body, ...]
    """Parents before children, in MIMo's order."""
    motors: tuple[Motor, ...]
    tendons: tuple[Tendon, ...]
    excluded: tuple[tuple[str, str], ...]
    """Pairs of bodies that pass through each other."""
    frictionless: tuple[tuple[str, str], ...]
    """Pairs of geoms that slide on each other."""
    merged: tuple[tuple[str, str], ...] = ()
    """Parts that are of one piece with another here, which has their geoms: their name, and that of the other."""

    def home(self, part: str) -> str:
        """Return the body that has a part's geoms: that of its name, or the one it is merged with."""
        return dict(self.merged).get(part, part)

    @property
    def geoms(self) -> Mapping[str, Geom]:
        """Every geom by name."""
        return {geom.name: geom for body in self.bodies for geom in body.geoms}

    @property
    def joints(self) -> Mapping[str, Joint]:
        """Every hinge by name."""
        return {joint.name: joint for body in self.bodies for joint in body.joints}

    @property
    def mass_kg(self) -> float:
        """Mass of the whole infant."""
        return sum(body.mass_kg for body in self.bodies)
