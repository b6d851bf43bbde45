"""What an infant in a pose would see, with several kinds of sight."""

from collections.abc import Collection, Sequence
from contextlib import closing

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_posed
from mimoc.errors import UnknownNameError
from mimoc.senses.vision.eyes import Drawn, Eyes
from mimoc.senses.vision.run import filters, perceive
from mimoc.senses.vision.spec import VisionEntry

FloatArray = npt.NDArray[np.float64]

OWN = ("right_hand", "left_hand", "right_foot", "left_foot")
"""What an eye looks at where it sees no toys."""
DOWN_DEG = 50.0
"""How far it looks down where it sees none of these either."""
AHEAD = 0.5
"""Cosine of the angle from straight ahead, 60°, within which things are looked at."""


def glimpse(
    bundle: Bundle,
    sights: Sequence[Sequence[VisionEntry]],
    pose: str | None = None,
    down_deg: float | None = None,
    fovy_deg: float | None = None,
) -> list[list[npt.NDArray[np.uint8]]]:
    """Return what each of some sights makes of one and the same view, shape (height, width, 3) each.

    Args:
        bundle: The infant; it need not have a sense of vision.
        sights: In rows; all of one eye, size and supersampling.
        pose: Another than the bundle's own.
        down_deg: How far the eye looks down from straight ahead; left out, it looks at the toy that it sees best, or
            where it sees none at a hand or a foot.
        fovy_deg: Vertical field of view, if it is not the eye's own.

    Raises:
        UnknownNameError: If the infant has no such pose or no such eye.
        RenderingError: If there is no OpenGL here.
    """
    model, data = load_posed(bundle, pose)
    first = sights[0][0]
    (name,) = first.cameras
    _require("camera of this infant", name, [model.camera(index).name for index in range(model.ncam)])
    camera = data.camera(name)
    world_from_eye = camera.xmat.reshape(3, 3).copy()
    camera.xmat = _turned(world_from_eye, _gaze(bundle, data, camera.xpos, world_from_eye, down_deg))
    if fovy_deg is not None:
        model.camera(name).fovy = fovy_deg
    drawn, fovy_deg = _draw(model, data, first), float(model.camera(name).fovy[0])
    return [[perceive(drawn, filters(sight, fovy_deg))[0] for sight in row] for row in sights]


def _require(kind: str, name: str, known: Collection[str]) -> None:
    if name not in known:
        raise UnknownNameError(kind, name, known)


def _draw(model: mujoco.MjModel, data: mujoco.MjData, sight: VisionEntry) -> Drawn:
    larger = sight.supersample
    size_px = larger * sight.width_px, larger * sight.height_px
    with closing(Eyes(model, sight.cameras, *size_px, sight.unseen)) as eyes:
        return eyes(data)


def _gaze(
    bundle: Bundle, data: mujoco.MjData, eye_m: FloatArray, world_from_eye: FloatArray, down_deg: float | None
) -> FloatArray:
    """Return where an eye looks, a vector of shape (3,) in the world."""
    _, up, back = world_from_eye.T
    toys = {toy.body: toy.size_m for toy in bundle.manifest.toys}
    for sizes_m in () if down_deg is not None else (toys, dict.fromkeys(_own(data.model), 1.0)):
        ways_m = {body: data.body(body).xipos - eye_m for body in sizes_m}
        angles = {body: sizes_m[body] / float(np.linalg.norm(way_m)) for body, way_m in ways_m.items()}
        seen = [body for body, way_m in ways_m.items() if -(way_m @ back) > AHEAD * np.linalg.norm(way_m)]
        if seen:
            return ways_m[max(seen, key=angles.__getitem__)]
    angle = np.radians(DOWN_DEG if down_deg is None else down_deg)
    return -np.cos(angle) * back - np.sin(angle) * up


def _own(model: mujoco.MjModel) -> list[str]:
    return [body for body in OWN if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body) >= 0]


def _turned(world_from_eye: FloatArray, gaze: FloatArray) -> FloatArray:
    """Return the rotation of an eye that has turned to look somewhere, nine numbers; its horizontal stays level."""
    back = -gaze / np.linalg.norm(gaze)
    across = world_from_eye[:, 0] - world_from_eye[:, 0] @ back * back
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(back, across), back], axis=1).ravel()
