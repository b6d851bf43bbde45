"""Dynamics: the accelerations that an infant's joint torques cause, given its supports.

With the mass matrix M, the bias forces h and the Jacobian J_c of the supports, the constrained equations of motion

    M q̈ + h = τ + J_cᵀ λ,   J_c q̈ = 0   (Mistry & Righetti 2012, without J̇_c q̇, as supports are at rest)

are solved in coordinates in which M is the identity: a row j of a Jacobian becomes y = D^-½ L^-ᵀ j with M = Lᵀ D L, so
that j M⁻¹ j'ᵀ = y y'ᵀ, and constraints remove the component of each y in the span of their own rows.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.control.priorities import LinearDemand, fulfil, product
from mimoc.senses.sense import FloatArray, IntArray

REDUNDANT = 1e-9
"""Relative size below which a constraint counts as redundant, as when a body has many contact points."""


@dataclass(frozen=True, slots=True)
class Dynamics:
    """The dynamics in one state, in coordinates in which the mass matrix is the identity."""

    model: mujoco.MjModel
    data: mujoco.MjData
    scales: FloatArray
    """D^-½, shape (1, nv)."""
    torques: FloatArray
    """Acceleration per torque of each joint without supports, shape (n, nv)."""
    free_torques: FloatArray
    """Acceleration per torque of each joint with supports, shape (n, nv)."""
    drift: FloatArray
    """Acceleration without any torque, shape (nv,)."""

    def response(self, jacobian: FloatArray, strength_nm: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the accelerations of m velocities.

        Args:
            jacobian: Jacobian of the velocities, shape (m, nv).
            strength_nm: Largest torque of each joint, shape (n,).

        Returns:
            Accelerations at full strength of each joint, with and without supports, shape (m, n) each, and without any
            torque, shape (m,).
        """
        rows = halved(self.model, self.data, self.scales, jacobian)
        return rows @ self.free_torques.T * strength_nm, rows @ self.torques.T * strength_nm, rows @ self.drift

    def joint_response(self) -> tuple[FloatArray, FloatArray]:
        """Return the accelerations of the joints that torques act on, shapes (n, n) and (n,)."""
        return product(self.torques, self.free_torques), self.torques @ self.drift

    def unheld_response(self) -> FloatArray:
        """Return the acceleration of each joint per unit of its torque without supports, shape (n,), [1/(kg m²)]."""
        return np.einsum("ij,ij->i", self.torques, self.torques)


def dynamics(model: mujoco.MjModel, data: mujoco.MjData, speeds: IntArray, supports: FloatArray) -> Dynamics:
    """Return the dynamics in the present state.

    Args:
        model: The infant and its world.
        data: Its state after `mj_forward`, with the actuators at rest.
        speeds: Index of the velocity that each torque acts on, shape (n,).
        supports: Jacobian of the supports, shape (m, nv).
    """
    scales = np.sqrt(data.qLDiagInv)[None]
    force = data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias
    count = len(speeds)
    unsolved = np.zeros((count + 1 + len(supports), model.nv))
    unsolved[np.arange(count), speeds] = 1.0
    unsolved[count] = force
    unsolved[count + 1 :] = supports
    rows = halved(model, data, scales, unsolved)
    moved = _unheld(rows[: count + 1], rows[count + 1 :])
    return Dynamics(model, data, scales, rows[:count], moved[:count], moved[count])


def _unheld(moved: FloatArray, held: FloatArray) -> FloatArray:
    """Return the component of motions, shape (n, nv), that the supports, shape (m, nv), allow."""
    sizes = np.sqrt(np.einsum("ij,ij->i", held, held))
    moving = sizes > 0.0  # A weld that leaves rotations free has rows of zeros.
    if not moving.any():
        return moved
    held = held[moving] / sizes[moving, None]
    gram = held @ held.T
    gram.flat[:: len(gram) + 1] += REDUNDANT
    forces = np.asarray(np.linalg.solve(gram, product(held, moved)), np.float64)
    return moved - product(forces.T, held.T)


def halved(model: mujoco.MjModel, data: mujoco.MjData, scales: FloatArray, rows: FloatArray) -> FloatArray:
    """Return rows, shape (m, nv), in coordinates in which the mass matrix is the identity."""
    result = np.empty_like(rows)
    mujoco.mj_solveM2(model, data, result, rows, scales)
    return result


MOST_PASSES = 2
"""Number of passes: torques are computed a second time if joints would not stop in time; more passes gain nothing."""
HELD = 1e-3
"""Ratio of a joint's response with supports to that without, below which it counts as held, such as a locked joint."""
SLACK = 1e-6
"""Tolerance by which a joint may exceed a bound, relative to its response to full strength."""
LEAST_RESPONSE = 1e-9
"""Response to full strength below which a joint counts as having no strength, [rad/s²]."""


@dataclass(frozen=True, slots=True)
class Turning:
    """Accelerations of n joints as a function of their torques (fractions of strength)."""

    response: FloatArray
    """Acceleration of each joint per unit of each torque, shape (n, n), [rad/s²]."""
    drift: FloatArray
    """Acceleration without torques, shape (n,), [rad/s²]."""
    unheld: FloatArray
    """Acceleration of each joint at its own full strength without supports, shape (n,), [rad/s²]."""

    def demand(self, joints: Sequence[int] | IntArray, accelerations: FloatArray) -> LinearDemand:
        """Return a demand for accelerations of some joints, each normalised by its own response.

        Joints that are held by the world are omitted.
        """
        sizes = np.where(self.free[joints], self.unheld[joints], np.inf)
        return LinearDemand(self.response[joints] / sizes[:, None], (accelerations - self.drift[joints]) / sizes)

    @property
    def free(self) -> npt.NDArray[np.bool_]:
        """Mask of the joints that are not held by the world and have some strength, shape (n,)."""
        return self.response.diagonal() > np.maximum(HELD * self.unheld, LEAST_RESPONSE)


def fulfil_within(
    turning: Turning, least: FloatArray, largest: FloatArray, demands: Sequence[LinearDemand], rest: LinearDemand
) -> FloatArray:
    """Return the torques, shape (n,), that fulfil demands as far as all joints stay within their bounds.

    If the torques would move joints beyond their bounds, these bounds become demands of the highest priority.

    Args:
        turning: Response of the joints.
        least: Smallest allowed acceleration of each joint, shape (n,), [rad/s²].
        largest: Largest allowed acceleration of each joint, shape (n,), [rad/s²].
        demands: The demands, the most important first.
        rest: Demand of the lowest priority, for the remaining freedom.
    """
    slack = SLACK * turning.unheld
    free = turning.free
    stopping, stops = np.zeros(len(free), bool), np.zeros(len(free))
    shares = fulfil(demands, rest)
    for _ in range(MOST_PASSES - 1):
        coming = turning.response @ shares + turning.drift
        beyond = free & ~stopping & ((coming > largest + slack) | (coming < least - slack))
        if not beyond.any():
            break
        stops[beyond] = np.clip(coming, least, largest)[beyond]
        stopping |= beyond
        joints = np.flatnonzero(stopping)
        shares = fulfil([turning.demand(joints, stops[joints]), *demands], rest)
    return shares
