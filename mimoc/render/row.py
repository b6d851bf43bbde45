"""Several infants side by side on a plain floor: their model, and where each of them stands in it."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.geometry.rotations import FloatArray, matrix_from_axis
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import in_subtrees
from mimoc.render.camera import FROM_THE_FRONT, view_of_body
from mimoc.render.picture_poses import load_in_pose

GAP_M = 0.06
"""Between one infant and the next."""
UP = (0.0, 0.0, 1.0)
NAME_BYTES = 40
"""For the name of a body in MuJoCo's file of a skin."""
FLOOR = """
<mujoco model="row">
  <statistic center="0 0 0.3" extent="1"/>
  <visual>
    <quality numslices="48" numstacks="32"/>
    <map znear="0.005" zfar="60"/>
  </visual>
  <asset>
    <texture name="sky" type="skybox" builtin="flat" width="32" height="192"/>
    <texture name="mat" type="2d" builtin="checker" width="64" height="64" rgb1="0.93 0.91 0.86" rgb2="0.87 0.86 0.82"/>
    <material name="mat" texture="mat" texrepeat="4 4" texuniform="true" specular="0.1" shininess="0.1"/>
  </asset>
  <worldbody>
    <geom name="floor" type="plane" size="30 30 1" material="mat"/>
  </worldbody>
</mujoco>
"""
"""What is around a row: the floor of `scene: {kind: flat}`, as in `templates/scene.xml.j2`, and a sky.

Their light and colours are those of pictures (`soft_light.py`, `backdrop.py`). Rooms and cribs are too small for a row,
and their toys would be in its way.
"""


@dataclass(frozen=True, slots=True)
class Move:
    """A turn about the vertical, and then a shift."""

    turn_rad: float
    shift_m: FloatArray
    """Shape (3,)."""

    def points_m(self, scene_m: FloatArray) -> FloatArray:
        """Return points, shape (..., 3), where they are afterwards."""
        return scene_m @ matrix_from_axis(UP, self.turn_rad).T + self.shift_m

    def quaternion(self, scene_quat: FloatArray) -> FloatArray:
        """Return an orientation, shape (4,), as it is afterwards."""
        turn, turned = np.empty(4), np.empty(4)
        mujoco.mju_axisAngle2Quat(turn, UP, self.turn_rad)
        mujoco.mju_mulQuat(turned, turn, scene_quat)
        return turned


def row_of(bundles: Sequence[Bundle], pose: str | None) -> tuple[mujoco.MjModel, mujoco.MjData, list[str], list[Move]]:
    """Return infants side by side along y on a floor, all facing +x; UnknownNameError if a bundle has no such pose.

    These are a model of all and its state; the names of their root bodies, from the left; and what takes each infant,
    and what belongs to it, from its own scene to its place.
    """
    posed = [load_in_pose(bundle, pose) for bundle in bundles]
    model, prefixes = _model_of(bundles)
    data = mujoco.MjData(model)
    moves, end_m = [], 0.0
    for bundle, alone, prefix in zip(bundles, posed, prefixes, strict=True):
        move, width_m = _to_place(*alone, bundle.manifest.root_body, end_m)
        _take_pose(data, prefix, alone, move)
        moves.append(move)
        end_m += width_m + GAP_M
    mujoco.mj_forward(model, data)
    roots = [prefix + bundle.manifest.root_body for prefix, bundle in zip(prefixes, bundles, strict=True)]
    return model, data, roots, moves


def _to_place(model: mujoco.MjModel, data: mujoco.MjData, root: str, left_m: float) -> tuple[Move, float]:
    """Return what takes an infant from where its scene has it to where its least y is *left_m*, and its width."""
    front_deg, _ = view_of_body(FROM_THE_FRONT, data, root)
    turn = Move(float(np.radians(FROM_THE_FRONT[0] - front_deg)), np.zeros(3))
    geoms = in_subtrees(model, [model.body(root).id])[model.geom_bodyid]
    across = matrix_from_axis(UP, turn.turn_rad)[1] @ data.geom_xmat[geoms].reshape(-1, 3, 3)
    middles_m, halves_m = model.geom_aabb[geoms, :3], model.geom_aabb[geoms, 3:]
    y_m = turn.points_m(data.geom_xpos[geoms])[:, 1] + (across * middles_m).sum(axis=1)
    reach_m = (np.abs(across) * halves_m).sum(axis=1)
    low_m, high_m = float((y_m - reach_m).min()), float((y_m + reach_m).max())
    x_m, _, _ = turn.points_m(data.body(root).xpos)
    return Move(turn.turn_rad, np.array([-x_m, left_m - low_m, 0.0])), high_m - low_m


def _take_pose(data: mujoco.MjData, prefix: str, posed: tuple[mujoco.MjModel, mujoco.MjData], move: Move) -> None:
    """Give an infant in a row the pose that it has alone; the toys of its scene are not there."""
    alone, state = posed
    for number in range(alone.njnt):
        joint = alone.joint(number)
        if mujoco.mj_name2id(data.model, mujoco.mjtObj.mjOBJ_JOINT, prefix + joint.name) < 0:
            continue
        qpos = state.joint(number).qpos.copy()
        if joint.type == mujoco.mjtJoint.mjJNT_FREE:
            qpos = np.concatenate([move.points_m(qpos[:3]), move.quaternion(qpos[3:])])
        data.joint(prefix + joint.name).qpos[:] = qpos


def _model_of(bundles: Sequence[Bundle]) -> tuple[mujoco.MjModel, list[str]]:
    prefixes = [f"{number}: " for number in range(len(bundles))]
    files: dict[str, bytes] = {}
    for bundle, prefix in zip(bundles, prefixes, strict=True):
        files |= {prefix + name: picture for name, picture in _files(bundle, ".png").items()}
        files |= {prefix + name: _renamed(skin, prefix) for name, skin in _files(bundle, ".skn").items()}
    row = mujoco.MjSpec.from_string(FLOOR, assets=files)
    for bundle, prefix in zip(bundles, prefixes, strict=True):
        infant = mujoco.MjSpec.from_string(bundle.files["infant.xml"].decode(), assets=_files(bundle, ".png"))
        scene = mujoco.MjSpec.from_string(bundle.files[bundle.manifest.scene].decode(), include=dict(bundle.files))
        for texture in infant.textures:
            texture.file = prefix + texture.file  # Infants of other looks have other pictures by the same names.
        for geom in infant.geoms:
            geom.group = scene.geom(geom.name).group  # Solids under a skin are in another one.
        infant.option, row.nuser_actuator = row.option, infant.nuser_actuator  # Where they differ, MuJoCo warns.
        row.attach(infant, frame=row.worldbody.add_frame(), prefix=prefix)
        for skin in scene.skins:
            name, file, material = (prefix + text for text in (skin.name, skin.file, skin.material))
            row.add_skin(name=name, file=file, material=material, group=skin.group)
    return row.compile(), prefixes


def _files(bundle: Bundle, ending: str) -> dict[str, bytes]:
    return {name: file for name, file in bundle.files.items() if name.endswith(ending)}


def _renamed(skin: bytes, prefix: str) -> bytes:
    """Return a file of a skin of bodies whose names begin with *prefix*; not every MuJoCo does this itself (3.5).

    The file has four counts, of vertices, texture coordinates, triangles and bodies, these vertices, coordinates and
    triangles, and then for each body its name, seven numbers of its pose, a count, and as many vertices and weights.
    """
    vertices, texcoords, triangles, bodies = np.frombuffer(skin, "<i4", 4).tolist()
    start = 4 * (4 + 3 * vertices + 2 * texcoords + 3 * triangles)
    parts = [skin[:start]]
    for _ in range(bodies):
        counted = start + NAME_BYTES + 4 * 7
        (moved,) = np.frombuffer(skin, "<i4", 1, counted).tolist()
        end = counted + 4 * (1 + 2 * moved)
        name = prefix.encode() + skin[start : start + NAME_BYTES].rstrip(b"\0")
        parts += [name.ljust(NAME_BYTES, b"\0"), skin[start + NAME_BYTES : end]]
        start = end
    return b"".join(parts)
