"""Catching: hold a ball that falls on the open hand; its size and mass are drawn anew for each episode."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.components.tasks.catch import CatchEntry
from mimoc.runtime.actuation import bind_actuation
from mimoc.runtime.model_fields import ModelField
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.runtime.task import Judgement, Task
from mimoc.runtime.term import Term
from mimoc.runtime.worlds import Worlds
from mimoc.schema.task import BallEntry

SOLID_SPHERE = 2 / 5  # Moment of inertia of a solid sphere, by mass and squared radius.

WORLD = 0  # The body that everything hangs on.


class ResizableBall:
    """A sphere of a model that takes any radius and mass, with all that MuJoCo's compiler derives from them."""

    def __init__(self, entry: BallEntry, model: mujoco.MjModel):
        joint = model.joint(entry.joint)
        self._model = model
        self.body, self.geom = model.body(entry.body).id, model.geom(entry.geom).id
        self.place = joint.qposadr[0] + np.arange(3)
        """Where its place stands in qpos, shape (3,)."""
        self._speeds = joint.dofadr[0] + np.arange(6)
        first = model.body_bvhadr[self.body]
        self._boxes = first + np.arange(model.body_bvhnum[self.body])

    @property
    def model_fields(self) -> tuple[ModelField, ...]:
        """What `change` changes in the model."""
        body = np.array([self.body])
        geom = np.array([self.geom])
        turning = self._speeds[3:]
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


NEITHER, HAND, BALL = -1, 0, 1  # What geoms belong to.


@dataclass(frozen=True)
class Catch(Term):
    """Contact of hand and ball is rewarded, effort costs, and the episode ends with the ball held or lost.

    The ball is lost when it is well below the palm, or well to its side.
    """

    palm: int
    ball: int
    part_of_geom: IntArray  # `HAND`, `BALL` or `NEITHER`, shape (ngeom,).
    palm_m: FloatArray  # The point that the ball falls onto, in the frame of the palm's body, shape (3,).
    lost_m: float
    held_steps: int
    contact_reward: float
    effort_weight: float
    success_reward: float
    effort: Term

    def __call__(self, worlds: Worlds, action: Any, memory: Any) -> Judgement:
        """Return the judgement of k infants that have `held` the ball for some steps."""
        xp = worlds.xp
        is_touching = worlds.pressing(self.part_of_geom)[:, HAND, BALL]
        held = xp.where(is_touching, memory["held"] + 1, 0)
        offset_m = worlds.xpos[:, self.ball, :] - self.palm_place_m(worlds)
        is_away = (offset_m[:, 2] < -self.lost_m) | (xp.hypot(offset_m[:, 0], offset_m[:, 1]) > self.lost_m)
        is_caught = held >= self.held_steps
        is_lost = is_away & ~is_caught
        terms = {
            "contact": xp.where(is_touching, self.contact_reward, 0.0),
            "effort": -self.effort_weight * self.effort(worlds),
            "catch": xp.where(is_caught, self.success_reward, 0.0),
            "loss": xp.where(is_lost, -self.success_reward, 0.0),
        }
        return Judgement(terms, success=is_caught, terminated=is_caught | is_lost, memory={"held": held})

    def palm_place_m(self, worlds: Worlds) -> Any:
        """Return where the palms are in the world, shape (k, 3), [m]."""
        turned_m = worlds.xp.sum(worlds.xmat[:, self.palm, :, :] * self.palm_m[:, None, :], axis=-1)
        return worlds.xpos[:, self.palm, :] + turned_m


class CatchTask(Task):
    """A ball over the palm, of another size and mass in each episode."""

    def __init__(self, entry: CatchEntry, model: mujoco.MjModel, bundle: Bundle):
        self._entry = entry
        self._model = model
        self._ball = ResizableBall(entry.ball, model)
        is_hand = np.isin(model.geom_bodyid, [model.body(name).id for name in entry.hand])
        part_of_geom = np.where(is_hand, HAND, NEITHER)
        part_of_geom[self._ball.geom] = BALL
        effort = bind_actuation(bundle.manifest.actuation, model).effort
        amounts = entry.lost_m, entry.held_steps, entry.contact_reward, entry.effort_weight, entry.success_reward
        palm, palm_m = model.body(entry.palm).id, np.array(entry.palm_m)
        term = Catch(palm, self._ball.body, part_of_geom, palm_m, *amounts, effort)
        super().__init__(entry.steps, term, {"held": 0})

    @property
    def model_fields(self) -> Sequence[ModelField]:
        """Size and mass of the ball."""
        return self._ball.model_fields

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Hang a ball of some size and mass at some height over the palm; it falls with the first step."""
        entry, ball = self._entry, self._ball
        radius_m, mass_kg, drop_m = (generator.uniform(*ends) for ends in (entry.radius_m, entry.mass_kg, entry.drop_m))
        ball.change(radius_m, mass_kg)
        term, worlds = self.term_of_one(data)
        data.qpos[ball.place] = term.palm_place_m(worlds)[0] + (0.0, 0.0, drop_m + radius_m)
        self.remember(held=0)
        mujoco.mj_forward(self._model, data)


bind = CatchTask
