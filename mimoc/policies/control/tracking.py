"""Tracking of a motion by an infant's own actuators, and what the motion demands of a body.

The torque of each joint (computed torque, such as Siciliano et al. 2009, Robotics, 8.5.2) is

    τ = M (q̈* + k_p (q* - q) + k_d (q̇* - q̇)) + h - τ_passive + f tanh(q̇* / v_f)

with the mass matrix M, bias forces h, forces of springs and dampers τ_passive and dry friction f, for a root that does
not accelerate; k_p = (2π b)², k_d = 4π b is a critically damped spring of bandwidth b. It is clipped to what the infant
has. Starred is the motion at the time at which a command takes effect: after the delay of commands to that joint and
the control step within which the activation follows. Until a command acts, a copy of the state is simulated with those
that are on their way; in the control step after that, joints are taken to move on at their speed then.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt
from scipy.optimize import nnls

from mimoc.base.units import ms_to_s
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.policies.control.actuators import Plant
from mimoc.policies.control.forward_model import ForwardModel
from mimoc.runtime.delays import timing_of
from mimoc.runtime.sense import FloatArray, IntArray

BANDWIDTH_HZ, ROOT_BANDWIDTH_HZ = 2.5, 5.0
"""Bandwidth of the feedback of joints, and of the trunk where that is assisted (a choice)."""
FRICTION_RAD_S = 0.05  # Speed v_f above which dry friction counts as whole.


@dataclass(frozen=True, slots=True)
class Wanted:
    """Where an infant is to be at a time: whole configuration, velocity and acceleration of its model."""

    qpos: FloatArray  # Shape (nq,).
    qvel: FloatArray  # Shape (nv,).
    qacc: FloatArray  # Shape (nv,).


class MovedBody(Plant):
    """An infant whose limbs and whose root follow a motion."""

    def __init__(self, model: mujoco.MjModel, manifest: Manifest):
        """Bind to a model; raise a ControlError if the infant has servos."""
        super().__init__(model, manifest)
        limbs = {"arms": manifest.anatomy.arms, "legs": manifest.anatomy.legs}
        self.of_limbs = {name: self._moving([limb.root for limb in each_side]) for name, each_side in limbs.items()}
        """Which joints move arms, and which legs, shape (n,)."""
        self.root = model.body(manifest.root_body).id
        first = model.body_dofadr[self.root]
        self.root_speeds = np.arange(first, first + model.body_dofnum[self.root])
        """Where the velocity of the root stands, shape (6,); empty if it is held."""
        self.is_own: npt.NDArray[np.bool_] = model.body_rootid == model.body_rootid[self.root]

    def _moving(self, roots: Sequence[str]) -> npt.NDArray[np.bool_]:
        bodies = in_subtrees(self.model, [self.model.body(root).id for root in roots])
        return bodies[self.model.jnt_bodyid[self.joints.joints]]

    def needed(self, acceleration: FloatArray, direction: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the forces that bring an acceleration about where nothing touches, and the limits of those there are.

        Actuators are brought to rest first. The forces of all degrees of freedom have shape (nv,), the limits of the
        joints' torques shape (n, 2), [N m]. Dry friction acts against speeds *direction*, shape (nv,).
        """
        model, data = self.model, self.data
        limits_nm = self.rest()
        force = np.zeros(model.nv)
        mujoco.mj_mulM(model, data, force, acceleration)
        force += data.qfrc_bias - data.qfrc_passive - data.qfrc_actuator
        force += model.dof_frictionloss * np.tanh(direction / FRICTION_RAD_S)
        return force, limits_nm

    def root_inertia(self) -> FloatArray:
        """Return the inertia of the root while its joints are loose, the inverse of its part of M⁻¹, shape (6, 6)."""
        unit = np.zeros((self.root_speeds.size, self.model.nv))
        unit[np.arange(len(unit)), self.root_speeds] = 1.0
        mobility = np.zeros_like(unit)
        mujoco.mj_solveM(self.model, self.data, mobility, unit)
        return np.asarray(np.linalg.inv(mobility[:, self.root_speeds]), np.float64)

    @property
    def touches(self) -> npt.NDArray[np.intp]:
        """Bodies of the present contacts with at least one part of the infant, shape (contacts, 2)."""
        bodies = self.model.geom_bodyid[self.data.contact.geom[self.data.contact.dist <= 0.0]].reshape(-1, 2)
        return bodies[self.is_own[bodies].any(axis=1)]


class Tracker:
    """Returns the action that follows a motion in the present state, at each control step."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, manifest: Manifest):
        """Bind to an infant with motors or muscles, or raise a ControlError; each call reads *data*."""
        self._observed, self._body = data, MovedBody(model, manifest)
        self._forward = ForwardModel(model, self._body.actuators, timing_of(manifest, {}))
        self._step_s = ms_to_s(manifest.step_ms)
        self.leads_s = self._leads_s()
        """Time after which what is commanded takes effect in each degree of freedom, shape (nv,)."""
        stiffness = np.full(model.nv, (2.0 * np.pi * BANDWIDTH_HZ) ** 2)
        stiffness[self._body.root_speeds] = (2.0 * np.pi * ROOT_BANDWIDTH_HZ) ** 2
        self._stiffness = stiffness
        self._damping = 2.0 * np.sqrt(stiffness)
        self._resting = ~(self._body.of_limbs["arms"] | self._body.of_limbs["legs"])
        """Joints of trunk and head, whose weight the ground carries while the infant touches anything."""

    def _leads_s(self) -> FloatArray:
        """Return a control step, and the delay of commands to each joint; a wrench at the root acts at once."""
        model = self._body.model
        leads_s = np.full(model.nv, self._step_s)
        moved = model.jnt_dofadr[model.actuator_trnid[self._body.actuators, 0]]
        leads_s[moved] += model.opt.timestep * self._forward.delay_steps
        return leads_s

    def begin(self) -> None:
        """Begin an episode, in which no command is on its way."""
        self._forward.forget()

    def __call__(self, wanted: Wanted) -> npt.NDArray[np.float32]:
        """Return the action, shape (nu,), for the motion when it takes effect: of each speed, `leads_s` from now."""
        forward = self._forward
        action = np.zeros(len(self._body.actuators), np.float32)
        for _, ahead, beginning in forward.foresee(self._observed, forward.longest + 1):
            if beginning:
                action[beginning.commands] = self._action(ahead, wanted)[beginning.commands]
                ahead.ctrl[beginning.actuators] = action[beginning.commands]
        forward.send(action.astype(np.float64))
        return action

    def _action(self, ahead: mujoco.MjData, wanted: Wanted) -> npt.NDArray[np.float32]:
        body = self._body
        body.look(ahead)
        model, data, speeds = body.model, body.data, body.joints.dofs
        if not body.is_finite:
            body.rest()
            self._given_nm = np.zeros(len(speeds))
            return body.action(self._given_nm)
        moving = np.zeros(model.nv)
        moving[speeds] = (wanted.qacc + self._feedback(wanted))[speeds]
        forces, limits_nm = body.needed(moving, wanted.qvel)
        torques_nm = forces[speeds]
        if len(body.touches):
            torques_nm = torques_nm - np.where(self._resting, data.qfrc_bias[speeds], 0.0)
        self._given_nm = np.clip(torques_nm, *limits_nm.T)
        return body.action(self._given_nm)

    def assistance(self, wanted: Wanted) -> FloatArray:
        """Return the wrench that lets the root follow, too, when the latest action is taken, shape (6,).

        The torques of that action, or those that act if it is late, and contacts accelerate the root by a; the wrench
        accelerates it by what is missing,

            w = S (q̈* + k_p (q* - q) + k_d (q̇* - q̇) - a),  [N] in the world's frame and [N m] in the body's,

        with the root's inertia S while its joints are loose. A root that is held gets none, shape (0,).
        """
        body = self._body
        model, data, root = body.model, body.data, body.root_speeds
        if not root.size or not body.is_finite:
            return np.zeros(root.size)
        if self._forward.longest:
            body.look(self._observed)
        demanded = wanted.qacc + self._feedback(wanted)
        if not self._forward.longest:
            data.qfrc_applied[body.joints.dofs] = self._given_nm
            mujoco.mj_forward(model, data)
        return body.root_inertia() @ (demanded - data.qacc)[root]

    def _feedback(self, wanted: Wanted) -> FloatArray:
        model, data = self._body.model, self._body.data
        coming, errors = data.qpos.copy(), np.zeros(model.nv)
        mujoco.mj_integratePos(model, coming, data.qvel, self._step_s)
        mujoco.mj_differentiatePos(model, errors, 1.0, coming, wanted.qpos)
        return self._stiffness * errors + self._damping * (wanted.qvel - data.qvel)


class Demand:
    """The torques that a motion demands of a body, frame by frame, along the motion itself, however it was followed."""

    def __init__(self, model: mujoco.MjModel, manifest: Manifest):
        self._body = body = MovedBody(with_margin(model), manifest)
        self._distal = np.stack([in_subtrees(model, [int(model.jnt_bodyid[joint])]) for joint in body.joints.joints])
        self.shares: list[FloatArray] = []
        """Torque needed of each joint over what the infant has in that state and direction, shape (n,) each; NaN where
        something touches the limb, so that it is not known what it carries."""
        self.wrenches: list[FloatArray] = []
        """The part of the wrench at the free root that no contact gives, shape (6,) each, [N] and [N m]."""

    def add(self, wanted: Wanted) -> FloatArray:
        """Add a frame; return what no contact gives of the wrench at its root, shape (6,), or (0,) if that is held."""
        body = self._body
        model, data, root = body.model, body.data, body.root_speeds
        data.qpos[:], data.qvel[:], data.act[:] = wanted.qpos, wanted.qvel, 0.0
        mujoco.mj_forward(model, data)
        torques_nm, limits_nm = body.needed(wanted.qacc, wanted.qvel)
        available_nm = np.abs(np.where(torques_nm[body.joints.dofs] > 0.0, limits_nm[:, 1], limits_nm[:, 0]))
        shares = np.abs(torques_nm[body.joints.dofs]) / np.maximum(available_nm, np.finfo(float).tiny)
        shares[self._touched(body.touches)] = np.nan
        self.shares.append(shares)
        wrench = torques_nm[root]
        self.wrenches.append(unsupported(model, data, body.is_own, body.root, wrench) if root.size else wrench)
        return self.wrenches[-1]

    def _touched(self, touches: IntArray) -> npt.NDArray[np.bool_]:
        """Return on which joints something hangs that touches anything else, shape (n,)."""
        first, second = self._distal[:, touches[:, 0]], self._distal[:, touches[:, 1]]
        return (first != second).any(axis=1)


NEAR_M = 0.01
"""Distance within which a part of the body counts as touching: what fits of one camera leave open (a choice)."""
ARM_M = 0.1  # Lever at which torques are weighed as forces, about half an infant's trunk (a choice).


def with_margin(model: mujoco.MjModel, near_m: float = NEAR_M) -> mujoco.MjModel:
    """Return a copy of a model that lists contacts from this distance on."""
    copied = model.__copy__()
    copied.geom_margin[:] = np.maximum(copied.geom_margin, near_m)
    return copied


def unsupported(
    model: mujoco.MjModel, data: mujoco.MjData, is_own: npt.NDArray[np.bool_], root: int, wrench: FloatArray
) -> FloatArray:
    """Return what is left over of a wrench, shape (6,), on a body in a model `with_margin`, with contacts.

    Its force is in the world's frame [N], its torque in the body's [N m], about its origin.
    """
    pushes = _pushes(model, data, is_own, root)
    if not len(pushes):
        return wrench
    scales = np.repeat([1.0, 1.0 / ARM_M], 3)
    sizes, _ = nnls(pushes.T * scales[:, None], wrench * scales, maxiter=50 * len(pushes))
    return wrench - sizes @ pushes


def _pushes(model: mujoco.MjModel, data: mujoco.MjData, is_own: npt.NDArray[np.bool_], root: int) -> FloatArray:
    """Return the wrench of a force of 1 N along each edge of each friction pyramid, shape (4 contacts, 6)."""
    contacts = data.contact
    ours = is_own[model.geom_bodyid[contacts.geom]]
    outside = ours[:, 0] != ours[:, 1]
    frames = contacts.frame[outside].reshape(-1, 3, 3)
    second = ours[outside, 1]
    normals = frames[:, 0] * np.where(second, 1.0, -1.0)[:, None]
    friction = contacts.friction[outside, :1]
    edges = np.stack([normals + way * friction * frames[:, axis] for axis in (1, 2) for way in (-1, 1)], axis=1)
    arms_m = (contacts.pos[outside] - data.xpos[root])[:, None]
    torques = np.cross(arms_m, edges) @ data.xmat[root].reshape(3, 3)  # In the body's frame.
    return np.concatenate([edges, torques], axis=2).reshape(-1, 6)
