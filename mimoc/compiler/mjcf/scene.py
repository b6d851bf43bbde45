"""A scene as the templates print it, and what a sense adds to it: SI units, angles in radians, every value decided."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy.typing as npt

from mimoc.base.mujoco_layout import BODY_GROUP, SOLIDS_GROUP
from mimoc.body.tree import Tendon
from mimoc.compiler.mjcf.elements import Actuator, Camera, Node, PassiveActuator, Sensor, Site
from mimoc.compiler.mjcf.furniture import Appearance, Material
from mimoc.compiler.mjcf.skin import Skin
from mimoc.compiler.mjcf.world import World
from mimoc.schema.base import Model


@dataclass(frozen=True, slots=True)
class Solver:
    """MuJoCo's options for the physics; `benchmarks/solver.py` shows why these."""

    timestep_s: float
    integrator: str
    cone: str = "elliptic"
    jacobian: str = "sparse"
    solver: str = "Newton"
    iterations: int = 100
    ls_iterations: int = 50
    tolerance: float = 1e-13
    multiccd: str = "disable"
    """`enable` where things stand on others: else a cylinder on a box has one contact at a time, and trembles."""


@dataclass(frozen=True, slots=True)
class Keyframe:
    """A complete state to start from."""

    name: str
    qpos: tuple[float, ...]
    settings: tuple[tuple[str, tuple[float, ...]], ...] = ()


@dataclass(frozen=True, slots=True)
class SceneTree:
    """An infant in its world, ready to print."""

    name: str
    solver: Solver
    roots: tuple[Node, ...]  # The infant's root body with all its descendants.
    appearance: Appearance
    tendons: tuple[Tendon, ...]
    excluded: tuple[tuple[str, str], ...]
    frictionless: tuple[tuple[str, str], ...]  # Pairs of geoms that slide on each other.
    joint_defaults: tuple[tuple[str, tuple[float, ...]], ...]  # Attributes that all hinges have in common.
    actuator_defaults: tuple[tuple[str, str], ...]  # Attributes that all actuators have in common.
    actuators: tuple[Actuator, ...]
    reflexes: tuple[PassiveActuator, ...]  # Actuators that take no commands.
    sensors: tuple[Sensor, ...]
    world: World
    keyframes: tuple[Keyframe, ...]
    skin: Skin | None = None  # Its skin, which is different at each age, as numbers are; None for its bare solids.
    prefix: str = ""  # What all names of the infant begin with, if it is not alone in its world.

    @property
    def infant_class(self) -> str:
        """Name of the class of its defaults."""
        return f"{self.prefix}infant"

    @property
    def without_skin(self) -> "SceneTree":
        """The same with the infant's solids shown instead of its skin."""
        appearance = replace(self.appearance, skins=())
        return replace(self, roots=tuple(map(_with_solids_shown, self.roots)), appearance=appearance, skin=None)

    @property
    def textured_materials(self) -> tuple[Material, ...]:
        """Materials with a texture."""
        return tuple(material for material in self.appearance.materials if material.texture)

    @property
    def plain_materials(self) -> tuple[Material, ...]:
        """Materials of one colour."""
        return tuple(material for material in self.appearance.materials if not material.texture)


def _with_solids_shown(node: Node) -> Node:
    geoms = (replace(geom, group=BODY_GROUP) if geom.group == SOLIDS_GROUP else geom for geom in node.geoms)
    return replace(node, geoms=tuple(geoms), children=tuple(map(_with_solids_shown, node.children)))


@dataclass(frozen=True, slots=True)
class Placed:
    """A sense on a body: its entry in the manifest, and what stands for it in the MJCF."""

    entry: Model
    """What the runtime must know of it."""
    sites: Mapping[str, tuple[Site, ...]] = field(default_factory=dict)
    """Sites to add, by body."""
    cameras: Mapping[str, tuple[Camera, ...]] = field(default_factory=dict)
    """Cameras by body, in place of those that the body has without the sense."""
    sensors: tuple[Sensor, ...] = ()
    arrays: Mapping[str, npt.NDArray[Any]] = field(default_factory=dict)
    """Large arrays that the runtime must know; the bundle has `points_m` of touch as `touch/points_m`."""
    origins: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    """Where its numbers come from, by key in `provenance.json`."""
