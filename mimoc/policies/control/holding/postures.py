"""Postures that infants hold: seated, prone on the forearms, on hands and knees, standing; and when one is lost."""

import math
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.primitives import Extents
from mimoc.base.units import GRAVITY_M_S2
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees, solid_extents
from mimoc.runtime.sense import FloatArray, IntArray

SIDES = ("left", "right")
SMALL_GAP_M = 1e-4  # Penetration of the floor at the start, so that the first physics step already carries the infant.
BISECTIONS = 12


@dataclass(frozen=True)
class DrivenInfant:
    """An infant in a model that may have others as well, and the hinges that its motors drive.

    Its body parts and joints are named as those of an infant that is alone: the `head` of Anna is `anna_head` in a
    model with others.
    """

    model: mujoco.MjModel
    joints: IntArray  # Index of each driven hinge, shape (n,), each once.
    prefix: str = field(default="", kw_only=True)
    """What the names of its parts begin with in the model; empty for an infant that is alone."""

    @classmethod
    def of(cls, model: mujoco.MjModel, manifest: Manifest) -> "DrivenInfant":
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

    def slots_of(self, actuators: IntArray | slice) -> IntArray:
        """Return which of the driven hinges each of some of its actuators drives, shape (number of actuators,)."""
        return np.searchsorted(self.joints, self.model.actuator_trnid[actuators, 0]).astype(np.intp)

    @cached_property
    def place(self) -> slice:
        """Where place and orientation of its root body stand in `qpos`: [m] and a quaternion."""
        start = int(self.model.jnt_qposadr[self.model.body_jntadr[self.root]])
        return slice(start, start + 7)

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
        return tuple(self._joint_name(joint) for joint in self.joints)

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
        joints = np.flatnonzero(self.is_own[self.model.jnt_bodyid]).tolist()
        ranges = self.model.jnt_range.tolist()
        return {self._joint_name(joint): (joint, *ranges[joint]) for joint in joints}

    def _joint_name(self, joint: int) -> str:
        return self.model.joint(joint).name.removeprefix(self.prefix).removeprefix("robot:")

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


MOST_TILT_DEG = 45.0
SEAT = ("hip", "left_upper_leg", "right_upper_leg")
FEET = ("left_foot", "right_foot")
SUPPORTS = ("left_hand", "right_hand", "left_upper_leg", "right_upper_leg")
"""Parts that may touch the floor, with all that hangs on them; thighs, because they end in the knees."""
PRONE_UP_DEG = 45.0  # How far the face has to be turned up from straight down: "head up 45 degrees" of Denver II.
LEAST_PITCH_DEG, MOST_PITCH_DEG = -30.0, 40.0  # Of the pelvis, between which a seat is looked for.


def seat(infant: DrivenInfant, knee_deg: float, lean: float) -> mujoco.MjData:
    """Return an infant sitting with seat and heels on the floor, its centre of mass over some point between them.

    The tilt of the pelvis, and the hips that bring the heels to the floor, are found by bisection.
    """
    data = mujoco.MjData(infant.model)

    def heels_down(pitch_deg: float) -> mujoco.MjData:
        return bisect(
            *infant.range_deg("left_hip1"),
            lambda hip_deg: infant.placed(
                pitch_deg,
                {
                    "{side}_hip1": hip_deg,
                    "{side}_hip2": -35.0,
                    "{side}_knee": knee_deg,
                    "{side}_shoulder_ad_ab": 20.0,
                    "{side}_elbow": -60.0,
                    "head_tilt": -pitch_deg,
                },
                into=data,
            ),
            lambda data: infant.lowest_m(data, "hip") > infant.lowest_m(data, "left_foot"),
        )

    return bisect(LEAST_PITCH_DEG, MOST_PITCH_DEG, heels_down, lambda data: _lean_over_seat(infant, data) > lean)


def _lean_over_seat(infant: DrivenInfant, data: mujoco.MjData) -> float:
    """Return where the centre of mass stands: 0 over the middle of the pelvis, 1 over the ankles."""
    seat_m, heels_m = data.xpos[infant.body("hip"), 0], data.xpos[infant.body("left_foot"), 0]
    return float((data.subtree_com[infant.root, 0] - seat_m) / (heels_m - seat_m))


def slumped(infant: DrivenInfant, data: mujoco.MjData, forbidden: frozenset[int]) -> str:
    """Return whether arms, trunk or head touch the floor, or the trunk or the head is tilted too far."""
    if touching := infant.touching(data, forbidden):
        return touching
    if tilt_deg(data, infant.pushed) > MOST_TILT_DEG:
        return "trunk tilted"
    return "head tilted" if tilt_deg(data, infant.body("head")) > MOST_TILT_DEG else ""


def stance(infant: DrivenInfant, knee_deg: float, lean: float) -> mujoco.MjData:
    """Return an infant standing with flat soles on the floor, its centre of mass over some point of its feet.

    The hips bend half as far as the knees, or as far as a young hip is bent anyway; the ankles, and with them the lean
    of the whole infant, are found by bisection.
    """
    knee = float(np.clip(knee_deg, *infant.range_deg("left_knee")))
    hip = min(knee_deg / 2, infant.range_deg("left_hip1")[1])
    data = mujoco.MjData(infant.model)

    def placed(ankle: float) -> mujoco.MjData:
        angles_deg = {"{side}_hip1": hip, "{side}_knee": knee, "{side}_foot1": ankle, "{side}_elbow": -15.0}
        return infant.placed(ankle + knee - hip, angles_deg, into=data)

    return bisect(*infant.range_deg("left_foot1"), placed, lambda data: _lean_over_feet(infant, data) > lean)


def _lean_over_feet(infant: DrivenInfant, data: mujoco.MjData) -> float:
    """Return where the centre of mass stands over the feet: 0 over the ankles, 1 over the joints of the toes."""
    ankle, toes = (
        np.mean([data.xpos[infant.body(f"{side}_{part}"), 0] for side in SIDES]) for part in ("foot", "toes")
    )
    return float((data.subtree_com[infant.root, 0] - ankle) / (toes - ankle))


def fallen(infant: DrivenInfant, data: mujoco.MjData, forbidden: frozenset[int]) -> str:
    """Return whether a body that must not touch the floor does, or the trunk is tilted too far."""
    tilted = "trunk tilted" if tilt_deg(data, infant.pushed) > MOST_TILT_DEG else ""
    return infant.touching(data, forbidden) or tilted


def kneel(infant: DrivenInfant, elbow_deg: float, thigh_deg: float) -> mujoco.MjData:
    """Return an infant on hands and knees, its shanks flat on the floor and its arms upright.

    The pitch of the trunk that brings hands and knees to the floor together is found by bisection.
    """
    return bisect(
        50.0,
        110.0,
        lambda pitch_deg: infant.placed(
            pitch_deg,
            {
                "{side}_hip1": -pitch_deg - thigh_deg,
                "{side}_knee": -90.0 - thigh_deg,
                "{side}_foot1": -55.0,
                "{side}_shoulder_horizontal": 80.0,
                "{side}_shoulder_ad_ab": pitch_deg,
                "{side}_elbow": elbow_deg,
                "{side}_hand2": 80.0,
                "head_tilt": -30.0,
            },
        ),
        lambda data: infant.lowest_m(data, "left_hand") <= infant.lowest_m(data, "left_lower_leg"),
    )


def on_forearms(infant: DrivenInfant) -> mujoco.MjData:
    """Return an infant on thighs and forearms, which carry the chest; the pitch of its trunk is found by bisection."""
    return bisect(
        30.0,
        95.0,
        lambda pitch_deg: infant.placed(pitch_deg, {"{side}_hip1": 88.0 - pitch_deg, **FOREARMS_DEG}),
        lambda data: infant.lowest_m(data, "left_lower_arm") <= infant.lowest_m(data, "left_upper_leg"),
    )


def drooped(infant: DrivenInfant, data: mujoco.MjData) -> str:
    """Return whether the head of an infant that lies prone touches the floor, or its face is not turned up enough."""
    head = infant.body("head")
    low = "" if elevation_deg(data, head) >= PRONE_UP_DEG - 90.0 else "head too low"
    return infant.touching(data, frozenset({head})) or low


FOREARMS_DEG = {
    "{side}_knee": -10.0,
    "{side}_foot1": -50.0,
    "{side}_shoulder_horizontal": 80.0,
    "{side}_shoulder_ad_ab": 60.0,
    "{side}_elbow": -120.0,
    "head_tilt": -60.0,
}
