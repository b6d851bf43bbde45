"""Check that a bundle loads and that its simulation stays stable under any commands."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model, simulation_warnings
from mimoc.bundle.world import WorldBundle, load_world_model
from mimoc.runtime.model_fields import Constraints
from mimoc.runtime.sense import FloatArray

CHECKED_S = 1.0
SWITCHING_S = (0.05, 0.1)  # Range of the time after which alternating commands switch direction.
MAX_ENERGY_J_PER_KG = 20.0
"""Limit of the kinetic energy; that of flailing limbs stays below 9 (measured), that of unstable simulations does
not."""
MAX_BEYOND_DEG = 60.0
"""Limit of the violation of a joint range; limits are as soft as MIMo's, whose thumbs exceed theirs by up to 40
degrees."""


@dataclass(frozen=True, slots=True)
class Flailing:
    """The result of a trial."""

    warnings: tuple[str, ...]
    energy_j_per_kg: float
    beyond_deg: float
    joint: str  # The joint of that violation; empty if there was none.


@dataclass(frozen=True, slots=True)
class PoseCheck(Flailing):
    """The worst result of all trials from one pose."""

    pose: str

    @property
    def passed(self) -> bool:
        """Whether there were no warnings and both limits were kept."""
        within_limits = self.energy_j_per_kg <= MAX_ENERGY_J_PER_KG and self.beyond_deg <= MAX_BEYOND_DEG
        return not self.warnings and within_limits


def check_stability(bundle: Bundle, seed: int = 0) -> Iterator[PoseCheck]:
    """Yield the check of each pose: a one-second trial with each kind of `COMMANDS`, applied to all actuators."""
    model = load_model(bundle)
    generator = np.random.default_rng(seed)
    manifest = bundle.manifest
    constraints = [Constraints(manifest.constraints, model)]
    for pose in manifest.poses:
        yield _check_pose(model, pose, ms_to_s(manifest.step_ms), constraints, manifest.root_body, generator)


def check_world(bundle: WorldBundle, seed: int = 0) -> PoseCheck:
    """Return the check of a world as its infants start: the same trials, applied to the actuators of all of them."""
    model = load_world_model(bundle)
    generator = np.random.default_rng(seed)
    manifest = bundle.manifest
    constraints = [Constraints(infant.manifest.constraints, model) for infant in bundle.infants.values()]
    return _check_pose(model, manifest.pose, ms_to_s(manifest.step_ms), constraints, "world", generator)


def random_commands(model: mujoco.MjModel, generator: np.random.Generator, step_s: float) -> Iterator[FloatArray]:
    """Yield random commands, drawn anew from the whole range at every control step."""
    low, high = model.actuator_ctrlrange.T
    while True:
        yield generator.uniform(low, high)


def alternating_commands(model: mujoco.MjModel, generator: np.random.Generator, step_s: float) -> Iterator[FloatArray]:
    """Yield commands that drive all joints to and fro at full strength, switching direction every 50 to 100 ms."""
    low, high = model.actuator_ctrlrange.T
    positive = model.actuator_gear[:, 0] > 0  # The second muscle of a pair has a gear of -1.
    while True:
        for driven in (positive, ~positive):
            for _ in range(max(1, round(generator.uniform(*SWITCHING_S) / step_s))):
                yield np.where(driven, high, low)


COMMANDS: Mapping[str, Callable[[mujoco.MjModel, np.random.Generator, float], Iterator[FloatArray]]] = {
    "random": random_commands,
    "alternating": alternating_commands,
}  # Each yields commands for a model, with a generator and the control step in [s].


def flail(data: mujoco.MjData, commands: Iterator[FloatArray], step_s: float, root: str) -> Flailing:
    """Simulate one second with one command per control step; stop after the control step in which MuJoCo warns."""
    model = data.model
    hinges = np.flatnonzero(model.jnt_limited & (model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE))
    addresses = model.jnt_qposadr[hinges]
    low, high = model.jnt_range[hinges].T
    substeps = round(step_s / model.opt.timestep)
    qpos = data.qpos
    least, most = np.full_like(qpos, np.inf), np.full_like(qpos, -np.inf)
    energy_j = 0.0
    for _ in range(round(CHECKED_S / step_s)):
        data.ctrl[:] = next(commands)
        for _ in range(substeps):
            mujoco.mj_step(model, data)
            mujoco.mj_energyVel(model, data)
            np.minimum(least, qpos, out=least)  # A value that is not a number stays in both.
            np.maximum(most, qpos, out=most)
            kinetic_j = float(data.energy[1])
            energy_j = max(energy_j, math.inf if math.isnan(kinetic_j) else kinetic_j)
        if simulation_warnings(data):
            break
    beyond_rad = np.nan_to_num(np.maximum(low - least[addresses], most[addresses] - high), nan=np.inf)
    furthest_rad = float(beyond_rad.max(initial=0.0))
    return Flailing(
        simulation_warnings(data),
        energy_j / float(model.body(root).subtreemass[0]),
        math.degrees(furthest_rad),
        model.joint(hinges[beyond_rad.argmax()]).name if furthest_rad else "",
    )


def _check_pose(
    model: mujoco.MjModel,
    pose: str,
    step_s: float,
    constraints: Sequence[Constraints],
    root: str,
    generator: np.random.Generator,
) -> PoseCheck:
    trials = list[Flailing]()
    for commands in COMMANDS.values():
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
        mujoco.mj_kinematics(model, data)
        for constraint_set in constraints:
            constraint_set.keep(data)
        trials.append(flail(data, commands(model, generator, step_s), step_s, root))
    furthest = max(trials, key=lambda trial: trial.beyond_deg)
    return PoseCheck(
        warnings=tuple(sorted({warning for trial in trials for warning in trial.warnings})),
        energy_j_per_kg=max(trial.energy_j_per_kg for trial in trials),
        beyond_deg=furthest.beyond_deg,
        joint=furthest.joint,
        pose=pose,
    )
