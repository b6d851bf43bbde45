"""Poses that pictures show and no episode starts in: each a start pose with other angles, put down on the floor."""

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import UnknownNameError, check_name
from mimoc.base.geometry.rotations import matrix_from_axis
from mimoc.base.geometry.solvers import root
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import begin, bounded, in_subtrees, load_model, pose_of
from mimoc.bundle.world import WorldBundle, load_world_model, take_pose
from mimoc.render.camera import lowest_m

SIDES = ("right", "left")
LEFT = (0.0, 1.0, 0.0)


@dataclass(frozen=True, slots=True)
class PicturePose:
    """A pose for pictures."""

    base: str  # The start pose whose angles it has where it has no others.
    angles_deg: Mapping[str, float]
    """Angles of joints; `{side}` stands for both sides. Joints end at their limits, and those that are not there are
    left out."""
    pitch_deg: float | None = None  # Pitch of the hip about its left, from upright; None is that of the base.
    on_hands: bool = False
    """Whether its arms touch the floor: the pitch is the one near `pitch_deg` at which they and the rest both do."""


CRAWLING = {
    "hip_bend1": -8, "hip_bend2": -8, "head_swivel": 0, "head_tilt": -62, "head_tilt_side": 0,
    "{side}_shoulder_ad_ab": 78, "right_shoulder_horizontal": 104, "left_shoulder_horizontal": 76,
    "{side}_shoulder_rotation": 0, "{side}_elbow": -8,
    "{side}_hand1": 0, "{side}_hand2": 82, "{side}_hand3": 0, "{side}_fingers": -5,
    "right_hip1": -78, "left_hip1": -100, "{side}_hip2": -8, "{side}_hip3": 0,
    "right_knee": -82, "left_knee": -103, "{side}_foot1": -50, "{side}_foot2": 0, "{side}_foot3": 0, "{side}_toes": 0,
}  # fmt: skip
LOOKING = {
    "hip_bend1": -14, "hip_bend2": -14, "head_swivel": 0, "head_tilt": -55, "head_tilt_side": 0,
    "{side}_shoulder_ad_ab": 62, "{side}_shoulder_horizontal": 72, "{side}_shoulder_rotation": -38,
    "{side}_elbow": -92, "{side}_hand1": 75, "{side}_hand2": 10,
    "{side}_hip1": -12, "{side}_hip2": -14, "{side}_hip3": 20, "right_knee": -12, "left_knee": -75, "{side}_foot1": -40,
}  # fmt: skip
PLAYING = {
    "hip_bend1": 8, "hip_bend2": 8, "head_tilt": -6, "head_swivel": -8,
    "{side}_shoulder_ad_ab": 35, "{side}_shoulder_horizontal": 70, "{side}_shoulder_rotation": -10,
    "right_elbow": -45, "left_elbow": -60, "{side}_fingers": -35,
}  # fmt: skip
KICKING = {
    "right_hip1": -85, "right_hip2": -15, "right_hip3": 20, "right_knee": -35,
    "left_hip1": -60, "left_hip2": -25, "left_hip3": 30, "left_knee": -95,
    "right_shoulder_ad_ab": 70, "left_shoulder_ad_ab": 105, "head_swivel": -15,
}  # fmt: skip

PICTURE_POSES: Mapping[str, PicturePose] = {
    "crawling": PicturePose("prone", CRAWLING, pitch_deg=85.0, on_hands=True),
    "playing": PicturePose("sitting", PLAYING),
    "looking": PicturePose("prone", LOOKING, pitch_deg=75.0, on_hands=True),
    "kicking": PicturePose("supine", KICKING),
}
"""On hands and knees; sitting, busy with its hands; on its forearms, with its head up; on its back, kicking (D)."""
TURNS_DEG = 45.0  # How far the pitch may be from the one that is written.
PRECISION_RAD = 1e-6


def poses_in_pictures(manifest: Manifest) -> tuple[str, ...]:
    """Return the names of the poses that an infant can be drawn in; one that is held has its start poses alone."""
    if manifest.constraints.locks or manifest.constraints.welds:
        return manifest.poses
    return (*manifest.poses, *(name for name, pose in PICTURE_POSES.items() if pose.base in manifest.poses))


def pose_in_picture(manifest: Manifest, pose: str | None) -> str:
    """Return the name of a pose for a picture, by default the infant's; an UnknownNameError says which there are."""
    names = poses_in_pictures(manifest)
    if pose in names:
        return str(pose)
    if pose is None or names == manifest.poses:
        return pose_of(manifest, pose)
    raise UnknownNameError("pose", pose, names)


def load_in_pose(bundle: Bundle, pose: str | None = None) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Return the compiled scene of a bundle and its state in a start pose, a pose for pictures, or its own.

    Raises:
        ModelError: If MuJoCo rejects the model.
        UnknownNameError: If there is no such pose.
    """
    pose_in_picture(bundle.manifest, pose)
    model = load_model(bundle)
    return model, state_in_pose(bundle, model, pose)


def load_world_in_pose(bundle: WorldBundle, pose: str | None = None) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Return the model of a world and its state with all infants in a start pose, or as each starts.

    Raises:
        ModelError: If MuJoCo rejects the model.
        UnknownNameError: If an infant has no such pose.
    """
    model = load_world_model(bundle)
    with bounded():
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key(bundle.manifest.pose).id)
        for name, infant in bundle.infants.items() if pose is not None else ():
            poses = {infant.manifest.of_infant(keyframe): keyframe for keyframe in infant.manifest.poses}
            check_name(f"pose of '{name}'", pose, poses)
            take_pose(infant.manifest.root_body, poses[str(pose)], data)
        begin(model, data)
    return model, data


def state_in_pose(bundle: Bundle, model: mujoco.MjModel, pose: str | None = None) -> mujoco.MjData:
    """Return the state of the compiled scene of a bundle in a pose; see `load_in_pose`."""
    name = pose_in_picture(bundle.manifest, pose)
    wanted = PICTURE_POSES.get(name) if name not in bundle.manifest.poses else None
    with bounded():
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key(wanted.base if wanted else name).id)
        begin(model, data)
    if wanted is not None:
        floor_m = lowest_m(model, data, _solids(model, bundle.manifest.root_body))
        _take(model, data, wanted, bundle.manifest, floor_m)
    return data


def _take(model: mujoco.MjModel, data: mujoco.MjData, pose: PicturePose, manifest: Manifest, floor_m: float) -> None:
    """Put an infant in a pose for pictures, its lowest point at a height."""
    for name, angle_deg in pose.angles_deg.items():
        for joint in {name.format(side=side) for side in SIDES}:
            number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, f"robot:{joint}")
            if number >= 0:
                low, high = model.jnt_range[number]
                data.qpos[model.jnt_qposadr[number]] = np.clip(np.radians(angle_deg), low, high)
    if pose.pitch_deg is not None:
        middle = float(np.radians(pose.pitch_deg))
        pitch = _pitch_on_hands(model, data, manifest, middle) if pose.on_hands else middle
        _turn(model, data, manifest.root_body, pitch)
    mujoco.mj_kinematics(model, data)
    rise_m = floor_m - lowest_m(model, data, _solids(model, manifest.root_body))
    data.qpos[_free_joint(model, manifest.root_body) + 2] += rise_m
    mujoco.mj_forward(model, data)


def _pitch_on_hands(model: mujoco.MjModel, data: mujoco.MjData, manifest: Manifest, middle_rad: float) -> float:
    """Return the pitch near another one at which arms and all else are equally low; the other one without arms."""
    arms = _solids(model, *(arm.root for arm in manifest.anatomy.arms))
    others = _solids(model, manifest.root_body) & ~arms

    def higher_m(pitch_rad: float) -> float:
        _turn(model, data, manifest.root_body, pitch_rad)
        mujoco.mj_kinematics(model, data)
        return lowest_m(model, data, arms) - lowest_m(model, data, others)

    low = middle_rad - np.radians(TURNS_DEG)
    high = middle_rad + np.radians(TURNS_DEG)
    if not arms.any() or higher_m(low) * higher_m(high) > 0:
        return middle_rad
    return root(higher_m, low, high, PRECISION_RAD)


def _turn(model: mujoco.MjModel, data: mujoco.MjData, body: str, pitch_rad: float) -> None:
    """Turn a body to a pitch, facing where it faced: along x, turned by where its left points."""
    across = data.body(body).xmat.reshape(3, 3)[:2, 1].copy()
    yaw = matrix_from_axis((0.0, 0.0, 1.0), float(np.arctan2(-across[0], across[1])))
    address = _free_joint(model, body)
    mujoco.mju_mat2Quat(data.qpos[address + 3 : address + 7], (yaw @ matrix_from_axis(LEFT, pitch_rad)).ravel())


def _free_joint(model: mujoco.MjModel, body: str) -> int:
    return int(model.jnt_qposadr[model.body(body).jntadr[0]])


def _solids(model: mujoco.MjModel, *bodies: str) -> npt.NDArray[np.bool_]:
    """Return which geoms that touch things are of some bodies and of those that hang on them, shape (ngeom,)."""
    return in_subtrees(model, [model.body(body).id for body in bodies])[model.geom_bodyid] & (model.geom_contype > 0)
