"""A mobile above an infant that lies on its back."""

import math

from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.elements import WorldMaterial
from mimoc.compiler.mjcf.world import FreeObject, ObjectGeom
from mimoc.compiler.task_setup import TaskSetup, require
from mimoc_nursery.kick.spec import KickEntry, KickSpec

STEPS = 3000
"""Control steps of an episode: 30 s."""
HEIGHT_M = 0.4
"""Of the mobile above the floor: out of reach of hands and feet."""
RADIUS_M = 0.03
MASS_KG = 0.05
YELLOW = WorldMaterial("mobile", (0.95, 0.75, 0.1, 1.0), specular=0.3, shininess=0.5)


def build(spec: KickSpec, body: BodyTree) -> TaskSetup:
    """Return the mobile and what ties it to the foot.

    Raises:
        UnsupportedTaskError: If the infant lacks that foot.
    """
    foot = f"{spec.foot}_foot"
    require(body, "kick", foot)
    return TaskSetup(KickEntry(steps=spec.steps or STEPS, foot=foot, mobile="mobile"), objects=(_mobile(),))


def _mobile() -> FreeObject:
    """Return a ball that touches nothing; it hangs where it starts."""
    geom = ObjectGeom(
        name="mobile",
        type="sphere",
        names=(),
        sizes=(("size", (RADIUS_M,)),),
        pos_m=(0.0, 0.0, 0.0),
        quat=(1.0, 0.0, 0.0, 0.0),
        mass_kg=MASS_KG,
        material=YELLOW.name,
        contype=0,
        conaffinity=0,
        condim=3,
        friction=(1.0, 0.005, 0.0005),
        solmix=1.0,
        group=0,
    )
    return FreeObject(
        name="mobile",
        object="mobile",
        category="mobile",
        source="mimoc-nursery",
        joint="mobile_joint",
        pos_m=(0.0, 0.0, HEIGHT_M),
        quat=(1.0, 0.0, 0.0, 0.0),
        size_m=2 * RADIUS_M,
        mass_kg=MASS_KG,
        density_kg_m3=MASS_KG / (4 / 3 * math.pi * RADIUS_M**3),
        geoms=(geom,),
        materials=(YELLOW,),
        meshes=(),
    )
