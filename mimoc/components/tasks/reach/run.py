"""Reaching: touch a ball that hangs before the infant.

Head and eyes follow the ball, so that proprioception encodes its position.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.base.errors import BundleError
from mimoc.base.mujoco_layout import LOCK_ANGLE
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import ConstraintsEntry
from mimoc.components.tasks.reach import ReachEntry, ball_from_shoulder
from mimoc.runtime.model_fields import ModelField
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.runtime.task import NOTHING, Change, Judgement, Task
from mimoc.runtime.term import Term
from mimoc.runtime.worlds import Worlds
from mimoc.schema.task import GazeEntry

STILL_M = 1e-4  # How far a ball that nobody touches may seem to move.
GAZE_ROUNDS = 12  # Rounds until the gaze reaches the ball at the start: each reduces the error by more than half.
MAX_DRAWS = 100
"""How often a place is drawn at most until the ball touches nothing there; of newborns, who have the shortest arms for
their chests, one place in nine is within the infant."""


@dataclass(frozen=True)
class Gaze(Term):
    """Angles of n joints of the head and the eyes that point the x axes of these at a target, shape (k, n), [rad].

    Each joint turns by the angle that brings the x axis f of its head or eye nearest to the direction t of the target,
    about its own axis a, as if the others stood still: cyclic coordinate descent (Wang & Chen 1991).

        turn = atan2(a · (f x t), f · t - (a · f) (a · t))
    """

    joints: IntArray  # Shape (n,), as are all that follow.
    angles: IntArray  # Where the angles of the joints stand in qpos.
    lookers: IntArray  # The body that each joint turns.
    low: FloatArray  # The ranges of the joints, in [rad].
    high: FloatArray

    def __call__(self, worlds: Worlds, target_m: Any) -> Any:
        """Return the angles, within their ranges, for targets in the world, shape (k, 3), [m]."""
        xp = worlds.xp
        axes = xp.take(worlds.xaxis, self.joints, axis=1)
        forward = xp.take(worlds.xmat, self.lookers, axis=1)[..., 0]
        towards = target_m[:, None, :] - xp.take(worlds.xpos, self.lookers, axis=1)
        along = _dots(forward, towards) - _dots(axes, forward) * _dots(axes, towards)
        angles = xp.take(worlds.qpos, self.angles, axis=1) + xp.atan2(_triple(axes, forward, towards), along)
        return xp.minimum(xp.maximum(angles, self.low), self.high)


def bind_gaze(
    entries: Sequence[GazeEntry], model: mujoco.MjModel, constraints: ConstraintsEntry
) -> tuple[Gaze, ModelField]:
    """Find joints, lookers and locks in *model*: return the gaze, and the locks that hold it, in the same order.

    Raises:
        BundleError: If a joint is not locked.
    """
    joints = [model.joint(entry.joint) for entry in entries]
    lock_of = {lock.joint: lock.equality for lock in constraints.locks}
    for entry in entries:
        if entry.joint not in lock_of:
            raise BundleError(f"its gaze turns '{entry.joint}', which is not locked; build it again")
    low, high = np.array([joint.range for joint in joints]).reshape(-1, 2).T
    gaze = Gaze(
        joints=np.array([joint.id for joint in joints], int),
        angles=np.array([joint.qposadr[0] for joint in joints], int),
        lookers=np.array([model.body(entry.looker).id for entry in entries], int),
        low=low,
        high=high,
    )
    locks = np.array([model.equality(lock_of[entry.joint]).id for entry in entries], np.intp)
    return gaze, ModelField("eq_data", locks)


def _dots(first: Any, second: Any) -> Any:
    """Return the scalar products of vectors, shape (..., 3), in an order that does not depend on their number."""
    products = first * second
    return products[..., 0] + products[..., 1] + products[..., 2]


def _triple(axes: Any, first: Any, second: Any) -> Any:
    """Return the scalar triple products a · (f x t) of vectors, shape (..., 3)."""
    (x1, y1, z1), (x2, y2, z2) = ([vectors[..., axis] for axis in range(3)] for vectors in (first, second))
    across = y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2
    return axes[..., 0] * across[0] + axes[..., 1] * across[1] + axes[..., 2] * across[2]


@dataclass(frozen=True)
class Reach(Term):
    """Distance from hand to ball costs as much as it is, a touch or a hold earns a reward and ends the episode.

    The ball is touched when it has moved, and held while the fingers are near it; head and eyes, which are locked,
    follow it.
    """

    effector: int
    ball: int
    still_m2: float  # How far a ball moves before head and eyes follow it, squared, in [m²].
    moved_m2: float  # How far it moves before it counts as touched, squared, in [m²].
    success_reward: float
    gaze: Gaze
    near_m: float
    hold_steps: int  # Control steps for which the fingers must be near the ball; 0 if a touch is enough.

    def __call__(self, worlds: Worlds, action: Any, memory: Any) -> Judgement:
        """Return the judgement of k infants, whose balls were hung at `start_m`, shape (k, 3), [m]."""
        xp, xpos = worlds.xp, worlds.xpos
        ball_m = xpos[:, self.ball, :]
        moved_m = ball_m - memory["start_m"]
        away_m = ball_m - xpos[:, self.effector, :]
        moved_m2 = xp.vecdot(moved_m, moved_m)
        distance_m = xp.sqrt(xp.vecdot(away_m, away_m))
        name = "touch"
        is_reached = moved_m2 > self.moved_m2
        remembered = NOTHING
        if self.hold_steps:
            is_near = xp.astype(distance_m <= self.near_m, distance_m.dtype)
            held = (memory["held"] + is_near) * is_near
            name = "hold"
            is_reached = held >= self.hold_steps
            remembered = {"held": held}
        terms = {"distance": -distance_m, name: xp.where(is_reached, self.success_reward, 0.0)}
        turned = Change(moved_m2 > self.still_m2, lambda: self.gaze(worlds, ball_m), LOCK_ANGLE)
        return Judgement(terms, is_reached, is_reached, remembered, {"eq_data": turned})


class ReachTask(Task):
    """A ball that hangs somewhere within reach."""

    def __init__(self, entry: ReachEntry, model: mujoco.MjModel, bundle: Bundle):
        gaze, self._locks = bind_gaze(entry.gaze, model, bundle.manifest.constraints)
        bodies = (entry.effector, entry.ball.body, entry.shoulder, entry.trunk)
        effector, ball, self._shoulder, self._trunk = (model.body(name).id for name in bodies)
        hold_steps = round(entry.hold_s / ms_to_s(bundle.manifest.step_ms))
        amounts = entry.success_reward, gaze, entry.near_m, hold_steps
        term = Reach(effector, ball, STILL_M**2, entry.moved_m**2, *amounts)
        super().__init__(entry.steps, term, {"start_m": np.zeros(3)} | ({"held": 0.0} if hold_steps else {}))
        self._entry, self._model = entry, model
        self._ball_geom = model.geom(entry.ball.geom).id
        self._ball_at = model.joint(entry.ball.joint).qposadr[0] + np.arange(3)

    @property
    def model_fields(self) -> Sequence[ModelField]:
        """The angles that head and eyes are locked at."""
        return (self._locks,)

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Hang the ball somewhere within reach, clear of everything, and look at it."""
        if "held" in self.memory:
            self.remember(held=0.0)
        for _ in range(MAX_DRAWS):
            trunk = data.xmat[self._trunk].reshape(3, 3)
            away_m = ball_from_shoulder(self._entry, lambda ends: generator.uniform(*ends))
            self._hang(data, data.xpos[self._shoulder] + trunk @ away_m)
            if not (data.contact.geom == self._ball_geom).any():
                break

    def _hang(self, data: mujoco.MjData, place_m: FloatArray) -> None:
        """Hang the ball at a place, shape (3,), [m], and turn head and eyes to it."""
        self.remember(start_m=place_m)
        data.qpos[self._ball_at] = place_m
        term, worlds = self.term_of_one(data)
        for _ in range(GAZE_ROUNDS):
            data.qpos[term.gaze.angles] = term.gaze(worlds, place_m[None])[0]
            mujoco.mj_kinematics(self._model, data)
        self._model.eq_data[self._locks.rows, LOCK_ANGLE] = data.qpos[term.gaze.angles]
        mujoco.mj_forward(self._model, data)


bind = ReachTask
