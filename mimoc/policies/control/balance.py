"""Balance: trunk and whole body are turned back to how they stood in a posture, against the vertical."""

from collections.abc import Sequence

import mujoco
import numpy as np

from mimoc.policies.control.infant import DrivenInfant
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.names import SIDES

SPINE = ("hip_bend1", "hip_lean1")  # Driven hinges by which the trunk bends forward and to the side.
ANKLES = tuple(f"{side}_foot1" for side in SIDES)  # Those by which feet tip forward.
RATE_S, LEAN_RATE_S = 0.1, 0.2
"""Time over which the rotation of the trunk, and that of the body over its feet, are foreseen (a choice; the second was
fitted to standing at 11 to 15 months)."""


class Balance:
    """Turns hinges of an infant so that it tilts as it does in a posture.

    With the trunk's tilt e beyond that, and its angular velocity w, each hinge of the spine turns by the part of
    -(e + T w) about its axis: its muscles answer to what the vestibular sense tells of the trunk, and not to the angle
    between trunk and legs, which changes with the ground. On its feet, ankles do the opposite with the tilt of the line
    from the feet to the centre of mass: they press down the side to which the infant leans (the ankle strategy; Horak &
    Nashner 1986).
    """

    def __init__(self, infant: DrivenInfant, start: mujoco.MjData, on_feet: bool = False):
        """Bind it to a posture, with all that is derived from it; *on_feet* is whether it stands."""
        self._infant = infant
        self._trunk = infant.pushed
        self._spine = _slots(infant, SPINE)
        self._ankles = _slots(infant, ANKLES if on_feet else ())
        self._feet = [infant.body(f"{side}_foot") for side in SIDES] if on_feet else []
        self.keep(start)

    def keep(self, state: mujoco.MjData) -> None:
        """Take the tilt in a state as the one to keep."""
        facing = _in_heading(state.xmat[self._trunk].reshape(3, 3))
        self._up = facing @ state.xmat[self._trunk].reshape(3, 3)[:, 2]
        if self._feet:
            self._line = facing @ self._from_feet(state)[0]

    def __call__(self, state: mujoco.MjData) -> FloatArray:
        """Return by how much hinges turn in a state, shape (n,), [rad]."""
        infant = self._infant
        orientation = state.xmat[self._trunk].reshape(3, 3)
        to_world = _in_heading(orientation).T
        turns_rad = np.zeros(len(infant.joints))
        error_rad = _cross(orientation[:, 2], to_world @ self._up)
        velocity_rad_s = state.cvel[self._trunk, :3] * (1.0, 1.0, 0.0)
        turns_rad[self._spine] = state.xaxis[infant.joints[self._spine]] @ (error_rad - RATE_S * velocity_rad_s)
        if self._feet:
            line, length_m = self._from_feet(state)
            error_rad = _cross(line, to_world @ self._line)
            mujoco.mj_subtreeVel(infant.model, state)
            velocity_rad_s = _cross(line, state.subtree_linvel[infant.root]) / length_m
            error_rad -= LEAN_RATE_S * velocity_rad_s
            turns_rad[self._ankles] = -(state.xaxis[infant.joints[self._ankles]] @ error_rad)
        return turns_rad

    def _from_feet(self, state: mujoco.MjData) -> tuple[FloatArray, float]:
        """Return the direction from the middle of the feet to the centre of mass, shape (3,), and its distance [m]."""
        away_m = state.subtree_com[self._infant.root] - state.xpos[self._feet].mean(axis=0)
        length_m = float(np.linalg.norm(away_m))
        return away_m / length_m, length_m


def _slots(infant: DrivenInfant, names: Sequence[str]) -> IntArray:
    present = [infant.joint_names.index(name) for name in names if name in infant.joint_names]
    return np.array(present, np.intp)


def _cross(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the cross product of two vectors, ten times as fast as NumPy does."""
    product = np.empty(3)
    mujoco.mju_cross(product, first.copy(), second.copy())
    return product


def _in_heading(orientation: FloatArray) -> FloatArray:
    """Return the rotation about the vertical, shape (3, 3), from the world to a frame whose x axis a body faces."""
    leftward = orientation[:, 1] * (1.0, 1.0, 0.0)
    leftward /= max(float(np.linalg.norm(leftward)), 1e-9)
    return np.array([[leftward[1], -leftward[0], 0.0], leftward, [0.0, 0.0, 1.0]])
