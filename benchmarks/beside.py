"""What comparisons with MIMo's own code share, on either side: this imports nothing of mimoc, nor of MIMo."""

from typing import Any

import mujoco
import numpy as np

STEP_S = 0.01
CONTROL_STEPS = {"physics": 50, "proprioception": 50, "touch": 50, "eyes": 2}
"""Length of an episode; images take a hundred times as long as everything else."""
LANDING_STEPS = 100
ENVIRONMENTS = {"mitten": "MIMoDummyEnv", "five_finger": "MIMoV2DummyEnv"}
TOYS = ("test_object1", "test_object2")


def without_toys(path: str) -> mujoco.MjModel:
    """Compile MIMo's scene for benchmarks without the toys in it."""
    scene = mujoco.MjSpec.from_file(path)
    remove = scene.delete if hasattr(scene, "delete") else scene.detach_body  # MuJoCo 3.3.0 has only the latter.
    for toy in TOYS:
        remove(scene.body(toy))
    return scene.compile()


def landed(model: mujoco.MjModel, pose: str, posed: mujoco.MjModel) -> np.ndarray:
    """Return positions of MIMo shortly after it was put into a pose of mimoc's, whose joints have the same names."""
    data, key = mujoco.MjData(model), posed.key(pose).qpos
    data.qpos[:7] = key[:7]
    for number in range(1, model.njnt):
        joint = model.joint(number)
        with_same_name = mujoco.mj_name2id(posed, mujoco.mjtObj.mjOBJ_JOINT, joint.name)
        if with_same_name >= 0:
            data.qpos[joint.qposadr] = key[posed.jnt_qposadr[with_same_name]]
    mujoco.mj_step(model, data, LANDING_STEPS)
    return data.qpos


def render_its_camera(env: Any) -> Any:
    """Render what the camera sees that MIMo's vision asks for: newer versions of Gymnasium read no `camera_name`."""
    renderer = env.mujoco_renderer
    renderer.camera_id = -1 if env.camera_name is None else env.model.camera(env.camera_name).id
    for viewer in renderer._viewers.values():
        viewer.make_context_current()  # Others draw in this process too.
    return renderer.render(env.render_mode)


def check_observations(env: Any, senses: str) -> None:
    """Refuse touch without forces and images of a single colour, which are faster."""
    observation = env.step(np.zeros(env.model.nu, np.float32))[0]
    if senses == "touch" and not observation["touch"].any():
        raise SystemExit(f"{type(env).__name__} touches nothing")
    if senses == "eyes" and not all(np.ptp(observation[eye]) for eye in ("eye_left", "eye_right")):
        raise SystemExit(f"{type(env).__name__} sees nothing")


def random_commands(steps: int, count: int) -> np.ndarray:
    """Return random commands for some control steps, shape (steps, count)."""
    return np.random.default_rng(0).uniform(-1, 1, (steps, count)).astype(np.float32)


def bare(env: Any, commands: np.ndarray) -> None:
    """Run an episode with nothing but MuJoCo after the reset."""
    env.reset(seed=0)
    model, data = env.model, env.data
    for command in commands:
        data.ctrl[:] = command
        mujoco.mj_step(model, data)
        mujoco.mj_step(model, data)
