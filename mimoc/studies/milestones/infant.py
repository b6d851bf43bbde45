"""A compiled infant on a flat floor, under some conditions, and what a trial has to know of it."""

import copy
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import mujoco
import numpy as np

from mimoc.base.units import GRAVITY_M_S2, deg_to_rad, ms_to_s
from mimoc.bundle.model import in_subtrees
from mimoc.compiler.validation.measuring import ROOT, compile_infant, solid_extents
from mimoc.compiler.variants import at_age_unchecked, errors_at
from mimoc.delays.build_presets import PRESETS, given_keys
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import PAIRED_GROUPS, STRENGTH_GROUPS
from mimoc.senses.sense import FloatArray, IntArray

SIDES = ("left", "right")
FIXED_ARMATURE = 1e6
"""Armature of degrees of freedom that an apparatus holds, in [kg] and [kg m²]: a million times an infant's own."""
SMALL_GAP_M = 1e-4
"""Penetration of the floor at the start, so that the first physics step already carries the infant."""

BISECTIONS = 12

SENSED = ("proprioception", "vestibular")
"""The senses that tell posture and balance."""


@dataclass(frozen=True, slots=True)
class Conditions:
    """What can be varied to see how much a result hangs on it."""

    push: float = 0.03
    """Size of the pushes while sitting and standing, in body weights."""
    servo: float = 1.0
    """Factor on the natural frequency of the controller."""
    strength: float = 1.0
    """Factor on the torque limits of all motors, on top of the infant's own."""
    delays: bool = False
    """Whether the infant's own delays of senses and commands apply, with a forward model that predicts over them."""


@dataclass(frozen=True)
class TrialInfant:
    """A model, and the hinges that its motors drive."""

    model: mujoco.MjModel
    joints: IntArray
    """Index of each driven hinge, shape (n,), each once."""
    delays_s: tuple[float, float]
    """Its delays of senses and of commands."""
    toneless_bias: FloatArray | None = None
    """Bias parameters of servos without muscle tone, shape (nu, mjNBIAS): what their commands alone make of them; None
    if it has no servos."""

    @cached_property
    def angles(self) -> IntArray:
        """Where the angles of the driven hinges stand in `qpos`, shape (n,)."""
        return self.model.jnt_qposadr[self.joints].astype(np.intp)

    @cached_property
    def dofs(self) -> IntArray:
        """Where their speeds stand in `qvel`, shape (n,)."""
        return self.model.jnt_dofadr[self.joints].astype(np.intp)

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the driven hinges, without `robot:`."""
        return tuple(self.model.joint(joint).name.removeprefix("robot:") for joint in self.joints)

    @cached_property
    def weight_n(self) -> float:
        """Weight of the whole infant."""
        return float(self.model.body_subtreemass[self.model.body(ROOT).id]) * GRAVITY_M_S2

    @cached_property
    def floor(self) -> int:
        """Index of the floor's geom."""
        return self.model.geom("floor").id

    @cached_property
    def solids(self) -> IntArray:
        """Indices of the geoms that touch things."""
        touching = (self.model.geom_contype | self.model.geom_conaffinity) > 0
        belongs = self.model.body_rootid[self.model.geom_bodyid] == self.model.body(ROOT).id
        return np.flatnonzero(belongs & touching).astype(np.intp)

    @cached_property
    def pushed(self) -> int:
        """Index of the body that pushes act on."""
        return self.model.body("chest" if self.has("chest") else "upper_body").id

    def has(self, *bodies: str) -> bool:
        """Return whether the infant has all of some body parts."""
        return all(mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, name) >= 0 for name in bodies)

    def parts_without(self, roots: Collection[str]) -> frozenset[int]:
        """Return the bodies that are not among *roots* nor below them: those that must not touch the floor."""
        ids = [self.model.body(name).id for name in roots if self.has(name)]
        return frozenset(np.flatnonzero(~in_subtrees(self.model, ids)).tolist()) - {0}

    def touching(self, data: mujoco.MjData, bodies: frozenset[int]) -> str:
        """Return in words which of some bodies touches the floor; nothing if none does."""
        geoms = data.contact.geom
        others = geoms[(geoms == self.floor).any(axis=1)]
        for geom in others[others != self.floor]:
            body = int(self.model.geom_bodyid[geom])
            if body in bodies:
                return f"{self.model.body(body).name} touches the floor"
        return ""

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

    def range_deg(self, joint: str) -> tuple[float, float]:
        """Return the range of a hinge."""
        low, high = np.degrees(self.model.joint(f"robot:{joint}").range)
        return float(low), float(high)

    def placed(self, pitch_deg: float, angles_deg: Mapping[str, float], above_m: float = 0.0) -> mujoco.MjData:
        """Return a posture at rest, its lowest point on the floor or above it.

        Args:
            pitch_deg: Rotation of the hip about y: 90 is face down, -90 face up.
            angles_deg: Angles by joint, without `robot:`, clipped to the ranges; `{side}` stands for both sides. Joints
                that this infant lacks are left out.
            above_m: Height of the lowest point above the floor.
        """
        data = mujoco.MjData(self.model)
        for joint, angle_rad in self._clipped(angles_deg):
            data.qpos[self.model.jnt_qposadr[joint]] = angle_rad
        half = deg_to_rad(pitch_deg) / 2
        data.qpos[:7] = (0.0, 0.0, 0.0, np.cos(half), 0.0, np.sin(half), 0.0)
        mujoco.mj_kinematics(self.model, data)
        data.qpos[2] = above_m - self.lowest_m(data) - SMALL_GAP_M
        mujoco.mj_forward(self.model, data)
        return data

    def turned(self, data: mujoco.MjData, angles_deg: Mapping[str, float]) -> FloatArray:
        """Return the angles of the driven hinges in a state, but for some, clipped to their ranges, shape (n,).

        Joints are named as for `placed`.
        """
        angles = data.qpos[self.angles].copy()
        for joint, angle_rad in self._clipped(angles_deg):
            angles[self.joints == joint] = angle_rad
        return angles

    def _clipped(self, angles_deg: Mapping[str, float]) -> Iterator[tuple[int, float]]:
        """Yield index and angle of the hinges that there are."""
        for pattern, angle_deg in angles_deg.items():
            for side in SIDES:
                name = "robot:" + pattern.format(side=side)
                joint = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name)
                if joint >= 0:
                    yield joint, float(np.clip(deg_to_rad(angle_deg), *self.model.jnt_range[joint]))

    def lowest_m(self, data: mujoco.MjData, part: str | None = None) -> float:
        """Return the height of the lowest point of a body part, or of the whole infant."""
        geoms = self.solids
        if part:
            geoms = geoms[self.model.geom_bodyid[geoms] == self.model.body(part).id]
        up = data.geom_xmat[geoms].reshape(-1, 3, 3)[:, 2]
        return float(np.min(data.geom_xpos[geoms, 2] - solid_extents(self.model, geoms).along(up)))


def compile_at(spec: InfantSpec, age_months: float, conditions: Conditions) -> TrialInfant:
    """Return the infant of a spec at some age, alone on a flat floor, all of its muscles at its command.

    Raises:
        SpecError: If the spec asks for what this version cannot build.
    """
    grown = grown_to(spec, age_months, conditions)
    with errors_at(spec, age_months):
        model = compile_infant(grown)
    return in_trial(model, grown)


def in_trial(model: mujoco.MjModel, spec: InfantSpec) -> TrialInfant:
    """Return the infant of a model that was compiled from some spec, perhaps with other things in its world."""
    joints = np.unique(model.actuator_trnid[:, 0]).astype(np.intp)
    bias = compile_infant(_with_actuation(spec, arousal=0.0)).actuator_biasprm if _has_servos(spec) else None
    return TrialInfant(model, joints, longest_delays_s(spec), bias)


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
    """Return a spec at some age, with all of its muscles at its command and their strength under some conditions.

    Raises:
        SpecError: If the spec cannot have this age.
    """
    asked = spec.actuation
    pairs = {side: pair for pair, sides in PAIRED_GROUPS.items() for side in sides}
    strength = {
        group: conditions.strength * asked.strength.get(group, asked.strength.get(pairs.get(group, group), 1.0))
        for group in STRENGTH_GROUPS
        if group not in PAIRED_GROUPS
    }
    actuation = asked.model_copy(update={"strength": strength, "regions": None, "locked": ()})
    with errors_at(spec, age_months):
        return at_age_unchecked(spec, age_months).model_copy(update={"actuation": actuation})


def _has_servos(spec: InfantSpec) -> bool:
    """Return whether the commands of a spec's infant are angles that servos go to."""
    return spec.actuation.model == "position"


def longest_delays_s(spec: InfantSpec) -> tuple[float, float]:
    """Return the longest delays of posture senses and of commands, those of the legs: the whole state waits for them.

    They are those of the spec, or physiological ones of its age if it asks for none.
    """
    sensory_ms = max(_longest_ms(spec, signal) for signal in SENSED)
    return ms_to_s(sensory_ms), ms_to_s(_longest_ms(spec, "motor"))


def _longest_ms(spec: InfantSpec, signal: str) -> float:
    if keys := given_keys(spec.delays, signal):
        return float(getattr(spec.delays, keys[0]))
    preset = "physiological" if spec.delays.preset == "none" else spec.delays.preset
    entry = PRESETS[preset](signal, spec.age_months, spec.control.timestep_ms)
    return max(entry.ms, entry.legs_ms or 0.0)


def bisect(
    low: float, high: float, place: Callable[[float], mujoco.MjData], is_too_high: Callable[[mujoco.MjData], bool]
) -> mujoco.MjData:
    """Return the posture of the value from which on something is too high, by halving an interval again and again."""
    for _ in range(BISECTIONS - 1):
        middle = (low + high) / 2
        low, high = (low, middle) if is_too_high(place(middle)) else (middle, high)
    return place((low + high) / 2)


def tilt_deg(data: mujoco.MjData, body: int) -> float:
    """Return the angle between a body's own upward axis and the vertical."""
    return float(np.degrees(np.arccos(np.clip(data.xmat[body, 8], -1.0, 1.0))))


def elevation_deg(data: mujoco.MjData, body: int) -> float:
    """Return how far a body faces up: 90 degrees for straight up, -90 for straight down."""
    return float(np.degrees(np.arcsin(np.clip(data.xmat[body, 6], -1.0, 1.0))))


def rise_deg(data: mujoco.MjData, start: int, end: int) -> float:
    """Return the elevation of the line from one body's origin to another's: 90 degrees for straight up."""
    line_m = data.xpos[end] - data.xpos[start]
    return float(np.degrees(np.arctan2(line_m[2], np.hypot(line_m[0], line_m[1]))))
