"""Simple shapes as objects."""

from mimoc.base.units import cm_to_m
from mimoc.geometry import primitives
from mimoc.geometry.rotations import Vec3
from mimoc.mjcf.furniture import SOLID, WorldMaterial
from mimoc.mjcf.world import ObjectBody, ObjectGeom, ObjectJoint
from mimoc.objects.built_object import BuiltObject, Surroundings
from mimoc.objects.names import object_name
from mimoc.objects.shape.spec import ShapeSpec

DENSITIES_KG_M3 = {"wood": 600.0, "plastic": 400.0, "metal": 2700.0, "cloth": 150.0, "rubber": 1100.0}
"""Mean densities of things: of beech and pine (wood), of hollow parts with walls (plastic), of aluminium (metal), of
stuffed toys (cloth) and of solid rubber; assumptions."""
CONDIM = {"sphere": 6, "ellipsoid": 6, "cylinder": 6, "capsule": 6, "box": 4}
TURNING = 0.005, 0.0005


def build(spec: ShapeSpec, surroundings: Surroundings) -> BuiltObject:
    """Return a simple shape that stands upright."""
    name, size_m = object_name(spec.name), _size_m(spec)
    half_m = _half_m(spec.shape, size_m)
    volume_m3 = primitives.volume(spec.shape, size_m)
    density_kg_m3 = spec.density_kg_m3 or DENSITIES_KG_M3[spec.material]
    mass_kg = spec.mass_g / 1000 if spec.mass_g else volume_m3 * density_kg_m3
    motion = spec.motion or ("free" if spec.above is None else "hanging")
    hangs_m = 2 * half_m[2] + cm_to_m(spec.tether_cm) if motion == "hanging" else half_m[2]
    geom = _geom(name, spec, size_m, half_m[2] - hangs_m, mass_kg)
    swing = ObjectJoint(f"{name}_tether", "ball", damping=1e-5)
    root = ObjectBody(
        name,
        pos_m=(0.0, 0.0, hangs_m),
        free_joints=(f"{name}_free",) if motion == "free" else (),
        joints=(swing,) if motion == "hanging" else (),
        geoms=(geom,),
    )
    return BuiltObject(
        root=root,
        materials=(WorldMaterial(name, (*spec.colour, 1.0)),),
        motion=motion,
        material=spec.material,
        radius_m=max(half_m[0], half_m[1]) if spec.shape != "box" else (half_m[0] ** 2 + half_m[1] ** 2) ** 0.5,
        height_m=2 * half_m[2],
        size_m=2 * max(half_m),
        mass_kg=mass_kg,
        surface_m=half_m[:2] if spec.shape == "box" else None,
    )


def _geom(name: str, spec: ShapeSpec, size_m: tuple[float, ...], z_m: float, mass_kg: float) -> ObjectGeom:
    return ObjectGeom(
        name=name,
        type=spec.shape,
        names=(),
        sizes=(("size", size_m),),
        pos_m=(0.0, 0.0, z_m),
        quat=(1.0, 0.0, 0.0, 0.0),
        mass_kg=mass_kg,
        material=name,
        contype=SOLID,
        conaffinity=SOLID,
        condim=CONDIM[spec.shape],
        friction=(spec.friction, *TURNING),
        solmix=1.0,
        group=0,
    )


def _size_m(spec: ShapeSpec) -> tuple[float, ...]:
    """Return the size of a shape as MuJoCo has it."""
    if spec.sides_cm is not None:
        return tuple(cm_to_m(side) / 2 for side in spec.sides_cm)
    radius_m, length_m = cm_to_m(spec.radius_cm or 0.0), cm_to_m(spec.length_cm or 0.0)
    sizes = {"sphere": (radius_m,), "cylinder": (radius_m, length_m / 2)}
    return sizes.get(spec.shape, (radius_m, length_m / 2 - radius_m))


def _half_m(shape: str, size_m: tuple[float, ...]) -> Vec3:
    """Return half the lengths of the box around a shape."""
    if len(size_m) == 3:
        return size_m
    radius_m, along_m = size_m[0], size_m[-1] + (size_m[0] if shape == "capsule" else 0.0)
    return radius_m, radius_m, along_m
