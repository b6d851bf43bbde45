"""Is a bundle fit to be used: does it load, and does it stay calm under random control?"""

from collections.abc import Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.bundle import Bundle
from mimoc.runtime.fastenings import Fastenings
from mimoc.runtime.model import load_model, simulation_warnings
from mimoc.units import ms_to_s

CHECKED_S = 1.0
"""Simulated time from each pose."""
MAX_ENERGY_J_PER_KG = 20.0
"""Kinetic energy that flailing limbs stay far below (measured: at most 2) and a broken simulation far exceeds."""


@dataclass(frozen=True, slots=True)
class PoseCheck:
    """What a second of random control did to an infant in one pose."""

    pose: str
    warnings: tuple[str, ...]
    """MuJoCo's warnings, by kind."""
    energy_j_per_kg: float
    """Largest kinetic energy."""

    @property
    def passed(self) -> bool:
        """Whether nothing went wrong."""
        return not self.warnings and self.energy_j_per_kg <= MAX_ENERGY_J_PER_KG


def check_stability(bundle: Bundle, seed: int = 0) -> Iterator[PoseCheck]:
    """Yield the check of each pose: one second of commands drawn anew for every control step.

    Raises:
        ModelError: If MuJoCo refuses the model.
    """
    model = load_model(bundle)
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    generator = np.random.default_rng(seed)
    for pose in bundle.manifest.poses:
        yield _check_pose(model, bundle, pose, generator)


def _check_pose(model: mujoco.MjModel, bundle: Bundle, pose: str, generator: np.random.Generator) -> PoseCheck:
    manifest = bundle.manifest
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    mujoco.mj_kinematics(model, data)
    Fastenings(manifest.fastenings, model).keep(data)
    low, high = model.actuator_ctrlrange.T
    energy_j = 0.0
    for _ in range(round(CHECKED_S / ms_to_s(manifest.step_ms))):
        data.ctrl[:] = generator.uniform(low, high)
        for _ in range(round(manifest.step_ms / manifest.timestep_ms)):
            mujoco.mj_step(model, data)
            energy_j = max(energy_j, float(np.nan_to_num(data.energy[1], nan=np.inf)))
    mass_kg = float(model.body(manifest.root_body).subtreemass[0])
    return PoseCheck(pose, simulation_warnings(data), energy_j / mass_kg)
