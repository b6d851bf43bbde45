"""The ball of a task."""

import math

from mimoc.geometry.rotations import Vec3
from mimoc.mjcf.furniture import SOLID, WorldMaterial
from mimoc.mjcf.world import FreeObject, ObjectGeom
from mimoc.tasks.base import BallEntry

NAME = "ball"
BALL = BallEntry(body="target", joint="target_joint", geom=NAME)
"""Names of its body and joint: MIMo's."""
RADIUS_M = 0.025
"""Radius of the ball in MIMo's reaching task."""
DENSITY_KG_M3 = 1000.0
RED = WorldMaterial(NAME, (0.85, 0.16, 0.12, 1.0), specular=0.4, shininess=0.5)


def ball(pos_m: Vec3, radius_m: float = RADIUS_M) -> FreeObject:
    """Return a red ball with the density of water."""
    mass_kg = DENSITY_KG_M3 * 4 / 3 * math.pi * radius_m**3
    geom = ObjectGeom(
        name=BALL.geom,
        type="sphere",
        names=(),
        sizes=(("size", (radius_m,)),),
        pos_m=(0.0, 0.0, 0.0),
        quat=(1.0, 0.0, 0.0, 0.0),
        mass_kg=mass_kg,
        material=RED.name,
        contype=SOLID,
        conaffinity=SOLID,
        condim=6,
        friction=(1.0, 0.005, 0.0005),
        solmix=1.0,
        group=0,
    )
    return FreeObject(
        name=BALL.body,
        object=NAME,
        category=NAME,
        source="mimoc",
        joint=BALL.joint,
        pos_m=pos_m,
        quat=(1.0, 0.0, 0.0, 0.0),
        size_m=2 * radius_m,
        mass_kg=mass_kg,
        density_kg_m3=DENSITY_KG_M3,
        geoms=(geom,),
        materials=(RED,),
        meshes=(),
    )
