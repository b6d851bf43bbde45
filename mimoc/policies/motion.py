"""A policy that follows a motion, such as that of a filmed infant, by the infant's actuators within its strength."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import MimocError, check_name
from mimoc.base.units import GRAVITY_M_S2, ms_to_s
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import physics_of, set_physics
from mimoc.motion.joint_motion import JointMotion, States, read_motion
from mimoc.policies.control.tracking import Demand, MovedBody, Tracker, Wanted
from mimoc.policies.policy import begin_here
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import FloatArray, Observation

PLACE, TURN = slice(0, 3), slice(3, 6)  # Linear and angular part of an error, velocity or wrench of the root.


@dataclass(frozen=True)
class Followed:
    """A motion that was followed over t control steps by an infant with n joints that actuators move."""

    body: MovedBody
    manifest: Manifest
    errors_rad: FloatArray  # Errors of joint angles, shape (t, n).
    root_errors: FloatArray  # Errors of the root's place [m] and orientation [rad], shape (t, 6); (t, 0) if it is held.
    applied: FloatArray  # Force [N] and torque [N m] that were applied at the root, shape (t, 6).
    demand: Demand
    headings = "joint", "error [°]", "torque needed / available", "95th percentile", "above 1", "known"
    """Headings of the columns of `rows`."""

    def metrics(self) -> dict[str, float]:
        """Return the numbers of a run, by name with unit; those of which there is nothing are left out."""
        if not len(self.errors_rad):
            return {}
        shares = np.array(self.demand.shares)
        metrics = dict(_of_joints("", self.errors_rad, shares))
        for group, members in self._groups():
            if members.any():
                metrics |= _of_joints(f"{group}_", self.errors_rad[:, members], shares[:, members])
        if self.root_errors.shape[1]:
            metrics |= self._of_root()
        return metrics

    def rows(self) -> list[tuple[str, ...]]:
        """Return a row for each joint.

        It has the joint's name, its error, the torque that it needs over what it has, median and 95th percentile, the
        share of the time that this is above 1, and the share of the time that it is known.
        """
        rows = list[tuple[str, ...]]()
        shares = np.array(self.demand.shares)
        for joint, name in enumerate(self.body.joints.names):
            error = f"{_rms_deg(self.errors_rad[:, joint]):.1f}"
            known = shares[:, joint][np.isfinite(shares[:, joint])]
            median, p95, above = "-", "-", "-"
            if known.size:
                median, p95 = (f"{share:.2f}" for share in np.percentile(known, (50, 95)))
                above = f"{100 * (known > 1).mean():.0f} %"
            rows.append((name, error, median, p95, above, f"{100 * known.size / len(shares):.0f} %"))
        return rows

    def _groups(self) -> Iterator[tuple[str, npt.NDArray[np.bool_]]]:
        """Yield which joints are reported together: those of both arms, of both legs, and each group of the midline."""
        yield from self.body.of_limbs.items()
        is_limbs = np.any([*self.body.of_limbs.values()], axis=0)
        for group, joints in self.manifest.anatomy.groups.items():
            names_in_group = [*map(self.manifest.of_infant, joints)]
            members = np.array([name in names_in_group for name in self.body.joints.names], bool)
            if not (members & is_limbs).any():
                yield group, members

    def _of_root(self) -> dict[str, float]:
        """Return the drift of the trunk, the wrench that it needs, and the wrench that was applied."""
        model = self.body.model
        weight_n = GRAVITY_M_S2 * float(model.body_subtreemass[self.body.root])
        away_m, turned_rad = (np.linalg.norm(self.root_errors[:, part], axis=1) for part in (PLACE, TURN))
        metrics = {
            "drift_m": float(away_m.max()),
            "drift_end_m": float(away_m[-1]),
            "turned_deg": float(np.degrees(turned_rad.max())),
        }
        for name, wrenches in (("wrench", np.array(self.demand.wrenches)), ("assisted", self.applied)):
            if not wrenches.any():
                continue
            force_n, torque_nm = (np.linalg.norm(wrenches[:, part], axis=1) for part in (PLACE, TURN))
            for label, percent in (("median", 50), ("p95", 95)):
                metrics[f"{name}_force_{label}_n"] = round(float(np.percentile(force_n, percent)), 9)
                metrics[f"{name}_force_{label}_weights"] = round(float(np.percentile(force_n, percent)) / weight_n, 9)
                metrics[f"{name}_torque_{label}_nm"] = round(float(np.percentile(torque_nm, percent)), 9)
        return metrics


def _of_joints(prefix: str, errors_rad: FloatArray, shares: FloatArray) -> Iterator[tuple[str, float]]:
    yield f"{prefix}error_deg", _rms_deg(errors_rad)
    known = shares[np.isfinite(shares)]
    if known.size:
        yield f"{prefix}torque_needed_median", float(np.median(known))
        yield f"{prefix}torque_needed_p95", float(np.percentile(known, 95))
        yield f"{prefix}torque_above_share", float((known > 1.0).mean())


def _rms_deg(errors_rad: FloatArray) -> float:
    return float(np.degrees(np.sqrt(np.mean(errors_rad**2))))


Root = Literal["free", "assisted"]
"""Whether the trunk moves as the ground and the limbs let it, or a wrench at the root makes it follow, too."""


class MotionPolicy:
    """Follows a motion from its first frame on, until it ends.

    The motion takes place where it was recorded; in a world with others, where the infant is, and faces as it does.
    """

    def __init__(self, env: Infant, motion: JointMotion, root: Root = "free"):
        """Bind a motion to an infant with motors or muscles and all its joints; *root* may be `assisted` by a wrench.

        Raises a ControlError for servos, and a MimocError if a joint is missing, or the motion is shorter than a
        control step.
        """
        check_name("way for the root to move", root, get_args(Root))
        self._env = env
        self._motion = motion
        self._root = root
        self.whole_steps = int(motion.seconds / ms_to_s(env.manifest.step_ms) + 1e-6)
        """Control steps of the motion, and of a run that follows all of it; after them, the infant holds the last."""
        if not self.whole_steps:
            raise MimocError("the motion is shorter than a control step; take a longer recording")
        self._logged = list[FloatArray](), list[FloatArray](), list[FloatArray]()  # As the arrays of `Followed`.
        if env.manifest.prefix and motion.free:
            angles, _ = motion.places(env.model, env.manifest.prefix)
            self._motion = motion.moved_to(env.data.qpos[angles])
        self._bind()

    def __call__(self, generator: np.random.Generator, observation: Observation) -> npt.NDArray[np.float32]:
        """Return the action; it depends neither on the generator nor on the observation."""
        env = self._env
        if env.model is not self._model:
            self._bind()  # The scene has changed.
        if env.steps == 0:
            self._begin()
        coming = self._at(self._coming, env.steps)
        action = self._tracker(coming)
        if self._root == "assisted":
            model, data = self._model, self._env.data
            data.qfrc_applied[self._body.root_speeds] = self._tracker.assistance(coming)
            set_physics(model, data, physics_of(model, data))
        if env.steps < self.whole_steps:
            now = self._at(self._present, env.steps)
            self._demand.add(now)
            self._log(now)
        return action

    def metrics(self) -> Mapping[str, float]:
        """Return how well the motion was followed, and what it demands; docs/replay.md says what each number is."""
        return self.followed.metrics()

    @property
    def followed(self) -> Followed:
        """The motion as it was followed so far, for tables."""
        errors_rad, root_errors, applied = (np.array(rows) for rows in self._logged)
        return Followed(self._body, self._env.manifest, errors_rad, root_errors, applied, self._demand)

    def _bind(self) -> None:
        env = self._env
        self._model = env.model
        self._step_s = ms_to_s(env.manifest.step_ms)
        self._places = self._motion.places(env.model, env.manifest.prefix)
        self._tracker = Tracker(env.model, env.data, env.manifest)
        self._body = MovedBody(env.model, env.manifest)
        self._demand = Demand(env.model, env.manifest)
        self._rest = env.data.qpos.copy()
        self._present = self._motion.at(self._times_s(0.0))
        self._coming = self._states_when_acted()

    def _times_s(self, lead_s: float) -> FloatArray:
        """Return when all control steps of the motion and the one after it begin, each plus *lead_s*."""
        return np.asarray(self._step_s * (np.arange(self.whole_steps + 2) + lead_s / self._step_s), np.float64)

    def _states_when_acted(self) -> States:
        """Return the motion at each control step when its commands take effect, each joint after its own delay."""
        model, leads_s = self._model, self._tracker.leads_s
        angles, speeds = self._places
        first_dofs = np.empty(model.nq, np.intp)  # First degree of freedom of the joint of each number in qpos.
        for joint in range(model.njnt):
            first_dofs[model.jnt_qposadr[joint] :] = model.jnt_dofadr[joint]
        angle_leads_s = leads_s[first_dofs[angles]]
        speed_leads_s = leads_s[speeds]
        first_lead_s, *other_leads_s = np.unique(speed_leads_s).tolist()
        coming = self._motion.at(self._times_s(first_lead_s))
        for lead_s in other_leads_s:
            later = self._motion.at(self._times_s(lead_s))
            late_angles = angle_leads_s == lead_s
            late_speeds = speed_leads_s == lead_s
            coming.qpos[:, late_angles] = later.qpos[:, late_angles]
            coming.qvel[:, late_speeds] = later.qvel[:, late_speeds]
            coming.qacc[:, late_speeds] = later.qacc[:, late_speeds]
        return coming

    def _at(self, states: States, step: int) -> Wanted:
        """Return the state after *step* control steps, or the last one; joints that the motion lacks are at rest."""
        angles, speeds = self._places
        step = min(step, len(states.qpos) - 1)
        wanted = Wanted(self._rest.copy(), np.zeros(self._model.nv), np.zeros(self._model.nv))
        wanted.qpos[angles] = states.qpos[step]
        wanted.qvel[speeds] = states.qvel[step]
        wanted.qacc[speeds] = states.qacc[step]
        return wanted

    def _begin(self) -> None:
        """Put the infant where the motion begins, lifted out of the ground, and let its senses begin there."""
        self._tracker.begin()
        model, data = self._model, self._env.data
        self._rest = data.qpos.copy()
        first = self._at(self._present, 0)
        angles, _ = self._places
        data.qpos[angles] = first.qpos[angles]
        is_own = self._body.is_own[model.dof_bodyid]
        data.qvel[is_own] = first.qvel[is_own]
        mujoco.mj_forward(model, data)
        data.qpos[angles] += self._lift()
        begin_here(self._env)

    def _lift(self) -> FloatArray:
        """Return what to add to the configuration to raise the infant out of the ground by its deepest contact.

        The ground is whatever cannot move. If the motion has no free joint, nothing is added.
        """
        model, data = self._model, self._env.data
        angles, _ = self._places
        lift = np.zeros(len(angles))
        bodies = model.geom_bodyid[data.contact.geom]
        is_still = model.body_weldid[bodies] == 0
        is_own = self._body.is_own[bodies]
        depths_m = -data.contact.dist[is_still.any(axis=1) & is_own.any(axis=1)]
        if self._motion.free and depths_m.size:
            lift[2] = max(float(depths_m.max()), 0.0)
        return lift

    def _log(self, wanted: Wanted) -> None:
        joint_errors, root_errors, applied = self._logged
        errors = np.zeros(self._model.nv)
        mujoco.mj_differentiatePos(self._model, errors, 1.0, wanted.qpos, self._env.data.qpos)
        joint_errors.append(errors[self._body.joints.dofs])
        root_errors.append(errors[self._body.root_speeds])
        applied.append(self._env.data.qfrc_applied[self._body.root_speeds].copy())


def bind(env: Infant, text: str, root: Root = "free") -> MotionPolicy:
    """Return the policy that follows the motion at the path *text*; see `MotionPolicy`.

    Raises:
        MimocError: If there is no motion there, and as `MotionPolicy` does.
    """
    if not text:
        raise MimocError("say which motion to follow: --policy motion:DIR, the folder that 'mimoc retarget' wrote")
    return MotionPolicy(env, read_motion(Path(text).expanduser()), root)
