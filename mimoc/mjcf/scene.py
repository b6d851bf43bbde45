"""A scene as the templates print it: SI units, angles in radians, every value decided."""

from dataclasses import dataclass, replace

from mimoc.mjcf.infant import Actuator, Node, PrintedTendon, Sensor
from mimoc.mjcf.materials import Appearance, Material
from mimoc.mjcf.skin import Skin
from mimoc.mjcf.world import World
from mimoc.mujoco_layout import BODY_GROUP, SOLIDS_GROUP


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


@dataclass(frozen=True, slots=True)
class Keyframe:
    """A complete state to start from."""

    name: str
    qpos: tuple[float, ...]
    settings: tuple[tuple[str, tuple[float, ...]], ...] = ()
    """Its other attributes."""


@dataclass(frozen=True, slots=True)
class SceneTree:
    """An infant in its world, ready to print."""

    name: str
    solver: Solver
    roots: tuple[Node, ...]
    """The infant's root body with all its descendants."""
    appearance: Appearance
    tendons: tuple[PrintedTendon, ...]
    excluded: tuple[tuple[str, str], ...]
    actuator_defaults: tuple[tuple[str, str], ...]
    """Attributes that all actuators have in common."""
    actuators: tuple[Actuator, ...]
    sensors: tuple[Sensor, ...]
    world: World
    keyframes: tuple[Keyframe, ...]
    skin: Skin | None = None
    """Its skin, which is different at each age, as numbers are; None for its bare solids."""

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
    """Return a body and its descendants with no solid in the group that is not drawn."""
    geoms = (replace(geom, group=BODY_GROUP) if geom.group == SOLIDS_GROUP else geom for geom in node.geoms)
    return replace(node, geoms=tuple(geoms), children=tuple(map(_with_solids_shown, node.children)))
