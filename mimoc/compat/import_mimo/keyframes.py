"""Keyframes of a MIMo scene, in the order of the joints and actuators that it has with mimoc's infant."""

from collections.abc import Iterator, Mapping

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.body.tree import FREE_JOINT
from mimoc.compat.import_mimo.infant import HIP, Infant
from mimoc.compat.import_mimo.reading import Element

POSITIONS, VELOCITIES = (7, 4, 1, 1), (6, 3, 1, 1)
"""Numbers of a free joint, a ball joint, a slide and a hinge."""


def moved_keyframes(infant: Infant, source: mujoco.MjModel, scene: mujoco.MjModel) -> Element:
    """Return the keyframes of a scene, *source*, for what was made of it, *scene*.

    Joints and actuators are found by their names, those without one by the body that they move. What only the latter
    has is where it is at the start, at rest and without a command. Commands keep their place within their range,
    which for servos is in radians in MIMo.
    """
    home = infant.free_joint
    renamed = {home.get("name"): FREE_JOINT, (infant.home or infant.hip).get("name"): HIP} if home else {}
    joints = list(_pairs(_joints(source), _joints(scene), renamed))
    motors = list(_pairs(_actuators(source), _actuators(scene), {}))
    keys = []
    for key in range(source.nkey):
        qpos, qvel, ctrl = np.array(scene.qpos0), np.zeros(scene.nv), np.zeros(scene.nu)
        for old, new in joints:
            kind = source.jnt_type[old]
            _copy(source.key_qpos[key], source.jnt_qposadr[old], qpos, scene.jnt_qposadr[new], POSITIONS[kind])
            _copy(source.key_qvel[key], source.jnt_dofadr[old], qvel, scene.jnt_dofadr[new], VELOCITIES[kind])
        for old, new in motors:
            ctrl[new] = np.interp(
                source.key_ctrl[key][old], source.actuator_ctrlrange[old], scene.actuator_ctrlrange[new]
            )
        values = {
            "qpos": qpos,
            "qvel": qvel,
            "ctrl": ctrl,
            "mpos": source.key_mpos[key],
            "mquat": source.key_mquat[key],
        }
        texts = {name: " ".join(f"{number:.9g}" for number in array) for name, array in values.items() if array.size}
        name = {"name": source.key(key).name} if source.key(key).name else {}
        keys.append(Element("key", {**name, "time": f"{source.key_time[key]:.9g}", **texts}))
    return Element("keyframe", {}, children=keys)


def _joints(model: mujoco.MjModel) -> dict[str, int]:
    names = dict[str, int]()
    for joint in range(model.njnt):
        body = model.jnt_bodyid[joint]
        number = joint - model.body_jntadr[body]
        names[model.joint(joint).name or f"{model.body(body).name}/{number}"] = joint
    return names


def _actuators(model: mujoco.MjModel) -> dict[str, int]:
    return {model.actuator(actuator).name: actuator for actuator in range(model.nu)}


def _pairs(old: Mapping[str, int], new: Mapping[str, int], renamed: Mapping[str, str]) -> Iterator[tuple[int, int]]:
    for name, number in old.items():
        body, slash, _ = name.partition("/")
        name = FREE_JOINT if slash and renamed.get(body) == HIP else renamed.get(name, name)
        if name in new:
            yield number, new[name]


def _copy(source: npt.NDArray[np.float64], start: int, target: npt.NDArray[np.float64], place: int, count: int) -> None:
    target[place : place + count] = source[start : start + count]
