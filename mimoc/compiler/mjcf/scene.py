"""A scene as the templates print it, an infant's skin in it, and what a sense adds to it; every value is decided."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.arrays import rounded_array
from mimoc.base.geometry.meshes import Steps, stepped
from mimoc.base.geometry.rotations import FloatArray, quaternion_from_matrix
from mimoc.base.mujoco_layout import BODY_GROUP, SOLIDS_GROUP
from mimoc.body.tree import Tendon
from mimoc.compiler.mjcf.elements import Actuator, Appearance, Camera, Node, PassiveActuator, Sensor, Site
from mimoc.compiler.mjcf.world import World
from mimoc.schema.base import Model

NEGLIGIBLE = 1e-9  # Smaller numbers are 0: lengths in m, parts of quaternions, weights and places in a texture.
NAME_BYTES = 40  # For the name of a body in MuJoCo's file.


@dataclass(frozen=True, eq=False)
class SkinLayer:
    """One mesh of a skin, of n vertices, bound to bodies in a pose."""

    name: str  # `body`, `shirt`, `trousers`, `head` or `hair`.
    verts_m: FloatArray  # Vertices in the frame of the hip, shape (n, 3).
    faces: npt.NDArray[np.intp]  # Vertices of each triangle, counterclockwise as seen from outside, shape (m, 3).
    texcoords: FloatArray  # Place in the texture of its material, from the lower left, shape (n, 2).
    bones: tuple[str, ...]  # Names of the bodies that move it.
    origins_m: FloatArray  # Origins of these bodies in the pose, in the frame of the hip, shape (bones, 3).
    turns: FloatArray  # Hip from body in the pose, shape (bones, 3, 3).
    weights: FloatArray
    """How much each body moves each vertex, shape (n, bones); each row sums to 1 and has at most four above 0."""

    @property
    def quats(self) -> FloatArray:
        """Quaternions of these bodies in the pose, shape (bones, 4)."""
        return np.array([quaternion_from_matrix(turn) for turn in self.turns])

    @property
    def file(self) -> str:
        """Path of its file inside a bundle."""
        return f"assets/{self.name}.skn"


class Skin:
    """The layers of a skin, made when they are first asked for: not everyone who builds an infant looks at it."""

    def __init__(
        self,
        names: tuple[str, ...],
        make: Callable[[], tuple[SkinLayer, ...]],
        move: Callable[[], Mapping[str, Steps]] = dict,
    ):
        """Promise layers of these names, in the order that they are drawn in, and how expressions move the head's."""
        self.names, self._make, self._move = names, make, move

    @cached_property
    def layers(self) -> tuple[SkinLayer, ...]:
        """All layers."""
        return self._make()

    @cached_property
    def moves(self) -> Mapping[str, Steps]:
        """How far each expression moves the vertices of the head's layer from the neutral face, shape (n, 3)."""
        return self._move()

    def showing(self, expression: str, head: str) -> "Skin":
        """Return the same with another expression; *head* is the name of the layer that it moves."""

        def layers() -> tuple[SkinLayer, ...]:
            steps = self.moves.get(expression)
            return tuple(
                replace(layer, verts_m=stepped(layer.verts_m, None, steps)) if layer.name == head else layer
                for layer in self.layers
            )

        return Skin(self.names, layers, lambda: self.moves)

    @cached_property
    def files(self) -> Mapping[str, bytes]:
        """MuJoCo's files, by path inside a bundle."""
        return {layer.file: encode_skn(layer) for layer in self.layers}


def encode_skn(layer: SkinLayer) -> bytes:
    """Return MuJoCo's file of a layer: little-endian, single precision (XML reference, `deformable/skin/file`)."""
    counts = len(layer.verts_m), len(layer.texcoords), len(layer.faces), len(layer.bones)
    parts = [
        np.array(counts, "<i4").tobytes(),
        single(layer.verts_m).tobytes(),
        texture_places(layer).tobytes(),
        layer.faces.astype("<i4").tobytes(),
    ]
    origins_m, quats = single(layer.origins_m), single(layer.quats)
    for index, name in enumerate(layer.bones):
        (moved,) = np.nonzero(layer.weights[:, index])
        parts += [
            name.encode().ljust(NAME_BYTES, b"\0"),
            origins_m[index].tobytes(),
            quats[index].tobytes(),
            np.array(len(moved), "<i4").tobytes(),
            moved.astype("<i4").tobytes(),
            single(layer.weights[moved, index]).tobytes(),  # Zeros, which most are, take long to round.
        ]
    return b"".join(parts)


def texture_places(layer: SkinLayer) -> npt.NDArray[np.float32]:
    """Return places in the texture as they are in the file: MuJoCo's begin at the upper left."""
    return single(layer.texcoords * (1, -1) + (0, 1))


def single(values: FloatArray) -> npt.NDArray[np.float32]:
    """Return numbers as they are in the file: what is left of sums that are zero is 0 on every machine."""
    return np.where(np.abs(values) < NEGLIGIBLE, 0.0, rounded_array(values)).astype("<f4")


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


def _with_solids_shown(node: Node) -> Node:
    geoms = (replace(geom, group=BODY_GROUP) if geom.group == SOLIDS_GROUP else geom for geom in node.geoms)
    return replace(node, geoms=tuple(geoms), children=tuple(map(_with_solids_shown, node.children)))


@dataclass(frozen=True, slots=True)
class Placed:
    """A sense on a body: its entry in the manifest, and what stands for it in the MJCF."""

    entry: Model  # What the runtime must know of it.
    sites: Mapping[str, tuple[Site, ...]] = field(default_factory=dict)  # Sites to add, by body.
    cameras: Mapping[str, tuple[Camera, ...]] = field(default_factory=dict)
    """Cameras by body, in place of those that the body has without the sense."""
    sensors: tuple[Sensor, ...] = ()
    arrays: Mapping[str, npt.NDArray[Any]] = field(default_factory=dict)
    """Large arrays that the runtime must know; the bundle has `points_m` of touch as `touch/points_m`."""
    origins: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    """Where its numbers come from, by key in `provenance.json`."""
