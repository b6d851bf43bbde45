"""A compiled infant on a flat floor, under some conditions, and what a trial has to know of it."""

import copy
from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import lru_cache

import mujoco
import numpy as np

from mimoc.compiler.child import child_of
from mimoc.compiler.measuring import compile_infant
from mimoc.compiler.presets import delays
from mimoc.compiler.variants import at_age, errors_at
from mimoc.policies.control.holding.postures import DrivenInfant
from mimoc.runtime.delays.signals import Timing, delays_by_signal, within
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import PAIRED_GROUPS, STRENGTH_GROUPS

FIXED_ARMATURE = 1e6
"""Armature of degrees of freedom that an apparatus holds, in [kg] and [kg m²]: a million times an infant's own."""

INTERVAL_MS = 5.0  # How often commands are sent in trials with delays.


@dataclass(frozen=True, slots=True)
class Conditions:
    """What can be varied to see how much a result hangs on it."""

    push: float = 0.03  # Size of the pushes while sitting and standing, in body weights.
    servo: float = 1.0  # Factor on the natural frequency of the controller.
    strength: float = 1.0  # Factor on the torque limits of all motors, on top of the infant's own.
    delays: bool = False
    """Whether the infant's own delays of senses and commands apply, with a forward model that predicts over them."""


@dataclass(frozen=True)
class TrialInfant(DrivenInfant):
    """A driven infant with what a trial has to know of it, which an apparatus can hold."""

    timing: Timing  # When its senses tell and its commands act, in trials with delays.
    toneless_bias: FloatArray | None = None
    """Bias parameters of servos without muscle tone, shape (nu, mjNBIAS): what their commands alone make of them; None
    if it has no servos."""

    @property
    def sensed_steps(self) -> IntArray:
        """Physics steps after which each joint is known, the root by proprioception and balance, shape (njnt,)."""
        model, timing = self.model, self.timing
        steps = timing.delay_steps("proprioception", within(model, model.jnt_bodyid.astype(np.intp)), model.njnt)
        balance = timing.delay_steps("vestibular", None, model.njnt)
        return np.where(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE, np.maximum(steps, balance), steps)

    def fixed(self, dofs: Collection[int]) -> "TrialInfant":
        """Return an infant some of whose degrees of freedom are held by an apparatus."""
        held = copy.copy(self.model)
        held.dof_armature[list(dofs)] = FIXED_ARMATURE
        return replace(self, model=held)

    def trunk_dofs(self) -> list[int]:
        """Return the degrees of freedom of hip, three of translation and three of rotation, and trunk, without head."""
        return [*range(6), *self.dofs_of("lower_body", "upper_body", "chest")]

    def dofs_of(self, *bodies: str) -> list[int]:
        """Return the degrees of freedom of some bodies relative to their parents."""
        ids = [self.model.body(name).id for name in bodies if self.has(name)]
        return np.flatnonzero(np.isin(self.model.dof_bodyid, ids)).tolist()


def compile_at(spec: InfantSpec, age_months: float, conditions: Conditions) -> TrialInfant:
    """Return the infant of a spec at some age, alone on a flat floor all muscles at its command, or a SpecError."""
    grown = grown_to(spec, age_months, conditions)
    with errors_at(spec, age_months):
        model = compile_infant(grown)
    return in_trial(model, grown)


def in_trial(model: mujoco.MjModel, spec: InfantSpec) -> TrialInfant:
    """Return the infant of a model that was compiled from some spec, perhaps with other things in its world."""
    joints = np.unique(model.actuator_trnid[:, 0]).astype(np.intp)
    bias = compile_infant(_with_actuation(spec, arousal=0.0)).actuator_biasprm if _has_servos(spec) else None
    return TrialInfant(model, joints, own_timing(spec), bias)


def slackened(spec: InfantSpec) -> InfantSpec:
    """Return a spec whose infant has relaxed joints and nothing else: no tone, no dampers of servos."""
    return _with_actuation(spec, arousal=0.0, **({"model": "torque"} if _has_servos(spec) else {}))


def _with_actuation(spec: InfantSpec, **changes: object) -> InfantSpec:
    return spec.model_copy(update={"actuation": spec.actuation.model_copy(update=changes)})


@lru_cache(maxsize=64)
def compile_once(spec: str, age_months: float, conditions: Conditions) -> TrialInfant:
    """Return the infant of a spec in JSON, compiled once by each process; specs themselves cannot be hashed."""
    return compile_at(InfantSpec.model_validate_json(spec), age_months, conditions)


def grown_to(spec: InfantSpec, age_months: float, conditions: Conditions) -> InfantSpec:
    """Return a spec at some age, all muscles at its command with the strength of conditions; or raise a SpecError."""
    asked = spec.actuation
    pairs = {side: pair for pair, sides in PAIRED_GROUPS.items() for side in sides}
    strength = {
        group: conditions.strength * asked.strength.get(group, asked.strength.get(pairs.get(group, group), 1.0))
        for group in STRENGTH_GROUPS
        if group not in PAIRED_GROUPS
    }
    actuation = asked.model_copy(update={"strength": strength, "regions": None, "locked": ()})
    with errors_at(spec, age_months):
        return at_age(spec, age_months, checked=False).model_copy(update={"actuation": actuation})


def _has_servos(spec: InfantSpec) -> bool:
    return spec.actuation.model == "position"


def own_timing(spec: InfantSpec) -> Timing:
    """Return the time base of a spec's infant with its own delays; if it asks for none, with those of its age."""
    asked, timestep_ms = spec.delays, spec.control.timestep_ms
    if asked.preset == "none":
        asked = asked.model_copy(update={"preset": "physiological"})
    entry = delays(spec.model_copy(update={"delays": asked}), child_of(spec).tree)
    step_ms = max(round(INTERVAL_MS / timestep_ms), 1) * timestep_ms
    return Timing(step_ms, timestep_ms, delays_by_signal(entry), entry.legs)
