"""What builders of objects take and return (an infant in its pose, an unplaced object), and parts of objects."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from mimoc.base.geometry.rotations import Quaternion, Vec3, quaternion_between
from mimoc.base.units import GRAVITY_M_S2
from mimoc.body.kinematics import FloatArray, Posed, frames_in_world, hip_in_world, pose
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.elements import BARE, UNTOUCHED, Furniture, Rgba, WorldMaterial
from mimoc.compiler.mjcf.world import MeshFile, ObjectBody, ObjectGeom, PlacedObject
from mimoc.compiler.scenes import Placement, footprint
from mimoc.compiler.toys import UPRIGHT
from mimoc.schema.objects import Motion, ObjectEntry, Substance, WaterEntry

DAMPING_RATIO = 0.05
"""Damping ratio of what hangs: a swing falls to a third in about three and a half periods; an assumption."""
STRING_M = 0.001  # Radius of a string.
CONDIM = {"sphere": 6, "ellipsoid": 6, "cylinder": 6, "capsule": 6, "box": 4}
"""`condim`: 4 is sliding and spinning friction, 6 adds rolling friction, without which what is round never rests."""


def seen(
    name: str, material: str, shape: str, size_m: tuple[float, ...], pos_m: Vec3, quat: Quaternion = UPRIGHT
) -> ObjectGeom:
    """Return a primitive without contacts or mass."""
    sizes = (("size", size_m),)
    return ObjectGeom(name, shape, material, sizes, (), pos_m, quat, contype=UNTOUCHED, conaffinity=UNTOUCHED, group=1)


def solid(
    name: str,
    material: str,
    shape: str,
    size_m: tuple[float, ...],
    pos_m: Vec3,
    mass_kg: float,
    quat: Quaternion = UPRIGHT,
) -> ObjectGeom:
    """Return a primitive that touches things, sized as in MuJoCo, whose material has this name."""
    sizes = (("size", size_m),)
    return ObjectGeom(name, shape, material, sizes, (), pos_m, quat, mass_kg, condim=CONDIM[shape])


def bar(name: str, material: str, radius_m: float, start_m: FloatArray, end_m: FloatArray) -> ObjectGeom:
    """Return a capsule between two points, shape (3,) each."""
    length_m = float(np.linalg.norm(end_m - start_m))
    x_m, y_m, z_m = ((start_m + end_m) / 2).tolist()
    quat = quaternion_between(np.array([0.0, 0.0, 1.0]), (end_m - start_m) / length_m)
    return seen(name, material, "capsule", (radius_m, length_m / 2), (x_m, y_m, z_m), quat)


def string(name: str, material: str, length_m: float) -> ObjectGeom:
    """Return a string from the origin down."""
    return seen(name, material, "capsule", (STRING_M, length_m / 2), (0.0, 0.0, -length_m / 2))


def moved(geom: ObjectGeom, by_m: Vec3) -> ObjectGeom:
    """Return a geom elsewhere in its body."""
    x_m, y_m, z_m = np.add(geom.pos_m, by_m).tolist()
    return replace(geom, pos_m=(x_m, y_m, z_m))


def pendulum_damping(*hanging: tuple[float, float, float]) -> float:
    """Return the damping of a ball joint that bodies hang from, in [N m s/rad]: c = 2 z sqrt(g (sum m l) (sum I)).

    Args:
        hanging: Of each body, its mass m, the distance l from the joint to its centre, and about how large it is, r:
            its moment of inertia about the joint is I = m (l² + 2 r² / 5).
    """
    moment_kgm = math.fsum(mass_kg * length_m for mass_kg, length_m, _ in hanging)
    inertia_kgm2 = math.fsum(mass_kg * (length_m**2 + 0.4 * radius_m**2) for mass_kg, length_m, radius_m in hanging)
    return 2 * DAMPING_RATIO * math.sqrt(GRAVITY_M_S2 * moment_kgm * inertia_kgm2)


@dataclass(frozen=True, slots=True)
class BuiltObject:
    """An object in a frame of its own: what its place is said of is above the origin, its lowest point at z = 0."""

    root: ObjectBody  # Its outermost body; its place there is in this frame.
    materials: tuple[WorldMaterial, ...]
    motion: Motion
    material: Substance  # What it is made of.
    radius_m: float  # Radius of a vertical cylinder about the origin that encloses it.
    height_m: float  # Height of its highest point that something can lie on or be above.
    size_m: float  # Its longest side.
    mass_kg: float
    surface_m: tuple[float, float] | None = None
    """Half lengths along x and y of the level surface on top of it, on which other objects can lie; None for none."""
    discs: tuple[Vec3, ...] = ()
    """The floor below it, as discs by x, y and radius, if the cylinder that encloses it is too wide for that."""
    meshes: tuple[MeshFile, ...] = ()
    pictures: Furniture = BARE  # Textures, and materials with textures.
    bells: tuple[str, ...] = ()  # Names of the geoms that ring.
    tie: "Tie | None" = None  # Its ribbon, if it has one.
    water: WaterEntry | None = None  # What the runtime must know if it is water.
    notes: tuple[str, ...] = ()  # What is to be known of its shape, for the README of a bundle.
    origins: Mapping[str, Entry] = field(default_factory=dict)
    """Where its numbers come from, by the end of their keys in `provenance.json`."""

    def discs_at(self, pos_m: Vec3, yaw_rad: float) -> tuple[Vec3, ...]:
        """Return the floor below it at a place in the world, as discs by x, y and radius, in [m]."""
        (x_m, y_m, _), cosine, sine = pos_m, math.cos(yaw_rad), math.sin(yaw_rad)
        return tuple(
            (x_m + cosine * x - sine * y, y_m + sine * x + cosine * y, radius)
            for x, y, radius in self.discs or ((0.0, 0.0, self.radius_m),)
        )


@dataclass(frozen=True, slots=True)
class Tie:
    """A ribbon from an object to a limb of the infant."""

    limb: str  # The hand or the foot; it is tied at the wrist or the ankle.
    site: str  # The site of the object's outermost body that it begins at.
    slack_m: float  # By how much it is longer than its way at the start.
    rgba: Rgba


@dataclass(frozen=True, slots=True)
class PlacedThing:
    """An object at its place in the world."""

    name: str
    built: BuiltObject
    elements: PlacedObject  # All of it that stands in the MJCF.
    entry: ObjectEntry
    pos_m: Vec3  # Where the origin of its own frame is.
    yaw_rad: float

    @property
    def discs(self) -> tuple[Vec3, ...]:
        """The floor below it, as discs by x, y and radius, in [m]."""
        return self.built.discs_at(self.pos_m, self.yaw_rad)

    def bears(self, x_m: float, y_m: float, radius_m: float = 0.0) -> bool:
        """Return whether a place, with a disc around it, is over the level surface on top of it."""
        if self.built.surface_m is None:
            return False
        x, y = x_m - self.pos_m[0], y_m - self.pos_m[1]
        cosine, sine = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        half_x_m, half_y_m = (half - radius_m for half in self.built.surface_m)
        return abs(cosine * x + sine * y) <= half_x_m and abs(cosine * y - sine * x) <= half_y_m

    @property
    def top_m(self) -> float:
        """Height of its highest point."""
        return self.pos_m[2] + self.built.height_m


@dataclass(frozen=True)
class Surroundings:
    """What objects are built for and placed among: the infant as it starts, and the floor."""

    tree: BodyTree
    qpos: tuple[float, ...]  # The state in which it starts, in the world.
    start: Placement
    half_size_m: tuple[float, float]  # Half lengths of the floor along x and y, with its middle at the origin.
    has_floor: bool
    folder: Path  # Folder that paths in the spec are relative to.
    things: tuple[PlacedThing, ...] = ()  # The objects that are placed already.
    prefix: str = ""  # What the infant's names begin with in the model.
    taken: tuple[Vec3, ...] = ()  # Floor that other infants cover, as discs by x, y and radius, in [m].

    @cached_property
    def posed(self) -> Posed:
        """The infant's geoms in the world."""
        hip, turn = hip_in_world(self.qpos)
        posed = pose(self.tree, dict(zip(self.tree.joints, self.qpos[7:], strict=False)))
        return Posed(posed.geoms, posed.centres @ turn.T + hip, turn @ posed.rotations)

    @cached_property
    def frames(self) -> Mapping[str, tuple[FloatArray, FloatArray]]:
        """Origin and rotation of each part of the infant in the world."""
        return frames_in_world(self.tree, self.qpos)

    @cached_property
    def discs(self) -> FloatArray:
        """The floor that the infant and others cover, as discs by x, y and radius, shape (n, 3), [m]."""
        return np.concatenate([footprint(self.tree, [self.qpos]), np.reshape(self.taken, (-1, 3))])

    def part(self, name: str) -> Posed:
        """Return the geoms of a part of the infant in the world."""
        geoms = {geom.name for body in self.tree.bodies if body.name == self.tree.home(name) for geom in body.geoms}
        return self.posed.only([index for index, geom in enumerate(self.posed.geoms) if geom.name in geoms])

    def box(self, name: str) -> tuple[FloatArray, FloatArray]:
        """Return the lowest and the highest corner of the box around a part of the infant, shape (3,) each, [m]."""
        part = self.part(name)
        extents = np.array([part.extents.along(part.rotations[:, axis]) for axis in range(3)]).T
        return (part.centres - extents).min(axis=0), (part.centres + extents).max(axis=0)


def object_name(name: str) -> str:
    """Return the name of an object's outermost body, with which the names of all else of it begin."""
    return f"object_{name}"
