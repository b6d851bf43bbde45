"""The hinges of an infant that actuators drive, and its body, in a model that may have other infants as well."""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Self

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.primitives import Extents
from mimoc.base.units import GRAVITY_M_S2
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees, solid_extents
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.names import SIDES

SMALL_GAP_M = 1e-4  # Penetration of the floor at the start, so that the first physics step already carries the infant.


@dataclass(frozen=True)
class DrivenJoints:
    """n hinges of an infant that actuators drive.

    Joints and body parts are named as those of an infant that is alone: the `head` of Anna is `anna_head` in a model
    with others.
    """

    model: mujoco.MjModel
    joints: IntArray  # Index of each hinge, shape (n,), each once.
    prefix: str = field(default="", kw_only=True)
    """What the names of the infant's parts begin with in the model; empty for an infant that is alone."""

    @classmethod
    def named(cls, model: mujoco.MjModel, names: Sequence[str], prefix: str = "") -> Self:
        """Return hinges by their names, such as `robot:left_elbow`."""
        return cls(model, np.array([model.joint(prefix + name).id for name in names], np.intp), prefix=prefix)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Their names, such as `robot:left_elbow`."""
        return tuple(self.model.joint(joint).name.removeprefix(self.prefix) for joint in self.joints)

    @cached_property
    def angles(self) -> IntArray:
        """Where their angles stand in `qpos`, shape (n,)."""
        return self.model.jnt_qposadr[self.joints].astype(np.intp)

    @cached_property
    def dofs(self) -> IntArray:
        """Where their speeds stand in `qvel`, shape (n,)."""
        return self.model.jnt_dofadr[self.joints].astype(np.intp)

    def slots_of(self, actuators: IntArray | slice) -> IntArray:
        """Return which of these hinges each of some of their actuators drives, shape (number of actuators,)."""
        slots = np.zeros(self.model.njnt, np.intp)
        slots[self.joints] = np.arange(len(self.joints))
        return slots[self.model.actuator_trnid[actuators, 0]]


@dataclass(frozen=True)
class DrivenInfant(DrivenJoints):
    """An infant with all hinges that actuators of its body drive, and where it is in a state."""

    @classmethod
    def of(cls, model: mujoco.MjModel, manifest: Manifest) -> Self:
        """Return the infant that a manifest describes, with all hinges that actuators of its body drive."""
        driven = model.actuator_trnid[:, 0]
        is_own = model.body_rootid[model.jnt_bodyid[driven]] == model.body(manifest.root_body).id
        return cls(model, np.unique(driven[is_own]).astype(np.intp), prefix=manifest.prefix)

    @cached_property
    def root(self) -> int:
        """Index of the infant's root body."""
        return int(self.model.body_rootid[self.model.jnt_bodyid[self.joints[0]]])

    @cached_property
    def is_own(self) -> npt.NDArray[np.bool_]:
        """Which bodies of the model are the infant's, shape (nbody,)."""
        return np.asarray(self.model.body_rootid == self.root)

    @cached_property
    def is_other(self) -> npt.NDArray[np.bool_]:
        """Which bodies of the model are those of other infants, shape (nbody,)."""
        model = self.model
        driven = model.body_rootid[model.jnt_bodyid[model.actuator_trnid[:, 0]]]
        return np.isin(model.body_rootid, driven) & ~self.is_own

    @cached_property
    def actuators(self) -> slice:
        """Where the a actuators of its hinges stand among those of the model; they follow one another."""
        own = np.flatnonzero(np.isin(self.model.actuator_trnid[:, 0], self.joints))
        return slice(int(own[0]), int(own[-1]) + 1)

    @cached_property
    def place(self) -> slice:
        """Where place and orientation of its root body stand in `qpos`: [m] and a quaternion."""
        start = int(self.model.jnt_qposadr[self.model.body_jntadr[self.root]])
        return slice(start, start + 7)

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the driven hinges, without `robot:`."""
        return tuple(name.removeprefix("robot:") for name in self.names)

    @cached_property
    def weight_n(self) -> float:
        """Weight of the whole infant."""
        return float(self.model.body_subtreemass[self.root]) * GRAVITY_M_S2

    @cached_property
    def solids(self) -> IntArray:
        """Indices of the geoms that touch things."""
        touching = (self.model.geom_contype | self.model.geom_conaffinity) > 0
        return np.flatnonzero(self.is_own[self.model.geom_bodyid] & touching).astype(np.intp)

    @cached_property
    def pushed(self) -> int:
        """Index of the body that pushes act on."""
        return self.body("chest" if self.has("chest") else "upper_body")

    def body(self, part: str) -> int:
        """Return the index of a body part."""
        return self.model.body(self.prefix + part).id

    def part(self, body: int) -> str:
        """Return the name of one of its bodies."""
        return self.model.body(body).name.removeprefix(self.prefix)

    def has(self, *bodies: str) -> bool:
        """Return whether the infant has all of some body parts."""
        kind = mujoco.mjtObj.mjOBJ_BODY
        return all(mujoco.mj_name2id(self.model, kind, self.prefix + name) >= 0 for name in bodies)

    def parts_without(self, roots: Collection[str]) -> frozenset[int]:
        """Return its bodies that are not among *roots* nor below them: those that must not touch the floor."""
        ids = [self.body(name) for name in roots if self.has(name)]
        return frozenset(np.flatnonzero(~in_subtrees(self.model, ids) & self.is_own).tolist())

    def touching(self, data: mujoco.MjData, bodies: frozenset[int]) -> str:
        """Return in words which of some bodies touches the floor, or what stands on it; nothing if none does."""
        pairs = self.model.geom_bodyid[data.contact.geom]
        is_still = self.model.body_weldid[pairs] == 0
        for body in pairs[is_still.any(axis=1)][~is_still[is_still.any(axis=1)]]:
            if int(body) in bodies:
                return f"{self.part(body)} touches the floor"
        return ""

    def range_deg(self, joint: str) -> tuple[float, float]:
        """Return the range of a hinge."""
        low, high = np.degrees(self.model.joint(f"{self.prefix}robot:{joint}").range)
        return float(low), float(high)

    def placed(
        self, pitch_deg: float, angles_deg: Mapping[str, float], above_m: float = 0.0, into: mujoco.MjData | None = None
    ) -> mujoco.MjData:
        """Return a posture at rest, its lowest point on the floor or above it.

        Args:
            pitch_deg: Rotation of the hip about y: 90 is face down, -90 face up.
            angles_deg: Angles by joint, without `robot:`, clipped to the ranges; `{side}` stands for both sides. Joints
                that this infant lacks are left out.
            above_m: Height of the lowest point above the floor.
            into: A state to overwrite, in which only places are computed: for postures that are tried one after the
                other. None is a new one, with all that MuJoCo computes.
        """
        data = mujoco.MjData(self.model) if into is None else into
        data.qpos[:] = self.model.qpos0
        for joint, angle_rad in self._clipped(angles_deg):
            data.qpos[self.model.jnt_qposadr[joint]] = angle_rad
        half = math.radians(pitch_deg) / 2
        data.qpos[self.place] = (0.0, 0.0, 0.0, np.cos(half), 0.0, np.sin(half), 0.0)
        mujoco.mj_kinematics(self.model, data)
        data.qpos[self.place.start + 2] = above_m - self.lowest_m(data) - SMALL_GAP_M
        if into is None:
            mujoco.mj_forward(self.model, data)
        else:
            mujoco.mj_kinematics(self.model, data)
            mujoco.mj_comPos(self.model, data)
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
        for pattern, angle_deg in angles_deg.items():
            for side in SIDES:
                if limits := self._limits.get(pattern.format(side=side)):
                    joint, low, high = limits
                    yield joint, min(max(math.radians(angle_deg), low), high)

    @cached_property
    def _limits(self) -> Mapping[str, tuple[int, float, float]]:
        """Index and range in [rad] of each joint of the infant, by its name without `robot:`."""
        own = DrivenJoints(
            self.model, np.flatnonzero(self.is_own[self.model.jnt_bodyid]).astype(np.intp), prefix=self.prefix
        )
        ranges_rad = self.model.jnt_range[own.joints].tolist()
        return {
            name.removeprefix("robot:"): (joint, *range_rad)
            for name, joint, range_rad in zip(own.names, own.joints.tolist(), ranges_rad, strict=True)
        }

    def lowest_m(self, data: mujoco.MjData, part: str | None = None) -> float:
        """Return the height of the lowest point of a body part, or of the whole infant."""
        if part not in self._extents:
            of_part = self.model.geom_bodyid[self.solids] == self.body(part) if part else slice(None)
            self._extents[part] = self.solids[of_part], solid_extents(self.model, self.solids[of_part])
        geoms, extents = self._extents[part]
        up = data.geom_xmat[geoms].reshape(-1, 3, 3)[:, 2]
        return float(np.min(data.geom_xpos[geoms, 2] - extents.along(up)))

    @cached_property
    def _extents(self) -> dict[str | None, tuple[IntArray, Extents]]:
        """Solids of body parts and how far they reach, of those that were asked for; None is the whole infant."""
        return {}
