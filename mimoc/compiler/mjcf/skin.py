"""The skin of an infant in MJCF: meshes that several bodies move, seen but not felt."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.meshes import Steps, stepped
from mimoc.base.geometry.rotations import FloatArray, quaternion_from_matrix
from mimoc.base.rounding import rounded_array

LEAST = 1e-9  # Smaller numbers are 0: lengths in m, parts of quaternions, weights and places in a texture.
NAME_BYTES = 40  # For the name of a body in MuJoCo's file.


@dataclass(frozen=True, eq=False)
class SkinLayer:
    """One mesh of a skin, of n vertices, bound to bodies in a pose."""

    name: str  # `body`, `shirt`, `trousers`, `head` or `hair`.
    verts_m: FloatArray  # In the frame of the hip, shape (n, 3).
    faces: npt.NDArray[np.intp]  # Vertices of each triangle, counterclockwise as seen from outside, shape (m, 3).
    texcoords: FloatArray  # Place in the texture of its material, from the lower left, shape (n, 2).
    bones: tuple[str, ...]  # Names of the bodies that move it.
    origins_m: FloatArray  # Of these bodies in the pose, in the frame of the hip, shape (bones, 3).
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
    weights, origins_m, quats = single(layer.weights), single(layer.origins_m), single(layer.quats)
    for index, name in enumerate(layer.bones):
        (moved,) = np.nonzero(layer.weights[:, index])
        parts += [
            name.encode().ljust(NAME_BYTES, b"\0"),
            origins_m[index].tobytes(),
            quats[index].tobytes(),
            np.array(len(moved), "<i4").tobytes(),
            moved.astype("<i4").tobytes(),
            weights[moved, index].tobytes(),
        ]
    return b"".join(parts)


def texture_places(layer: SkinLayer) -> npt.NDArray[np.float32]:
    """Return places in the texture as they are in the file: MuJoCo's begin at the upper left."""
    return single(layer.texcoords * (1, -1) + (0, 1))


def single(values: FloatArray) -> npt.NDArray[np.float32]:
    """Return numbers as they are in the file: what is left of sums that are zero is 0 on every machine."""
    return np.where(np.abs(values) < LEAST, 0.0, rounded_array(values)).astype("<f4")
