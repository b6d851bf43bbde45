"""A recording as motions that mjlab's tracking tasks follow: a NumPy archive for each episode.

As mjlab's `csv_to_npz.py` writes them: `fps`, `joint_pos` and `joint_vel` of all joints but the free one; and of all
bodies of the infant, in the order of the model, `body_pos_w`, `body_quat_w` (w, x, y, z), `body_lin_vel_w` (of the
body's own origin) and `body_ang_vel_w`, all in the world's frame. `joint_names` and `body_names` are added, which mjlab
passes over.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from mimoc.recording.reading import ReadRecording
from mimoc.recording.replaying import open_recorded, replay
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import Observation


def export(recording: ReadRecording, out: Path, progress: Callable[[int, int], None]) -> list[str]:
    """Write `NAME.npz` for each episode, which is simulated again for it; return what these cannot hold."""
    notes = ["actions, rewards, senses, states and all that is not the infant are left out: a motion cannot hold them"]
    total, done = sum(episode.steps for episode in recording), 0
    for episode in recording:
        film = _Film()
        again = replay(
            recording,
            open_recorded,
            episodes=[episode],
            watch=film,
            progress=lambda steps, _, before=done: progress(before + steps, total),
        )
        for replayed in again:
            if replayed.difference:
                notes.append(f"the motion is what is simulated now, which differs from the recording: {replayed}")
        with (out / f"{episode.files.stems[0].name}.npz").open("wb") as file:
            np.savez(file, allow_pickle=False, fps=np.array([1000.0 / episode.step_ms]), **film.arrays())
        done += episode.steps
    return notes


class _Film:
    """Keeps joints and bodies of an infant while it is simulated again."""

    def __init__(self) -> None:
        self._model: mujoco.MjModel | None = None
        self._rows: dict[str, list[Any]] = {}

    def __call__(self, env: Infant, observation: Observation) -> None:
        if env.model is not self._model:
            self._bind(env)
        model, data = env.model, self._data
        data.qpos[:], data.qvel[:] = env.data.qpos, env.data.qvel
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_comVel(model, data)
        turning_and_moving = np.zeros((len(self._bodies), 6))
        for velocity, body in zip(turning_and_moving, self._bodies, strict=True):
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, velocity, 0)
        frame = {
            "joint_pos": data.qpos[model.jnt_qposadr[self._joints]],
            "joint_vel": data.qvel[model.jnt_dofadr[self._joints]],
            "body_pos_w": data.xpos[self._bodies],
            "body_quat_w": data.xquat[self._bodies],
            "body_lin_vel_w": turning_and_moving[:, 3:],
            "body_ang_vel_w": turning_and_moving[:, :3],
        }
        for name, values in frame.items():
            self._rows.setdefault(name, []).append(values.astype(np.float32))

    def arrays(self) -> dict[str, Any]:
        """Return all frames by name, each of shape (frames, ...), and the names of joints and bodies."""
        return {**{name: np.stack(rows) for name, rows in self._rows.items()}, **self._names}

    def _bind(self, env: Infant) -> None:
        model = self._model = env.model
        self._data = mujoco.MjData(model)
        root = model.body_rootid[model.body(env.manifest.root_body).id]
        self._bodies = [body for body in range(1, model.nbody) if model.body_rootid[body] == root]
        is_own = model.body_rootid[model.jnt_bodyid] == root
        self._joints = np.flatnonzero(is_own & (model.jnt_type != mujoco.mjtJoint.mjJNT_FREE))
        own = env.manifest.of_infant
        bodies = [own(model.body(body).name) for body in self._bodies]
        joints = [own(model.joint(int(joint)).name) for joint in self._joints]
        self._names = {"body_names": np.array(bodies), "joint_names": np.array(joints)}
