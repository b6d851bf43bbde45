"""Is a bundle fit to be used: does it load, and does it stay calm whatever it is commanded?"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model, simulation_warnings
from mimoc.runtime.fastenings import Fastenings
from mimoc.senses.sense import FloatArray
from mimoc.units import ms_to_s, rad_to_deg

CHECKED_S = 1.0
"""Simulated time from each pose with each kind of commands."""
SWITCHING_S = (0.05, 0.1)
"""Range of how long alternating commands stay."""
MAX_ENERGY_J_PER_KG = 20.0
"""Kinetic energy that flailing limbs stay far below (measured: at most 6) and a broken simulation far exceeds."""
MAX_BEYOND_DEG = 60.0
"""How far beyond its limit a joint may be flung; limits are as soft as MIMo's, whose thumbs go up to 40 degrees."""


@dataclass(frozen=True, slots=True)
class Flailing:
    """What some commands did to an infant."""

    warnings: tuple[str, ...]
    """MuJoCo's, by kind."""
    energy_j_per_kg: float
    """Largest kinetic energy."""
    beyond_deg: float
    """How far the joint that went furthest beyond its limits was beyond them."""
    joint: str
    """Which one that was; empty where none ever was."""


@dataclass(frozen=True, slots=True)
class PoseCheck(Flailing):
    """The worst that a second of each kind of commands did to an infant in one pose."""

    pose: str

    @property
    def passed(self) -> bool:
        """Whether nothing went wrong."""
        calm = self.energy_j_per_kg <= MAX_ENERGY_J_PER_KG and self.beyond_deg <= MAX_BEYOND_DEG
        return not self.warnings and calm


def check_stability(bundle: Bundle, seed: int = 0) -> Iterator[PoseCheck]:
    """Yield the check of each pose: one second of each kind of `COMMANDS` to all actuators.

    Raises:
        ModelError: If MuJoCo refuses the model.
    """
    model = load_model(bundle)
    generator = np.random.default_rng(seed)
    for pose in bundle.manifest.poses:
        yield _check_pose(model, bundle, pose, generator)


def random_commands(model: mujoco.MjModel, generator: np.random.Generator, step_s: float) -> Iterator[FloatArray]:
    """Yield commands without end, drawn anew for every control step from the whole range."""
    low, high = model.actuator_ctrlrange.T
    while True:
        yield generator.uniform(low, high)


def alternating_commands(model: mujoco.MjModel, generator: np.random.Generator, step_s: float) -> Iterator[FloatArray]:
    """Yield commands without end that push all joints to and fro, as hard as they can, each for 50 to 100 ms."""
    low, high = model.actuator_ctrlrange.T
    forth = model.actuator_gear[:, 0] > 0  # The second of two muscles has a gear of -1.
    while True:
        for way in (forth, ~forth):
            for _ in range(max(1, round(generator.uniform(*SWITCHING_S) / step_s))):
                yield np.where(way, high, low)


COMMANDS: Mapping[str, Callable[[mujoco.MjModel, np.random.Generator, float], Iterator[FloatArray]]] = {
    "random": random_commands,
    "alternating": alternating_commands,
}
"""What an infant is commanded, from its model, chance and the control step."""


def flail(data: mujoco.MjData, commands: Iterator[FloatArray], step_s: float, root: str) -> Flailing:
    """Return what a second of commands does, one of them for each control step.

    Args:
        data: The state to start from; it is changed.
        commands: Controls of all actuators.
        step_s: The control step.
        root: The body that all of the infant hangs on.
    """
    model = data.model
    hinges = np.flatnonzero(model.jnt_limited & (model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE))
    addresses, (low, high) = model.jnt_qposadr[hinges], model.jnt_range[hinges].T
    beyond, energy_j, substeps = np.zeros(len(hinges)), 0.0, round(step_s / model.opt.timestep)
    for _ in range(round(CHECKED_S / step_s)):
        data.ctrl[:] = next(commands)
        for _ in range(substeps):
            mujoco.mj_step(model, data)
            mujoco.mj_energyVel(model, data)
            angles = data.qpos[addresses]
            beyond = np.maximum(beyond, np.nan_to_num(np.maximum(low - angles, angles - high), nan=np.inf))
            energy_j = max(energy_j, float(np.nan_to_num(data.energy[1], nan=np.inf)))
    furthest_rad = float(beyond.max(initial=0.0))
    return Flailing(
        simulation_warnings(data),
        energy_j / float(model.body(root).subtreemass[0]),
        rad_to_deg(furthest_rad),
        model.joint(hinges[beyond.argmax()]).name if furthest_rad else "",
    )


def _check_pose(model: mujoco.MjModel, bundle: Bundle, pose: str, generator: np.random.Generator) -> PoseCheck:
    manifest, found, step_s = bundle.manifest, [], ms_to_s(bundle.manifest.step_ms)
    for commands in COMMANDS.values():
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
        mujoco.mj_kinematics(model, data)
        Fastenings(manifest.fastenings, model).keep(data)
        found.append(flail(data, commands(model, generator, step_s), step_s, manifest.root_body))
    furthest = max(found, key=lambda flailing: flailing.beyond_deg)
    return PoseCheck(
        warnings=tuple(sorted({warning for flailing in found for warning in flailing.warnings})),
        energy_j_per_kg=max(flailing.energy_j_per_kg for flailing in found),
        beyond_deg=furthest.beyond_deg,
        joint=furthest.joint,
        pose=pose,
    )
