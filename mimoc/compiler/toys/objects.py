"""Conversion of toys to MJCF objects with size, colour, mass and position, and the provenance of these."""

import math
import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from mimoc.base.geometry.rotations import FloatArray, quaternion_from_axis
from mimoc.base.random_streams import SEED, drawn_rule
from mimoc.body.origins import Entry
from mimoc.compiler.mjcf.furniture import DOMINANT_SOLMIX, SOLID, UNTOUCHED, WorldMaterial
from mimoc.compiler.mjcf.world import FreeObject, MeshFile, ObjectGeom
from mimoc.compiler.toys.placing import Toy
from mimoc.compiler.toys.shape import Mesh, centre_of, solid_volume

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
LONGEST_NAME = 40  # Maximum number of characters of a toy's name in the names of its elements.
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
    return re.sub("[^A-Za-z0-9]+", "_", letters).strip("_")[:LONGEST_NAME] or "object"


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
        pos_m, sizes = (BALLAST_AT * size_m, 0.0, solids[0].pos[2] * size_m), (("size", (BALLAST_RADIUS * size_m,)),)
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
    key, at = f"toy.{toy.name}", f"scene.xml: body[@name='{toy.name}']"
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
