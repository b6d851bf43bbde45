"""Known motions of simulated infants, from which recordings of points and their retargeting are made for tests."""

from typing import Any

import numpy as np

import mimoc
from mimoc.bundle.model import load_model
from mimoc.compiler.variants import spec_of
from mimoc.motion.body_points import film
from mimoc.motion.joint_motion import JointMotion, motion_of
from mimoc.movement.retargeting.result import Account, Interval, Retargeted


def moved(
    bundle: mimoc.Bundle, seconds: float = 2.0, every: int = 3, seed: int = 0, strength: float = 0.3
) -> JointMotion:
    """Return the motion of an infant under slow random commands: one that its own body can make."""
    env = mimoc.InfantEnv(bundle)
    generator = np.random.default_rng(seed)
    env.reset(seed=seed)
    low, high = env.actuation.low, env.actuation.high
    phases, rates_hz = generator.uniform(0, 2 * np.pi, len(low)), generator.uniform(0.3, 0.8, len(low))
    step_s, frames = env.manifest.step_ms / 1000, [env.data.qpos.copy()]
    for step in range(1, round(seconds / step_s) + 1):
        command = strength * np.sin(2 * np.pi * rates_hz * step * step_s + phases)
        env.step(np.clip(command, low, high).astype(np.float32))
        if step % every == 0:
            frames.append(env.data.qpos.copy())
    return motion_of(env.model, env.manifest.root_body, np.array(frames), 1 / (every * step_s))


def retargeted(bundle: mimoc.Bundle, motion: JointMotion, **options: Any) -> Retargeted:
    """Return what a perfect fit of a known motion would give: points as a camera above sees them."""
    model = load_model(bundle)
    qpos = np.tile(model.key(bundle.manifest.pose).qpos, (len(motion.qpos), 1))
    qpos[:, motion.places(model)[0]] = motion.qpos
    recording = film(model, qpos, motion.rate_hz, **options)
    intervals = {"trunk": Interval(0.2, 0.19, 0.21)}
    account = Account(
        unit="px",
        error_median=0.0,
        error_p95=0.0,
        trunk=recording.trunk,
        error_of_trunk=dict.fromkeys(recording.names, 0.0),
        depth_error_m=None,
        noise=0.0,
        depth_noise_m=None,
        size_is_known=False,
        lengths_m=intervals,
        camera_height_m=Interval(1.08, 1.0, 1.2),
        joints=motion.joints[1:],
        angle_sd_rad=np.zeros((len(qpos), len(motion.joints) - 1)),
        depth_sd_m=dict.fromkeys(recording.names, 0.0),
        unseen=("robot:head_swivel",),
        limits_touched={"robot:left_knee": 0.25},
        frames=len(qpos),
        seconds=0.5,
        notes=("the camera is taken for that of MINI-RGBD",),
    )
    spec = spec_of(bundle)
    return Retargeted(recording, spec, bundle, motion.rate_hz, qpos, 1.08, recording.positions.copy(), account)
