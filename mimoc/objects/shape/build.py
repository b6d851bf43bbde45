"""Simple shapes, toys and meshes as objects that are fixed, free, hang or slide."""

import math
from dataclasses import replace

from mimoc.base.errors import ObjectError, ToyError
from mimoc.base.units import cm_to_m
from mimoc.mjcf.furniture import UNTOUCHED, WorldMaterial
from mimoc.mjcf.world import ObjectBody, ObjectGeom, ObjectJoint
from mimoc.objects.built_object import BuiltObject, Surroundings
from mimoc.objects.names import object_name
from mimoc.objects.shape.build_solid import Solid, solid_of
from mimoc.objects.shape.spec import ShapeSpec
from mimoc.toys.shape import UPRIGHT

GRAVITY_M_S2 = 9.81
DAMPING_RATIO = 0.05
"""Of an object that hangs: its swing falls to a third in about three periods; an assumption."""
TETHER_RADIUS_M = 0.001
STRING = (0.88, 0.86, 0.8, 1.0)


def build(spec: ShapeSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a simple shape, a toy or a mesh.

    Raises:
        ObjectError: If there is no such toy or mesh, or it cannot be used.
    """
    name = object_name(spec.name)
    try:
        solid = solid_of(spec, name, surroundings.folder)
    except ToyError as error:
        key = "mesh" if spec.mesh else "root" if spec.root and error.name is None else "toy"
        raise ObjectError(key, str(error)) from None
    hangs, materials = spec.moves == "hanging", solid.materials
    if hangs:
        materials = (*materials, WorldMaterial(f"{name}_tether", STRING))
    return BuiltObject(
        root=_hung(name, solid, cm_to_m(spec.tether_cm)) if hangs else _standing(name, spec, solid),
        materials=materials,
        motion=spec.moves,
        material=solid.material,
        radius_m=solid.radius_m,
        height_m=2 * solid.half_m[2],
        size_m=2 * max(solid.half_m),
        mass_kg=solid.mass_kg,
        surface_m=None if hangs else solid.surface_m,
        meshes=solid.meshes,
        origins={"mass": {"value": solid.mass_kg, "unit": "kg", **solid.mass_origin}},
    )


def _standing(name: str, spec: ShapeSpec, solid: Solid) -> ObjectBody:
    """Return an object that is fixed, free or slides."""
    axis = (1.0, 0.0, 0.0) if spec.along == "x" else (0.0, 1.0, 0.0)
    low_cm, high_cm = spec.slide_cm
    slide = ObjectJoint(
        f"{name}_slide",
        "slide",
        damping=0.0,
        axis=axis,
        limited=True,
        range=(cm_to_m(low_cm), cm_to_m(high_cm)),
        frictionloss=spec.friction * solid.mass_kg * GRAVITY_M_S2,
    )
    middle_m = solid.half_m[2]
    return ObjectBody(
        name,
        pos_m=(0.0, 0.0, middle_m),
        free_joints=(f"{name}_free",) if spec.moves == "free" else (),
        joints=(slide,) if spec.moves == "sliding" else (),
        geoms=tuple(_lowered(geom, middle_m) for geom in solid.geoms),
    )


def _hung(name: str, solid: Solid, tether_m: float) -> ObjectBody:
    """Return an object that swings about the upper end of its tether.

    Its damping is 2 z sqrt(m g l (I + m l²)): of a pendulum of mass m whose centre is l below where it is tied, with
    damping ratio z; I is that of a ball of its size.
    """
    top_m = 2 * solid.half_m[2] + tether_m
    arm_m = top_m - solid.half_m[2]
    inertia_kgm2 = solid.mass_kg * (0.4 * max(solid.half_m) ** 2 + arm_m**2)
    damping = 2 * DAMPING_RATIO * math.sqrt(solid.mass_kg * GRAVITY_M_S2 * arm_m * inertia_kgm2)
    return ObjectBody(
        name,
        pos_m=(0.0, 0.0, top_m),
        joints=(ObjectJoint(f"{name}_tether", "ball", damping),),
        geoms=(*(_lowered(geom, top_m) for geom in solid.geoms), tether(f"{name}_tether", tether_m)),
    )


def tether(name: str, length_m: float) -> ObjectGeom:
    """Return a string down from where it is tied, which is only seen; its material has its name."""
    half_m = max(length_m / 2 - TETHER_RADIUS_M, TETHER_RADIUS_M)
    return ObjectGeom(
        name=name,
        type="capsule",
        names=(),
        sizes=(("size", (TETHER_RADIUS_M, half_m)),),
        pos_m=(0.0, 0.0, -length_m / 2),
        quat=UPRIGHT,
        mass_kg=0.0,
        material=name,
        contype=UNTOUCHED,
        conaffinity=UNTOUCHED,
        condim=1,
        friction=(1.0, 0.005, 0.0005),
        solmix=1.0,
        group=1,
    )


def _lowered(geom: ObjectGeom, by_m: float) -> ObjectGeom:
    x_m, y_m, z_m = geom.pos_m
    return replace(geom, pos_m=(x_m, y_m, z_m - by_m))
