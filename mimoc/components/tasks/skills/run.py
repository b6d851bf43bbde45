"""Motor skills: how an infant's posture and progress are measured, rewarded and judged."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Any, get_args

import mujoco
import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import in_subtrees
from mimoc.components.tasks.skills import BoundEntry, Measure, RewardEntry, SkillEntry
from mimoc.runtime.actuation import Actuation, bind_actuation
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.runtime.task import FORCES, Change, Judgement, Task
from mimoc.runtime.term import Term
from mimoc.runtime.worlds import Worlds

MEASURES: tuple[str, ...] = get_args(Measure)


@dataclass(frozen=True)
class BodyMeasures(Term):
    """The measures of an infant's body at one moment, and where its hip is on the way."""

    trunk: IntArray  # Bodies of hip and chest, shape (2,).
    head: int
    forward_axis: int
    is_left: bool  # Whether the way is to the left, not forward.
    held: IntArray  # Bodies of hand and object, shape (2,), or twice the hip.
    standing_head_m: float
    standing_hip_m: float
    step_s: float

    def __call__(self, worlds: Worlds, memory: Any) -> tuple[Any, Any]:
        """Return the measures, shape (k, m), and the place on the way, shape (k,), [m]."""
        xp = worlds.xp
        turns = _rows_of(worlds, "xmat", self.trunk)
        places_m = _rows_of(worlds, "xpos", self.trunk)
        fronts_z, up_z = turns[..., 2, 0], turns[..., 2, 2]
        flat = xp.sqrt(xp.maximum(1 - fronts_z * fronts_z, xp.zeros_like(fronts_z)))
        turned = xp.sum(xp.atan2(flat, fronts_z), axis=-1) / (2 * pi)
        ahead = turns[:, 0, :2, self.forward_axis]
        heading = memory["heading"]
        length = xp.maximum(xp.hypot(ahead[:, 0], ahead[:, 1]), xp.ones_like(turned) * 1e-6)
        facing = (ahead[:, 0] * heading[:, 0] + ahead[:, 1] * heading[:, 1]) / length
        way = self.way_of(worlds, heading)
        away = _rows_of(worlds, "xpos", self.held)
        near = -xp.sqrt(xp.vecdot(away[:, 1] - away[:, 0], away[:, 1] - away[:, 0]))
        measures = (
            xp.min(up_z, axis=-1),
            xp.min(-fronts_z, axis=-1),
            xp.min(fronts_z, axis=-1),
            turned,
            worlds.xpos[:, self.head, 2] / self.standing_head_m,
            places_m[:, 0, 2] / self.standing_hip_m,
            facing,
            (way - memory["way"]) / self.step_s,
            near,
        )
        return xp.stack(measures, axis=-1), way

    def way_of(self, worlds: Worlds, heading: Any) -> Any:
        """Return where each hip is on the way along its heading, shape (k, 2), or to its left, in [m]."""
        place_m = _rows_of(worlds, "xpos", self.trunk)[:, 0, :]  # `rows[0]` in an index waits for a device.
        if self.is_left:
            return place_m[:, 1] * heading[:, 0] - place_m[:, 0] * heading[:, 1]
        return place_m[:, 0] * heading[:, 0] + place_m[:, 1] * heading[:, 1]


@dataclass(frozen=True)
class Bounds(Term):
    """Whether some measures are all large enough."""

    measures: IntArray
    least: FloatArray

    def __call__(self, xp: Any, measured: Any) -> Any:
        """Return whether those of k infants are, shape (k,), from all measures, shape (k, m)."""
        return xp.all(xp.take(measured, self.measures, axis=1) >= self.least, axis=-1)


@dataclass(frozen=True)
class Reward(Term):
    """A weight times a product of shares."""

    measures: IntArray
    zero: FloatArray
    span: FloatArray
    weight: float

    def __call__(self, xp: Any, measured: Any) -> Any:
        """Return the reward of k infants, shape (k,), from all measures, shape (k, m)."""
        shares = (xp.take(measured, self.measures, axis=1) - self.zero) / self.span
        return self.weight * xp.prod(xp.clip(shares, 0.0, 1.0), axis=-1)


@dataclass(frozen=True)
class Helper(Term):
    """Forces on a body: pushes from the side, and the hands of a helper that carry some weight for a time."""

    push_steps: FloatArray  # Shape (1,).
    support_steps: float

    def __call__(self, worlds: Worlds, memory: Any) -> Any:
        """Return the forces and torques on the body, shape (k, 1, 6), in [N] and [N m]."""
        xp = worlds.xp
        since = memory["step"][:, None] - memory["push_at"]
        active = xp.astype((since >= 0) & (since < self.push_steps), memory["push_n"].dtype)
        sideways_n = xp.sum(active[..., None] * memory["push_n"], axis=1)
        is_carried = xp.astype(memory["step"] < self.support_steps, sideways_n.dtype)
        up_n = (is_carried * memory["support_n"])[:, None]
        return xp.concat([sideways_n, up_n, xp.zeros_like(sideways_n), xp.zeros_like(up_n)], axis=-1)[:, None, :]


@dataclass(frozen=True)
class Skill(Term):
    """Judges a skill; success is a posture that was kept for long enough, in which the infant got far enough."""

    body: BodyMeasures
    posture: Bounds
    fall: Bounds
    rewards: tuple[Reward, ...]
    names: tuple[str, ...]
    groups: IntArray
    """0 for geoms of the world, 1 for those that must be clear of it, else -1; shape (ngeom,), or empty if none is."""
    effort: Term
    full: float  # Effort of all actuators at full strength.
    low: FloatArray
    span: FloatArray  # Difference of the highest and the lowest command, shape (n,).
    kept_steps: float
    way_m: float
    success_weight: float
    effort_weight: float
    change_weight: float
    helper: tuple[Helper, ...]  # None or one.

    def __call__(self, worlds: Worlds, action: Any, memory: Any) -> Judgement:
        """Return the judgement of k infants."""
        xp = worlds.xp
        measured, way = self.body(worlds, memory)
        is_fine = self.posture(xp, measured)
        if len(self.groups):
            is_fine = is_fine & ~worlds.pressing(self.groups)[:, 0, 1]
        fine = xp.astype(is_fine, measured.dtype)
        kept = (memory["kept"] + fine) * fine
        share = xp.minimum(kept / xp.maximum(self.kept_steps, xp.ones_like(kept)), xp.ones_like(kept))
        walked_m = memory["walked_m"] + fine * (way - memory["way"])
        measured = xp.concat([measured, fine[:, None], share[:, None]], axis=-1)
        is_there = (walked_m >= self.way_m) | (self.way_m <= 0)
        reached = is_fine & (kept >= self.kept_steps) & is_there
        commands = xp.clip((action[:, : self.low.shape[-1]] - self.low) / self.span, 0.0, 1.0)
        terms = {name: reward(xp, measured) for name, reward in zip(self.names, self.rewards, strict=True)}
        terms["success"] = self.success_weight * xp.astype(reached, measured.dtype)
        terms["effort"] = -self.effort_weight * self.effort(worlds) / self.full
        terms["change"] = -self.change_weight * xp.mean((commands - memory["commands"]) ** 2, axis=-1)
        remembered = {
            "kept": kept,
            "way": way,
            "walked_m": walked_m,
            "step": memory["step"] + 1,
            "commands": commands,
            "reached": memory["reached"] | reached,
        }
        changes = {FORCES: Change(xp.ones_like(is_fine), lambda: self.helper[0](worlds, {**memory, **remembered}))}
        fell = ~self.fall(xp, measured)
        return Judgement(terms, remembered["reached"], fell, remembered, changes if self.helper else {})


def _rows_of(worlds: Worlds, field: str, rows: Any) -> Any:
    return worlds.xp.take(getattr(worlds, field), rows, axis=1)


class SkillTask(Task):
    """An infant that learns a motor skill."""

    def __init__(self, entry: SkillEntry, model: mujoco.MjModel, bundle: Bundle):
        self._entry, self._model = entry, model
        self._step_s = ms_to_s(bundle.manifest.step_ms)
        is_of_infant = in_subtrees(model, [model.body(entry.hip).id])[model.jnt_bodyid]
        self._dofs = model.jnt_dofadr[is_of_infant & (model.jnt_type == HINGE)].astype(np.intp)
        actuation = bind_actuation(bundle.manifest.actuation, model)
        memory = {
            "heading": np.array([1.0, 0.0]),
            "way": 0.0,
            "walked_m": 0.0,
            "kept": 0.0,
            "step": 0.0,
            "reached": False,
            "commands": np.full(len(actuation.low), 0.5),
        }
        if entry.helped:
            pushes = max(entry.pushes, 1)
            memory |= {"push_at": np.full(pushes, -1e6), "push_n": np.zeros((pushes, 2)), "support_n": 0.0}
            self.forced = np.array([model.body(entry.helped).id], np.intp)
        super().__init__(entry.steps, self._term(actuation), memory)

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Give the joints some speed, see where the infant faces, and draw what its helper does."""
        data.qvel[self._dofs] = generator.normal(0.0, self._entry.start_rad_s, len(self._dofs))
        mujoco.mj_forward(self._model, data)
        term, worlds = self.term_of_one(data)
        ahead = worlds.xmat[0, term.body.trunk[0], :2, self._entry.forward_axis]
        heading = ahead / max(float(np.hypot(*ahead)), 1e-6)
        way = float(term.body.way_of(worlds, heading[None])[0])
        at_rest = np.clip(-term.low / term.span, 0.0, 1.0)[0]
        self.remember(heading=heading, way=way, walked_m=0.0, kept=0.0, step=0.0, reached=False, commands=at_rest)
        if self._entry.helped:
            entry, pushes = self._entry, len(self.memory["push_at"])
            second, apart = 1.0 / self._step_s, (entry.steps or 1) / max(pushes, 1)  # In control steps.
            push_at = second + (np.arange(pushes) + generator.uniform(0.0, 0.7, pushes)) * apart * 0.9
            angles = generator.uniform(-pi, pi, pushes)
            push_n = entry.push_n * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
            support_n = float(generator.uniform(*entry.support_n))
            push_n = push_n if entry.pushes else 0 * push_n
            self.remember(push_at=np.floor(push_at), push_n=push_n, support_n=support_n)
            data.xfrc_applied[self.forced[0], 2] = support_n

    def _term(self, actuation: Actuation) -> Skill:
        entry, model, step_s = self._entry, self._model, self._step_s
        ids = {name: model.body(name).id for name in (entry.hip, entry.chest, entry.head)}
        held = [model.body(name or entry.hip).id for name in (entry.hand, entry.object)]
        body = BodyMeasures(
            trunk=np.array([ids[entry.hip], ids[entry.chest]], np.intp),
            head=ids[entry.head],
            forward_axis=entry.forward_axis,
            is_left=entry.way == "left",
            held=np.array(held, np.intp),
            standing_head_m=entry.standing_head_m,
            standing_hip_m=entry.standing_hip_m,
            step_s=step_s,
        )
        span = actuation.high - actuation.low
        return Skill(
            body=body,
            posture=_bounds(entry.posture),
            fall=_bounds(entry.fall),
            rewards=tuple(map(_reward, entry.reward)),
            names=tuple(reward.name for reward in entry.reward),
            groups=_groups(model, entry),
            effort=actuation.effort,
            full=1.0 / max(len(span), 1),
            low=actuation.low,
            span=np.where(span > 0, span, 1.0),
            kept_steps=entry.kept_s / step_s,
            way_m=entry.way_m,
            success_weight=entry.success_weight,
            effort_weight=entry.effort_weight,
            change_weight=entry.change_weight,
            helper=(Helper(np.array([entry.push_s / step_s]), entry.support_s / step_s),) if entry.helped else (),
        )


HINGE = int(mujoco.mjtJoint.mjJNT_HINGE)


def _bounds(bounds: Sequence[BoundEntry]) -> Bounds:
    measures = np.array([MEASURES.index(bound.measure) for bound in bounds], np.intp)
    return Bounds(measures, np.array([bound.least for bound in bounds], float))


def _reward(entry: RewardEntry) -> Reward:
    measures = np.array([MEASURES.index(share.measure) for share in entry.shares], np.intp)
    zero = np.array([share.zero for share in entry.shares])
    return Reward(measures, zero, np.array([share.full for share in entry.shares]) - zero, entry.weight)


def _groups(model: mujoco.MjModel, entry: SkillEntry) -> IntArray:
    """Return the group of each geom, as `Skill.groups`."""
    if not entry.clear:
        return np.array([], np.intp)
    bodies = np.where(in_subtrees(model, [model.body(entry.hip).id]), -1, 0)
    bodies[[model.body(name).id for name in entry.clear]] = 1
    return bodies[model.geom_bodyid]


bind = SkillTask
