"""How the skin of a face moves from its neutral expression to another. Lengths are mm, in the frame of `head.Head`."""

from dataclasses import dataclass

import head as heads
import numpy as np
from faces import MESHED, SHAPES
from fields import Array

from mimoc.base.geometry.solvers import smoothstep


@dataclass(frozen=True, slots=True)
class Moved:
    """One expression. All figures are by eye (D), after what muscles do in it (Oster, Baby FACS)."""

    corner: tuple[float, float, float] = (0.0, 0.0, 0.0)  # How far the corners of the mouth go: forward, outward, up.
    upper: float = 0.0  # How far the middle of the upper lip goes up.
    lower: float = 0.0  # How far that of the lower lip goes down, and with it the jaw.
    square: float = 2.0  # The outline of the open mouth: 2 is round, more is more like a square.
    pout: float = 0.0  # How far the lips go forward.
    cheek: float = 0.0  # How far the cheeks go up and out.
    brow: tuple[float, float] = (0.0, 0.0)  # How far the inner and the outer end of a brow go up.
    together: float = 0.0  # How far the brows go towards each other.
    lids: tuple[float, float] = (1.0, 1.0)  # How far upper and lower lids are open, by how far they are.
    nose: float = 0.0  # How far the wings of the nose go up.


EXPRESSED = {
    "happy": Moved(
        corner=(-2.0, 5.5, 6.5), upper=1.0, lower=6.0, square=1.6, cheek=3.6, brow=(0.8, 1.2), lids=(0.82, 0.55)
    ),
    "sad": Moved(
        corner=(-0.5, 1.0, -6.5), upper=0.6, lower=0.2, pout=2.2, brow=(5.5, -3.0), together=2.0, lids=(0.66, 0.95)
    ),
    "surprised": Moved(corner=(1.5, -3.5, -0.5), upper=2.5, lower=10.0, pout=1.0, brow=(5.5, 5.5), lids=(1.22, 1.12)),
    "angry": Moved(
        corner=(0.0, 2.0, -2.5), upper=1.2, lower=2.2, square=4.0, brow=(-4.5, 2.5), together=3.0, lids=(0.72, 0.72)
    ),
    "disgusted": Moved(
        corner=(0.0, 1.5, -3.0),
        upper=3.2,
        lower=1.5,
        cheek=1.8,
        brow=(-2.8, 0.0),
        together=2.0,
        lids=(0.6, 0.5),
        nose=2.6,
    ),
    "scared": Moved(
        corner=(-1.0, 4.5, -2.0), upper=1.0, lower=5.0, square=3.0, brow=(5.5, 1.5), together=2.0, lids=(1.2, 1.0)
    ),
    "sleepy": Moved(corner=(0.0, -0.5, 0.0), upper=0.3, lower=1.2, brow=(0.5, -0.8), lids=(0.06, 0.86)),
    "crying": Moved(
        corner=(-1.5, 4.5, -2.0),
        upper=3.0,
        lower=11.0,
        square=4.5,
        cheek=3.4,
        brow=(2.0, -3.5),
        together=3.0,
        lids=(-0.22, 0.10),
        nose=1.6,
    ),
}
"""Expression by name."""


MIN_MM = 0.12  # Smaller moves are left out.


def moved(mesh, face: Moved) -> Array:
    """Return how the vertices of the surface of a mesh, a `make_head.HeadMesh`, move; those of strips as their edges.

    Lids turn about the eyeballs besides (`mimoc.compiler.looks.head.turned_lids`).
    """
    verts = mesh.verts
    moves = (_mouth(verts, mesh.side, face) + _brows(verts, face) + _cheeks(verts, face))[mesh.twins]
    size = np.linalg.norm(moves, axis=1, keepdims=True)
    moves = moves * smoothstep((size - MIN_MM) / MIN_MM)
    return moves + _turned_lips(mesh, moves)


def _turned_lips(mesh, moves: Array) -> Array:
    """Return how much more the inner edges of the lips move: as far as the lips, and apart a little less."""
    inner = np.isin(np.arange(len(mesh.verts)), mesh.loop)
    return np.where(inner[:, None], -0.1 * moves * (0, 0, 1), 0.0)


def _near(verts: Array, place: tuple[float, float, float], size: tuple[float, float, float]) -> Array:
    """Return 1 at a place on either side of the face, and less and less around it, shape (n, 1)."""
    far = (heads.folded(verts) - np.array(place) * (1, -1, 1)) / size
    return np.exp(-(far**2).sum(axis=1))[:, None]


def _mouth(verts: Array, side: np.ndarray, face: Moved) -> Array:
    """Return how lips, corners of the mouth, chin and jaw move."""
    x, z = SHAPES[MESHED].mouth
    half = heads.MOUTH_HALF - heads.CORNER_IN
    outward = np.sign(verts[:, 1])
    across = np.clip(np.abs(verts[:, 1]) / half, 0, 1)
    height = verts[:, 2] - z - 1.8 * across**2
    in_front = smoothstep((verts[:, 0] - 15) / 35)
    outline = (1 - across**face.square) ** (1 / face.square)
    jaw = np.exp(-((verts[:, 1] / 27) ** 2))
    on_chin = smoothstep((-height - 3) / 9)
    below = (1 - on_chin) * outline + on_chin * jaw * (1 - 0.35 * smoothstep((-height - 8) / 20))
    above = outline * np.exp(-((height / 8.5) ** 2))
    up = in_front * np.where(side > 0, face.upper * above, -face.lower * below)
    lips = np.exp(-((height / 8) ** 2) - (verts[:, 1] / 15) ** 2)
    forward = in_front * (face.pout * lips - 0.25 * face.lower * on_chin * jaw * (side < 0))
    moves = np.column_stack((forward, np.zeros(len(verts)), up))
    ahead, aside, rise = face.corner
    corner = _near(verts, (x - 8, half, z + 1.5), (14, 8.5, 9)) * in_front[:, None]
    return moves + corner * np.column_stack((np.full(len(verts), ahead), aside * outward, np.full(len(verts), rise)))


def _brows(verts: Array, face: Moved) -> Array:
    """Return how the skin of the brows moves."""
    inner, outer = face.brow
    near_inner = _near(verts, (76, 12, 11), (18, 9, 9))
    near_outer = _near(verts, (66, 32, 11), (18, 11, 9))
    together = -face.together * np.sign(verts[:, 1])[:, None] * (0, 1, 0)
    raised = np.array((0.12 * abs(inner), 0, inner))
    return near_inner * (raised + together) + near_outer * (0, 0, outer)


def _cheeks(verts: Array, face: Moved) -> Array:
    """Return how cheeks and nose move."""
    tip_x, tip_z, _ = SHAPES[MESHED].tip
    outward = np.sign(verts[:, 1])[:, None] * (0, 1, 0)
    cheek = _near(verts, (66, 29, -30), (22, 14, 12)) * ((0.55, 0, 0.8) + 0.35 * outward) * face.cheek
    return cheek + _near(verts, (tip_x - 4, 6, tip_z - 2), (9, 6, 6)) * (0.3, 0, 1.0) * face.nose
