"""Simple shapes, toys and meshes as objects that are fixed, free, hang or slide."""

import colorsys
import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mimoc.base.errors import ObjectError, ToyError, suggestion
from mimoc.base.geometry import primitives
from mimoc.base.geometry.rotations import Quaternion, Vec3, quaternion_from_axis
from mimoc.base.units import GRAVITY_M_S2, cm_to_m
from mimoc.body.origins import Entry
from mimoc.compiler.mjcf.elements import Rgba, WorldMaterial
from mimoc.compiler.mjcf.world import MeshFile, ObjectBody, ObjectGeom, ObjectJoint
from mimoc.compiler.objects.built_object import (
    BuiltObject,
    Surroundings,
    moved,
    object_name,
    pendulum_damping,
    solid,
    string,
)
from mimoc.compiler.toys import DARK, LIGHT, UPRIGHT, Tint, Toy, ToyModel, centre_of_mass, materials_of, pieces_of
from mimoc.components.objects import ShapeSpec
from mimoc.components.toys import builtin
from mimoc.components.toys.toys4k import build as toys4k, dataset
from mimoc.components.toys.toys4k.build import MeshCache
from mimoc.schema.objects import Material

DENSITIES_KG_M3: dict[Material, float] = {
    "wood": 600.0,
    "plastic": 400.0,
    "metal": 2700.0,
    "cloth": 150.0,
    "rubber": 1100.0,
}
"""Mean densities: of wood between spruce and beech, of plastic things that are hollow, of aluminium, of stuffed cloth
and of solid rubber. Assumptions, rounded from what toys weigh."""
COLOURS: dict[Material, Vec3] = {
    "wood": (0.82, 0.66, 0.46),
    "plastic": (0.85, 0.16, 0.12),
    "metal": (0.62, 0.64, 0.68),
    "cloth": (0.55, 0.62, 0.82),
    "rubber": (0.2, 0.55, 0.35),
}
TURNING = (0.005, 0.0005)  # Spinning and rolling friction, the same as of toys.
WOODEN, STUFFED = 620.0, 150.0
"""Density of mimoc's toys of wood, and the largest of those of cloth, in [kg/m³]; see `sculpt/toys/`."""
ALONG_X: Quaternion = quaternion_from_axis((0.0, 1.0, 0.0), math.pi / 2)
RAIL_M = 0.001  # How far a sliding object is above what is below it, so that nothing but its own friction stops it.
STRING = (0.88, 0.86, 0.8, 1.0)


@dataclass(frozen=True, slots=True)
class Solid:
    """What an object is made of."""

    geoms: tuple[ObjectGeom, ...]
    materials: tuple[WorldMaterial, ...]
    meshes: tuple[MeshFile, ...]
    half_m: Vec3  # Half lengths of the box around it, which stands on z = 0.
    radius_m: float  # Radius of the vertical cylinder around it.
    mass_kg: float
    material: Material
    mass_origin: Entry
    surface_m: tuple[float, float] | None = None  # Half lengths of the level surface on top of it.
    notes: tuple[str, ...] = ()  # What is to be known of its shape.

    @property
    def half_height_m(self) -> float:
        """Half the height of the box around it."""
        return self.half_m[2]


def build(spec: ShapeSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a simple shape, a toy or a mesh.

    Raises:
        ObjectError: If there is no such toy or mesh, or it cannot be used.
    """
    name = object_name(spec.name)
    try:
        made = _of_toy(spec, name, surroundings.folder) if spec.toy or spec.mesh else _of_shape(spec, name)
    except ToyError as error:
        if spec.mesh:
            key = "mesh"
        elif spec.root and error.name is None:
            key = "root"
        else:
            key = "toy"
        raise ObjectError(key, str(error)) from None
    if spec.moves == "hanging":
        root = _hung(name, made, cm_to_m(spec.tether_cm))
        materials = (*made.materials, WorldMaterial(f"{name}_tether", STRING))
        surface_m = None
    else:
        root = _standing(name, spec, made)
        materials = made.materials
        surface_m = made.surface_m
    return BuiltObject(
        root=root,
        materials=materials,
        motion=spec.moves,
        material=made.material,
        radius_m=made.radius_m,
        height_m=2 * made.half_height_m,
        size_m=2 * max(made.half_m),
        mass_kg=made.mass_kg,
        surface_m=surface_m,
        meshes=made.meshes,
        notes=made.notes,
        origins={"mass": {"value": made.mass_kg, "unit": "kg", **made.mass_origin}},
    )


def _of_shape(spec: ShapeSpec, name: str) -> Solid:
    shape = spec.shape or "sphere"
    size_m = _size_m(spec)
    half_m = _half_m(shape, size_m)
    half_m = (half_m[2], half_m[1], half_m[0]) if spec.lies else half_m
    material = spec.material or "plastic"
    volume_m3 = primitives.volume(shape, size_m)
    mass_kg, origin = _mass(spec, volume_m3, DENSITIES_KG_M3[material], f"of {material}")
    quat = ALONG_X if spec.lies else UPRIGHT
    geom = solid(name, name, shape, size_m, (0.0, 0.0, half_m[2]), mass_kg, quat)
    geom = replace(geom, friction=(spec.friction, *TURNING))
    return Solid(
        geoms=(geom,),
        materials=(WorldMaterial(name, (*(spec.colour or COLOURS[material]), 1.0)),),
        meshes=(),
        half_m=half_m,
        radius_m=math.hypot(*half_m[:2]) if shape == "box" or spec.lies else max(half_m[:2]),
        mass_kg=mass_kg,
        material=material,
        mass_origin=origin,
        surface_m=_surface_m(shape, half_m) if not spec.lies else None,
    )


def _mass(spec: ShapeSpec, volume_m3: float, usual_kg_m3: float, whose: str) -> tuple[float, Entry]:
    source: list[str] = ["spec.scene.objects"]
    if spec.mass_g is not None:
        return spec.mass_g / 1000, {"rule": "as the spec gives it", "from": source}
    density = usual_kg_m3 if spec.density_kg_m3 is None else spec.density_kg_m3
    density_origin = whose if spec.density_kg_m3 is None else "as the spec gives it"
    rule = f"its volume, {1e6 * volume_m3:.4g} cm3, x density, {density:g} kg/m3 {density_origin}"
    return volume_m3 * density, {"rule": rule, "from": source}


def _size_m(spec: ShapeSpec) -> tuple[float, ...]:
    """Return the size of a shape as MuJoCo has it; a capsule is no shorter than a sphere."""
    if spec.source in ("box", "ellipsoid"):
        return tuple(cm_to_m(side) / 2 for side in spec.sides_cm)
    radius_m = cm_to_m(spec.radius_cm)
    half_length_m = cm_to_m(spec.length_cm) / 2
    if spec.source == "sphere":
        return (radius_m,)
    return radius_m, half_length_m if spec.source == "cylinder" else max(half_length_m - radius_m, 0.001)


def _half_m(shape: str, size_m: tuple[float, ...]) -> Vec3:
    if shape in ("box", "ellipsoid"):
        x_m, y_m, z_m = size_m
        return x_m, y_m, z_m
    radius_m = size_m[0]
    if shape == "sphere":
        return radius_m, radius_m, radius_m
    half_length_m = size_m[-1]
    return radius_m, radius_m, half_length_m + radius_m if shape == "capsule" else half_length_m


def _surface_m(shape: str, half_m: Vec3) -> tuple[float, float] | None:
    """Return the half lengths of the level surface on top of a shape: of a cylinder, the square in its disc."""
    share = {"box": 1.0, "cylinder": math.sqrt(0.5)}.get(shape)
    return None if share is None else (share * half_m[0], share * half_m[1])


def _of_toy(spec: ShapeSpec, name: str, folder: Path) -> Solid:
    model = _model(spec, folder)
    size_m = cm_to_m(spec.size_cm)
    material = spec.material or _usual_material(model)
    usual_kg_m3 = DENSITIES_KG_M3[material] if spec.material else model.density_kg_m3
    volume_m3 = model.volume * size_m**3
    mass_kg, origin = _mass(spec, volume_m3, usual_kg_m3, f"of {material}" if spec.material else "of this toy")
    colours = _colours(spec.colour or COLOURS[material])
    toy = Toy(replace(model, density_kg_m3=mass_kg / volume_m3), size_m, 0.0, colours)
    pieces = pieces_of(toy, name, name)
    geoms = [replace(geom, friction=(spec.friction, *TURNING)) if geom.contype else geom for geom, _ in pieces]
    if spec.moves == "hanging":  # It hangs from above its centre of mass, so that it hangs straight.
        centre_x_m, centre_y_m, _ = centre_of_mass(toy, geoms).tolist()
        geoms = [moved(geom, (-centre_x_m, -centre_y_m, 0.0)) for geom in geoms]
    vertices = np.concatenate([part.mesh.vertices for part in model.parts])
    half_x_m, half_y_m, height_m = (np.abs(vertices).max(axis=0) * size_m).tolist()
    return Solid(
        geoms=tuple(geoms),
        materials=materials_of(toy, name),
        meshes=tuple(mesh for _, mesh in pieces if mesh),
        half_m=(half_x_m, half_y_m, height_m / 2),
        radius_m=toy.radius_m,
        mass_kg=mass_kg,
        material=material,
        mass_origin=origin,
        notes=model.notes,
    )


def _model(spec: ShapeSpec, folder: Path) -> ToyModel:
    if spec.mesh:
        return toys4k.load_mesh(dataset.expand_root(spec.mesh, folder), MeshCache())
    name = spec.toy or ""
    if spec.root:
        return toys4k.load_toy(dataset.find_toys(dataset.expand_root(spec.root, folder)), name, MeshCache())
    if name not in builtin.NAMES:
        raise ToyError(f"'{name}' is not one of mimoc's toys; {suggestion(name, builtin.NAMES)}", name)
    return builtin.load_toy(name)


def _usual_material(model: ToyModel) -> Material:
    if model.density_kg_m3 <= STUFFED:
        return "cloth"
    return "wood" if model.density_kg_m3 == WOODEN else "plastic"


def _colours(colour: Vec3) -> dict[Tint, Rgba]:
    """Return the colours of a toy: the main one, the opposite hue for what contrasts, near-black and near-white."""
    hue, saturation, brightness = colorsys.rgb_to_hsv(*colour)
    accent = colorsys.hsv_to_rgb((hue + 0.5) % 1.0, saturation, brightness)
    red, green, blue = (round(channel, 4) for channel in accent)
    return {"main": (*colour, 1.0), "accent": (red, green, blue, 1.0), "dark": DARK, "light": LIGHT}


def _standing(name: str, spec: ShapeSpec, made: Solid) -> ObjectBody:
    axis = (1.0, 0.0, 0.0) if spec.along == "x" else (0.0, 1.0, 0.0)
    low_cm, high_cm = spec.slide_cm
    slide = ObjectJoint(
        f"{name}_slide",
        "slide",
        damping=0.0,
        axis=axis,
        limited=True,
        range=(cm_to_m(low_cm), cm_to_m(high_cm)),
        frictionloss=spec.friction * made.mass_kg * GRAVITY_M_S2,
    )
    return ObjectBody(
        name,
        pos_m=(0.0, 0.0, made.half_height_m + (RAIL_M if spec.moves == "sliding" else 0.0)),
        free_joints=(f"{name}_free",) if spec.moves == "free" else (),
        joints=(slide,) if spec.moves == "sliding" else (),
        geoms=tuple(moved(geom, (0.0, 0.0, -made.half_height_m)) for geom in made.geoms),
    )


def _hung(name: str, made: Solid, tether_m: float) -> ObjectBody:
    top_m = 2 * made.half_height_m + tether_m
    damping = pendulum_damping((made.mass_kg, top_m - made.half_height_m, max(made.half_m)))
    return ObjectBody(
        name,
        pos_m=(0.0, 0.0, top_m),
        joints=(ObjectJoint(f"{name}_tether", "ball", damping),),
        geoms=(
            *(moved(geom, (0.0, 0.0, -top_m)) for geom in made.geoms),
            string(f"{name}_tether", f"{name}_tether", tether_m),
        ),
    )
