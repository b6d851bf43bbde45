"""A ball whose size and mass are drawn anew for each episode."""

import mujoco
import numpy as np

from mimoc.model_fields import ModelField
from mimoc.tasks.base import BallEntry

SOLID_SPHERE = 2 / 5
"""Moment of inertia of a solid sphere, by mass and squared radius."""

WORLD = 0
"""The body that everything hangs on."""


class ResizableBall:
    """A sphere of a model that takes any radius and mass, with all that MuJoCo's compiler derives from them."""

    def __init__(self, entry: BallEntry, model: mujoco.MjModel):
        """Find the ball in *model*, which it changes."""
        joint = model.joint(entry.joint)
        self._model = model
        self.body, self.geom = model.body(entry.body).id, model.geom(entry.geom).id
        self.place = joint.qposadr[0] + np.arange(3)
        """Where its place stands in qpos, shape (3,)."""
        self._speeds = joint.dofadr[0] + np.arange(6)
        first = model.body_bvhadr[self.body]
        self._boxes = first + np.arange(model.body_bvhnum[self.body])

    @property
    def radius_m(self) -> float:
        """Its radius."""
        return float(self._model.geom_size[self.geom, 0])

    @property
    def mass_kg(self) -> float:
        """Its mass."""
        return float(self._model.body_mass[self.body])

    @property
    def model_fields(self) -> tuple[ModelField, ...]:
        """What `change` changes in the model."""
        body, geom, turning = np.array([self.body]), np.array([self.geom]), self._speeds[3:]
        return (
            *(ModelField(name, geom) for name in ("geom_size", "geom_rbound", "geom_aabb")),
            ModelField("bvh_aabb", self._boxes),
            *(ModelField(name, body) for name in ("body_mass", "body_inertia", "body_invweight0")),
            ModelField("body_subtreemass", np.array([WORLD, self.body])),
            ModelField("dof_length", turning),
            *(ModelField(name, self._speeds) for name in ("dof_M0", "dof_invweight0")),
        )

    def change(self, radius_m: float, mass_kg: float) -> None:
        """Give it another radius and mass."""
        model, body, geom = self._model, self.body, self.geom
        inertia_kgm2 = SOLID_SPHERE * mass_kg * radius_m**2
        model.geom_size[geom, 0] = model.geom_rbound[geom] = radius_m
        model.geom_aabb[geom, 3:] = model.bvh_aabb[self._boxes, 3:] = radius_m
        model.body_mass[body] = model.body_subtreemass[body] = mass_kg
        model.body_subtreemass[WORLD] = model.body_mass.sum()
        model.body_inertia[body] = inertia_kgm2
        model.body_invweight0[body] = 1 / mass_kg, 1 / inertia_kgm2
        model.dof_length[self._speeds[3:]] = radius_m
        model.dof_M0[self._speeds] = weights = np.repeat([mass_kg, inertia_kgm2], 3)
        model.dof_invweight0[self._speeds] = 1 / weights
