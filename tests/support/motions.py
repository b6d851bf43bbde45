"""Known motions of simulated infants, from which recordings of points and their retargeting are made for tests."""

import numpy as np

import mimoc
from mimoc.motion.joint_motion import JointMotion, motion_of


def moved(bundle: mimoc.Bundle, seconds: float = 2.0, every: int = 3, seed: int = 0, strength: float = 0.3) -> JointMotion:
    """Return the motion of an infant under slow random commands: one that its own body can make.

    Args:
        bundle: The infant.
        seconds: Its duration.
        every: Control steps from one frame to the next.
        seed: Of the commands.
        strength: Largest command.
    """
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
