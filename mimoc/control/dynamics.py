"""Dynamics: how the torques of an infant's joints accelerate it, held up by what it sits on.

With M the mass, h what moves it by itself and J_c how it can not move, the equations of motion under constraints

    M q̈ + h = τ + J_cᵀ λ,   J_c q̈ = 0   (Mistry & Righetti 2012, with J̇_c q̇ of supports at rest left out)

are solved in coordinates in which M is the identity: of a row j of a Jacobian, y = D^-½ L^-ᵀ j with M = Lᵀ D L, so that
j M⁻¹ j'ᵀ = y y'ᵀ, and constraints take away the part of each y that lies in the span of their own.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.control.priorities import product
from mimoc.senses.sense import FloatArray, IntArray

REDUNDANT = 1e-9
"""Share of a constraint that counts as following from others: many points of contact hold one body."""


@dataclass(frozen=True, slots=True)
class Dynamics:
    """What torques do at one moment, in coordinates in which the mass is the identity."""

    model: mujoco.MjModel
    data: mujoco.MjData
    scales: FloatArray
    """D^-½, shape (1, nv)."""
    torques: FloatArray
    """What the torque of each joint would do if nothing held the infant, shape (n, nv)."""
    free_torques: FloatArray
    """What it does, shape (n, nv)."""
    drift: FloatArray
    """What happens without any torque, shape (nv,)."""

    def response(self, jacobian: FloatArray, strength_nm: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return how m velocities change.

        Args:
            jacobian: Of the velocities, shape (m, nv).
            strength_nm: Of each joint, shape (n,).

        Returns:
            With the whole strength of each joint, with that if nothing held the infant, shape (m, n) each, and without
            any torque, shape (m,).
        """
        rows = halved(self.model, self.data, self.scales, jacobian)
        return rows @ self.free_torques.T * strength_nm, rows @ self.torques.T * strength_nm, rows @ self.drift

    def joint_response(self) -> tuple[FloatArray, FloatArray]:
        """Return the same for the speeds of the joints that torques act on, shapes (n, n) and (n,)."""
        return product(self.torques, self.free_torques), self.torques @ self.drift

    def unheld_response(self) -> FloatArray:
        """Return what each torque would do to its own joint if nothing held the infant, shape (n,), [1/(kg m²)]."""
        return np.einsum("ij,ij->i", self.torques, self.torques)


def dynamics(model: mujoco.MjModel, data: mujoco.MjData, speeds: IntArray, supports: FloatArray) -> Dynamics:
    """Return what torques do now.

    Args:
        model: The infant and its world.
        data: Up to date, with the actuators at rest.
        speeds: Which velocity each torque acts on, shape (n,).
        supports: How the infant moves against what holds it, shape (m, nv).
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
    """Return the part of some motions, shape (n, nv), that what holds the infant, shape (m, nv), lets happen."""
    sizes = np.sqrt(np.einsum("ij,ij->i", held, held))
    moving = sizes > 0.0  # A weld that leaves turns free has rows of zeros.
    if not moving.any():
        return moved
    held = held[moving] / sizes[moving, None]
    gram = held @ held.T
    gram.flat[:: len(gram) + 1] += REDUNDANT
    forces = np.asarray(np.linalg.solve(gram, product(held, moved)), np.float64)
    return moved - product(forces.T, held.T)


def halved(model: mujoco.MjModel, data: mujoco.MjData, scales: FloatArray, rows: FloatArray) -> FloatArray:
    """Return rows, shape (m, nv), in coordinates in which the mass is the identity."""
    found = np.empty_like(rows)
    mujoco.mj_solveM2(model, data, found, rows, scales)
    return found
