"""Simple shapes, toys and meshes as objects that are fixed, free, hang or slide."""

from mimoc.base.errors import ObjectError, ToyError
from mimoc.base.units import GRAVITY_M_S2, cm_to_m
from mimoc.compiler.mjcf.furniture import WorldMaterial
from mimoc.compiler.mjcf.world import ObjectBody, ObjectJoint
from mimoc.compiler.objects.built_object import BuiltObject, Surroundings
from mimoc.compiler.objects.names import object_name
from mimoc.compiler.objects.pieces import moved, pendulum_damping, string
from mimoc.components.objects.shape.build_solid import Solid, solid_of
from mimoc.components.objects.shape.spec import ShapeSpec

RAIL_M = 0.001
"""How far a sliding object is above what is below it, so that nothing but its own friction stops it."""
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
        notes=solid.notes,
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
        pos_m=(0.0, 0.0, middle_m + (RAIL_M if spec.moves == "sliding" else 0.0)),
        free_joints=(f"{name}_free",) if spec.moves == "free" else (),
        joints=(slide,) if spec.moves == "sliding" else (),
        geoms=tuple(moved(geom, (0.0, 0.0, -middle_m)) for geom in solid.geoms),
    )


def _hung(name: str, solid: Solid, tether_m: float) -> ObjectBody:
    """Return an object that swings about the upper end of its tether."""
    top_m = 2 * solid.half_m[2] + tether_m
    damping = pendulum_damping((solid.mass_kg, top_m - solid.half_m[2], max(solid.half_m)))
    return ObjectBody(
        name,
        pos_m=(0.0, 0.0, top_m),
        joints=(ObjectJoint(f"{name}_tether", "ball", damping),),
        geoms=(
            *(moved(geom, (0.0, 0.0, -top_m)) for geom in solid.geoms),
            string(f"{name}_tether", f"{name}_tether", tether_m),
        ),
    )
