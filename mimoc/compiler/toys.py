"""Toys: their shapes, which of them a scene has and where, and their elements in MJCF with the provenance of these."""

import colorsys
import math
import re
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from mimoc.base.geometry import primitives
from mimoc.base.geometry.primitives import Extents, Kind, extents
from mimoc.base.geometry.rotations import FloatArray, Quaternion, Vec3, matrix_from_quaternion, quaternion_from_axis
from mimoc.base.random_streams import SEED, between, drawn_rule, pick, stream, whole_between
from mimoc.base.units import cm_to_m
from mimoc.body.origins import Entry
from mimoc.compiler.mjcf.elements import DOMINANT_SOLMIX, SOLID, UNTOUCHED, Rgba, WorldMaterial
from mimoc.compiler.mjcf.world import FreeObject, MeshFile, ObjectGeom
from mimoc.schema.objects import ToysSpec

IntArray = npt.NDArray[np.intp]

Tint = Literal["main", "accent", "dark", "light"]
"""Colour of a part: the toy's random colour, a contrasting one, near-black or near-white."""
SolidType = Literal["sphere", "capsule", "cylinder", "ellipsoid", "box", "mesh"]

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A triangle mesh whose faces point outwards; its arrays become read-only."""

    vertices: FloatArray  # Shape (n, 3).
    faces: IntArray  # Shape (m, 3).

    def __post_init__(self) -> None:
        self.vertices.flags.writeable = self.faces.flags.writeable = False

    @property
    def volume(self) -> float:
        """Volume inside a closed mesh; where shells overlap, it counts once for each shell."""
        a, b, c = (self.vertices[self.faces[:, corner]] for corner in range(3))
        return float(np.einsum("ij,ij->", np.cross(a, b), c) / 6)


def join(meshes: Sequence[Mesh]) -> Mesh:
    """Return several meshes joined into one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)]
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def centre_of(mesh: Mesh) -> FloatArray:
    """Return the centre of mass of the volume of a convex mesh, from tetrahedra between its faces and its middle."""
    middle = mesh.vertices.mean(axis=0)
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] - middle for corner in range(3))
    volumes = np.einsum("ij,ij->i", np.cross(a, b), c)
    return middle + volumes @ (a + b + c) / (4 * volumes.sum())


@dataclass(frozen=True, slots=True)
class Part:
    """A visible part of a toy."""

    mesh: Mesh
    tint: Tint = "main"


@dataclass(frozen=True, slots=True)
class Solid:
    """A convex collision shape of a toy."""

    type: SolidType
    size: tuple[float, ...]
    """Size as in MuJoCo (radius, then half length along z; half edges; half axes); empty for a mesh."""
    pos: Vec3 = (0.0, 0.0, 0.0)
    quat: Quaternion = UPRIGHT
    mesh: Mesh | None = None  # The mesh, if `type` is `mesh`, whose convex hull is the solid.


@dataclass(frozen=True, slots=True)
class ToyModel:
    """The shape of a toy. Lengths are in units of its longest side; it stands on z = 0, centred over the origin."""

    name: str  # Name of the object, such as `truck_003`.
    category: str  # Category of the object, as in Toys4K, such as `truck`.
    parts: tuple[Part, ...]
    solids: tuple[Solid, ...]  # Its collision shapes.
    volume: float  # Volume that has the density below.
    density_kg_m3: float  # Mean density, including cavities.
    source: str  # Origin of the shape, for the README of a bundle.
    notes: tuple[str, ...] = ()  # Notes for the user of a bundle with this toy.


_ANGLES = np.linspace(0, math.tau, 48, endpoint=False)
_AROUND = np.stack([np.cos(_ANGLES), np.sin(_ANGLES), np.zeros(48)], axis=1)  # Horizontal directions.


def bounds(solid: Solid) -> tuple[FloatArray, FloatArray]:
    """Return the lower and the upper corner of a solid's axis-aligned bounding box."""
    at = np.array(solid.pos)
    extent = _extents(solid).along(matrix_from_quaternion(solid.quat)[:, None])[:, 0]
    return at - extent, at + extent


def radius(solid: Solid) -> float:
    """Return the largest distance of a solid's points from the z axis."""
    at = np.array(solid.pos)
    axes = matrix_from_quaternion(solid.quat)
    if solid.mesh is not None:
        return float(np.linalg.norm((at + solid.mesh.vertices @ axes.T)[:, :2], axis=1).max())
    extent = _extents(solid).along((_AROUND @ axes)[:, None])[:, 0]
    return float((_AROUND @ at + extent).max()) / math.cos(math.pi / len(_AROUND))


def solid_volume(solid: Solid) -> float:
    """Return the volume of a solid."""
    return solid.mesh.volume if solid.mesh else primitives.volume(_kind(solid), solid.size)


def _extents(solid: Solid) -> Extents:
    return extents([(_kind(solid), solid.size)])


def _kind(solid: Solid) -> Kind:
    assert solid.type != "mesh"
    return solid.type


SOURCE = "made by mimoc"

Looks = Mapping[Tint, Sequence[Mesh]]  # Visual meshes by colour.


def assemble(category: str, looks: Looks, solids: Sequence[Solid], density_kg_m3: float) -> ToyModel:
    """Return a toy whose longest side is 1, which stands on z = 0 and is centred over the origin.

    Visual meshes, which are closed, and solids are placed on the ground separately, since faceted meshes may end
    slightly above round solids. The toy is named as its category in Toys4K; its mean density includes cavities.

    """
    meshes: dict[Tint, Mesh] = {tint: join(shells) for tint, shells in looks.items()}
    vertices = np.concatenate([mesh.vertices for mesh in meshes.values()])
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    scale = 1 / float((high - low).max())
    origin = np.array([*(low + high)[:2] / 2, low[2]])
    ground = np.array([*origin[:2], min(bounds(solid)[0][2] for solid in solids)])
    parts = tuple(Part(Mesh((mesh.vertices - origin) * scale, mesh.faces), tint) for tint, mesh in meshes.items())
    return ToyModel(
        name=category,
        category=category,
        parts=parts,
        solids=tuple(_placed(solid, scale, ground) for solid in solids),
        volume=math.fsum(part.mesh.volume for part in parts),
        density_kg_m3=density_kg_m3,
        source=SOURCE,
    )


def _placed(solid: Solid, scale: float, origin: FloatArray) -> Solid:
    x, y, z = ((solid.pos - origin) * scale).tolist()
    return replace(solid, size=tuple(scale * length for length in solid.size), pos=(x, y, z))


SATURATION, BRIGHTNESS = (0.55, 0.9), (0.65, 0.95)
"""Ranges of the saturation and brightness of a toy's colour; its hue is unrestricted."""
ACCENT = (0.42, 0.58)  # Range of the difference in hue between the two colours of a toy, in turns: about opposite.
DARK: Rgba = (0.13, 0.13, 0.15, 1.0)
LIGHT: Rgba = (0.96, 0.95, 0.92, 1.0)


@dataclass(frozen=True, slots=True)
class Toybox:
    """A set of toys to choose from."""

    names: Sequence[str]
    load: Callable[[str], ToyModel]  # Function that returns the shape of a toy by its name.
    notes: tuple[str, ...] = ()  # Notes for the user of a bundle with such toys.
    progress: Callable[[int, int], None] = field(default=lambda done, total: None, compare=False)
    """Called with the number of a scene's toys that are loaded and their total; a mesh takes long the first time."""


@dataclass(frozen=True, slots=True)
class Toy:
    """A chosen toy, before it is placed."""

    model: ToyModel
    size_m: float  # Length of its longest side.
    yaw_rad: float  # Rotation about the vertical.
    colours: dict[Tint, Rgba]

    @property
    def mass_kg(self) -> float:
        """Mass."""
        return self.model.volume * self.size_m**3 * self.model.density_kg_m3

    @property
    def radius_m(self) -> float:
        """Radius of the smallest vertical cylinder about its origin that encloses its visual and collision geoms."""
        visual = (float(np.linalg.norm(part.mesh.vertices[:, :2], axis=1).max()) for part in self.model.parts)
        return self.size_m * max(*visual, *map(radius, self.model.solids))


def choose_toys(spec: ToysSpec, seed: int, box: Toybox) -> tuple[Toy, ...]:
    """Return a random number of toys from a box; the first n do not depend on the number."""
    count = whole_between(stream(seed, "toys.count"), *spec.count)
    which, sizes, colours, turns = (
        stream(seed, f"toys.{aspect}") for aspect in ("choice", "size", "colour", "orientation")
    )
    low_m, high_m = map(cm_to_m, spec.size_cm)
    toys: list[Toy] = []
    for done in range(count):
        box.progress(done, count)
        model = box.load(pick(which, box.names))
        size_m = between(sizes, low_m, high_m)
        toys.append(Toy(model, size_m, between(turns, 0.0, 2 * np.pi), _draw_colours(colours)))
    return tuple(toys)


def _draw_colours(generator: np.random.Generator) -> dict[Tint, Rgba]:
    hue, saturation, brightness = (between(generator, *ends) for ends in ((0.0, 1.0), SATURATION, BRIGHTNESS))
    other = (hue + between(generator, *ACCENT)) % 1.0
    main, accent = (_rgba(turn, saturation, brightness) for turn in (hue, other))
    return {"main": main, "accent": accent, "dark": DARK, "light": LIGHT}


def _rgba(hue: float, saturation: float, brightness: float) -> Rgba:
    red, green, blue = (round(channel, 4) for channel in colorsys.hsv_to_rgb(hue, saturation, brightness))
    return red, green, blue, 1.0


GAP_M = 0.01  # Smallest gap between a toy and anything next to it.
FADING = 0.5  # `fading_m` of the reachable floor, in arm lengths.
BATCH, BATCHES = 8, 256
"""Number of random positions that are tried at once, and number of such batches before there counts as no space."""


@dataclass(frozen=True, slots=True)
class ReachableFloor:
    """The part of the floor that an infant's hands can reach."""

    centre_m: tuple[float, float]  # Midpoint between its shoulders, projected onto the floor.
    radius_m: float  # Radius around the centre within which its hands reach the floor.
    fading_m: float  # Distance over which the density of toys beyond the radius falls by a factor of e.

    def density(self, distance_m: FloatArray) -> FloatArray:
        """Return the density of toys at a distance from the centre, relative to the density within reach."""
        return np.exp(-np.maximum(distance_m - self.radius_m, 0.0) / self.fading_m)

    def draw(self, count: int, generator: np.random.Generator) -> FloatArray:
        """Return random positions distributed according to `density`, shape (count, 2), [m]."""
        distance_m = self._draw_distances(count, generator)
        angle = 2 * np.pi * generator.random(count)
        return self.centre_m + distance_m[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    def _draw_distances(self, count: int, generator: np.random.Generator) -> FloatArray:
        """Return random distances from the centre, whose density is `density` times the circumference.

        Within the radius R it is r; beyond it, at r = R + t, it is R exp(-t/f) + t exp(-t/f).
        """
        radius_m, fading_m = self.radius_m, self.fading_m
        weights = np.cumsum([radius_m**2 / 2, radius_m * fading_m, fading_m**2])
        part = np.searchsorted(weights, weights[-1] * generator.random(count), side="right")
        within = radius_m * np.sqrt(generator.random(count))
        beyond = -fading_m * np.log1p(-generator.random((2, count)))
        return np.choose(part, [within, radius_m + beyond[0], radius_m + beyond.sum(axis=0)])


@dataclass(frozen=True, slots=True)
class Floor:
    """A floor and its occupied areas."""

    half_size_m: tuple[float, float]  # Half lengths along x and y; the origin is in the middle.
    taken_m: FloatArray  # Occupied discs: x, y and radius, shape (n, 3).


def place_toys(
    radii_m: Sequence[float], reach: ReachableFloor, floor: Floor, generator: np.random.Generator
) -> FloatArray | None:
    """Return a position for each toy, shape (n, 2), or None if there is no space for one of them.

    Positions are drawn by rejection, so that on the free floor the density of toys, whose radii are seen from above, is
    that of *reach*.
    """
    taken = list(map(tuple, floor.taken_m))
    places = np.empty((len(radii_m), 2))
    for index, radius_m in enumerate(radii_m):
        for _ in range(BATCHES):
            drawn = reach.draw(BATCH, generator)
            taken_m = np.array(taken).reshape(-1, 3)
            inside = (np.abs(drawn) + radius_m + GAP_M <= floor.half_size_m).all(axis=1)
            gaps_m = np.linalg.norm(drawn[:, None] - taken_m[:, :2], axis=2) - taken_m[:, 2] - radius_m
            free = np.flatnonzero(inside & (gaps_m >= GAP_M).all(axis=1))
            if free.size:
                break
        else:
            return None
        places[index] = drawn[free[0]]
        taken.append((*places[index], radius_m))
    return places


FRICTION = (1.0, 0.005, 0.0005)
CONDIM = {"sphere": 6, "ellipsoid": 6, "cylinder": 6, "mesh": 4, "capsule": 3, "box": 3}
"""`condim`: 3 is sliding friction, 4 adds spinning and 6 rolling friction.

More dimensions cost computing time, so capsules have 3: they are axles, legs and rings, which touch at several points.
"""
BALLAST, BALLAST_AT, BALLAST_RADIUS = 0.01, 0.2, 0.005
"""Mass (of the toy's), distance and radius (in sizes of the toy) of the ballast in a toy with cylinders.

It makes the toy lean by a millionth: occasionally MuJoCo (3.17) finds no contact between a plane and a cylinder that is
upright except for rounding errors, and a bottle that stood still for seconds would suddenly fall.
"""
MAX_NAME_LENGTH = 40  # Maximum number of characters of a toy's name in the names of its elements.
SOLIDS_GROUP = 3  # Geom group that MuJoCo does not render by default.
LOOKS = ObjectGeom(
    name="",
    type="mesh",
    material="",
    contype=UNTOUCHED,
    conaffinity=UNTOUCHED,
    condim=1,
    solmix=DOMINANT_SOLMIX,
    group=1,
)
"""A visual geom, without contacts or mass."""


def make_object(toy: Toy, number: int, place_m: Sequence[float]) -> FreeObject:
    """Return a toy that stands on the floor, at x and y; *number* is its number in the scene, from 1."""
    name = f"toy{number}_{mjcf_name(toy.model.name)}"
    x_m, y_m = map(float, place_m)
    pieces = pieces_of(toy, name, f"toy{number}")
    return FreeObject(
        name=name,
        object=toy.model.name,
        category=toy.model.category,
        source=toy.model.source,
        joint=f"{name}_free",
        pos_m=(x_m, y_m, 0.0),
        quat=quaternion_from_axis((0.0, 0.0, 1.0), toy.yaw_rad),
        size_m=toy.size_m,
        mass_kg=toy.mass_kg,
        density_kg_m3=toy.model.density_kg_m3,
        geoms=tuple(geom for geom, _ in pieces),
        materials=materials_of(toy, name),
        meshes=tuple(mesh for _, mesh in pieces if mesh),
        notes=toy.model.notes,
    )


def materials_of(toy: Toy, name: str) -> tuple[WorldMaterial, ...]:
    """Return the materials of a toy whose elements' names begin with *name*."""
    materials = {part.tint: WorldMaterial(f"{name}_{part.tint}", toy.colours[part.tint]) for part in toy.model.parts}
    return tuple(materials.values())


def pieces_of(toy: Toy, name: str, meshes: str) -> list[tuple[ObjectGeom, MeshFile | None]]:
    """Return the geoms of a toy, whose names begin with *name*, each with its mesh, whose names begin with *meshes*."""
    return [*_looks(toy, name, meshes), *_solids(toy, name, meshes)]


def centre_of_mass(toy: Toy, geoms: Iterable[ObjectGeom]) -> FloatArray:
    """Return the centre of mass of the geoms of a toy, shape (3,), in [m]."""
    meshes = {f"solid{index}": solid.mesh for index, solid in enumerate(toy.model.solids, start=1)}
    masses, places = list[float](), list[FloatArray]()
    for geom in geoms:
        mesh = meshes.get(geom.name.rpartition("_")[2])
        masses.append(geom.mass_kg)
        places.append(np.array(geom.pos_m) + (0.0 if mesh is None else toy.size_m * centre_of(mesh)))
    return np.average(places, axis=0, weights=masses)


def mjcf_name(text: str) -> str:
    """Return a text as a name of ASCII letters, digits and underscores: `Würfel 3` becomes `Wurfel_3`."""
    letters = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    return re.sub("[^A-Za-z0-9]+", "_", letters).strip("_")[:MAX_NAME_LENGTH] or "object"


def _looks(toy: Toy, name: str, meshes: str) -> Iterator[tuple[ObjectGeom, MeshFile]]:
    for part in toy.model.parts:
        mesh = _mesh(f"{meshes}_{part.tint}", part.mesh, toy.size_m, "shell")
        names, material = (("mesh", mesh.name),), f"{name}_{part.tint}"
        yield replace(LOOKS, name=f"{name}_looks_{part.tint}", names=names, material=material), mesh


def _solids(toy: Toy, name: str, meshes: str) -> Iterator[tuple[ObjectGeom, MeshFile | None]]:
    """Yield the collision geoms of a toy, which share its mass in proportion to volume, and their meshes.

    Ballast is an invisible geom without contacts that moves a toy's centre of mass slightly to one side.
    """
    size_m, solids = toy.size_m, toy.model.solids
    hidden = replace(LOOKS, material=f"{name}_{toy.model.parts[0].tint}", group=SOLIDS_GROUP)
    volumes = [solid_volume(solid) for solid in solids]
    ballast_kg = BALLAST * toy.mass_kg if any(solid.type == "cylinder" for solid in solids) else 0.0
    for index, (solid, volume) in enumerate(zip(solids, volumes, strict=True), start=1):
        mesh = _mesh(f"{meshes}_solid{index}", solid.mesh, size_m, "convex") if solid.mesh else None
        x, y, z = (size_m * offset for offset in solid.pos)
        geom = replace(
            hidden,
            name=f"{name}_solid{index}",
            type=solid.type,
            names=(("mesh", mesh.name),) if mesh else (),
            sizes=() if mesh else (("size", tuple(size_m * length for length in solid.size)),),
            pos_m=(x, y, z),
            quat=solid.quat,
            mass_kg=(toy.mass_kg - ballast_kg) * volume / math.fsum(volumes),
            contype=SOLID,
            conaffinity=SOLID,
            condim=CONDIM[solid.type],
        )
        yield geom, mesh
    if ballast_kg:
        pos_m = (BALLAST_AT * size_m, 0.0, solids[0].pos[2] * size_m)
        sizes = (("size", (BALLAST_RADIUS * size_m,)),)
        ballast = replace(hidden, name=f"{name}_ballast", type="sphere", sizes=sizes, pos_m=pos_m, mass_kg=ballast_kg)
        yield ballast, None


def _mesh(name: str, mesh: Mesh, size_m: float, inertia: str) -> MeshFile:
    vertices = "\n".join(map("v {0[0]:.6f} {0[1]:.6f} {0[2]:.6f}".format, (mesh.vertices * size_m).tolist()))
    faces = "\n".join(map("f {0[0]} {0[1]} {0[2]}".format, (mesh.faces + 1).tolist()))
    return MeshFile(name, f"assets/{name}.obj", f"{vertices}\n{faces}\n".encode(), inertia)


def trace_toys(toys: Sequence[FreeObject]) -> dict[str, Entry]:
    """Return entries for the number of toys and for each value of each toy, by key in `provenance.json`."""
    rule = drawn_rule("between the ends of the range", "toys.count")
    count = {"value": len(toys), "rule": rule, "from": [SEED, "spec.scene.toys.count"]}
    return {"toys.count": count, **{key: entry for toy in toys for key, entry in _trace_toy(toy)}}


def mass_entry(thing: FreeObject, sources: list[str]) -> Entry:
    """Return the provenance of an object's mass: its volume and density, and the keys they depend on."""
    volume_cm3 = 1e6 * thing.mass_kg / thing.density_kg_m3
    rule = f"volume of its shape at this size, {volume_cm3:.4g} cm3, x density, {thing.density_kg_m3:g} kg/m3"
    xml = f"scene.xml: body[@name='{thing.name}']/geom/@mass"
    return {"value": thing.mass_kg, "unit": "kg", "rule": rule, "from": sources, "xml": xml}


def _trace_toy(toy: FreeObject) -> Iterator[tuple[str, Entry]]:
    key = f"toy.{toy.name}"
    at = f"scene.xml: body[@name='{toy.name}']"
    rule = drawn_rule(f"from the available toys: {toy.source}", "toys.choice")
    yield f"{key}.object", {"value": toy.object, "rule": rule, "from": [SEED]}
    rule = drawn_rule("as its longest side, between the ends of the range", "toys.size")
    yield f"{key}.size", {"value": toy.size_m, "unit": "m", "rule": rule, "from": [SEED, "spec.scene.toys.size_cm"]}
    yield f"{key}.mass", mass_entry(toy, [f"{key}.size"])
    rule = drawn_rule("around the infant, densest within reach of its hands, without overlaps", "toys.place")
    sources = [SEED, "spec.scene.pose", f"{key}.size"]
    yield f"{key}.pos", {"value": toy.pos_m, "unit": "m", "rule": rule, "from": sources, "xml": f"{at}/@pos"}
    w, _, _, z = toy.quat
    rule = drawn_rule("from all directions", "toys.orientation")
    yield f"{key}.yaw", {"value": 2 * math.atan2(z, w) % math.tau, "unit": "rad", "rule": rule, "from": [SEED]}
    rule = drawn_rule("as red, green, blue and opacity", "toys.colour")
    for material in toy.materials:
        xml = f"scene.xml: material[@name='{material.name}']/@rgba"
        tint = material.name.removeprefix(f"{toy.name}_")
        yield f"{key}.colour_{tint}", {"value": material.rgba, "rule": rule, "from": [SEED], "xml": xml}
