"""Water around the legs of an infant that is held upright in it, up to the chest."""

import mujoco
import numpy as np

from mimoc.base.units import GRAVITY_M_S2
from mimoc.runtime.sense import FloatArray
from mimoc.studies.experiments.legs.infants import legs_of

WATER_KG_M3 = 1000.0
LIMB_KG_M3 = 1030.0  # Density of an infant's legs: a fifth fat of 900, the rest of 1065 kg/m³ (derived).
DRAG = 1.0  # Drag coefficient of a cylinder across the stream, at Reynolds numbers of 10³ to 10⁵ (an assumption).
ADDED = 1.0
"""Mass of water that moves along with a cylinder across the stream, by that of the water it displaces (potential flow).
"""


class Water:
    """Forces of water on both legs.

    On a part of mass m and velocity v of its centre of mass act, with r the density of water by that of the leg,

        buoyancy  m g r  upwards, so that its weight in water is m g (1 - r), and
        drag      -½ d c A |v| v,  with the density d of water, and c = DRAG,

    and a = ADDED m r of water moves along with it: a is added to its mass, but has no weight. A is the broadside of the
    box that has its mass and inertia. Water up to the chest covers the legs wholly, whatever they do.
    """

    def __init__(self, model: mujoco.MjModel):
        """Fill in water, which changes the masses in *model*."""
        self._model, self._legs = model, legs_of(model)
        mass_kg = model.body_mass[self._legs].copy()
        displaced_kg = mass_kg * WATER_KG_M3 / LIMB_KG_M3
        self._drag = 0.5 * WATER_KG_M3 * DRAG * broadsides_m2(model, self._legs)
        self._lift_n = (1.0 + ADDED) * displaced_kg * GRAVITY_M_S2
        model.body_mass[self._legs] += ADDED * displaced_kg
        mujoco.mj_setConst(model, mujoco.MjData(model))

    def __call__(self, data: mujoco.MjData) -> None:
        """Set the forces that act until the next call."""
        velocity = np.zeros(6)
        for body, drag, lift_n in zip(self._legs, self._drag, self._lift_n, strict=True):
            mujoco.mj_objectVelocity(self._model, data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 0)
            speed_m_s = velocity[3:]
            data.xfrc_applied[body, :3] = -drag * np.linalg.norm(speed_m_s) * speed_m_s
            data.xfrc_applied[body, 2] += lift_n


def broadsides_m2(model: mujoco.MjModel, bodies: list[int]) -> FloatArray:
    """Return the largest side of the box that has the mass and the inertia of a body, shape (n,)."""
    inertia = model.body_inertia[bodies]
    squares = 6.0 * (inertia.sum(axis=1, keepdims=True) - 2.0 * inertia) / model.body_mass[bodies, None]
    edges_m = np.sort(np.sqrt(np.maximum(squares, 0.0)), axis=1)
    return edges_m[:, 1] * edges_m[:, 2]
