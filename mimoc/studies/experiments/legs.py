"""Infants on their backs or held upright, with weights at the ankles, or with a ribbon from an ankle to a mobile."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import mjcf_of, prepare
from mimoc.bundle.variants import Variant
from mimoc.compiler import building
from mimoc.motion.labels import SIDES
from mimoc.movement.filming import SETTLING_S, Film, Filmed
from mimoc.policies.general_movements import Moving
from mimoc.policies.movement_law import LIMBS as POLICY_LIMBS
from mimoc.policies.policy import Policy, PolicyMaker, batch_of_one
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray, Observation
from mimoc.studies.experiment import child

LEG_PARTS = ("upper_leg", "lower_leg", "foot", "toes")
HELD_ARMATURE = 1e9
"""Armature of degrees of freedom that are held, in [kg] and [kg m²]: an infant of 5 kg sinks by .1 mm in a minute."""
MONTHS_PER_WEEK = 12 / 52.1775  # Ages of the literature are in weeks.
MOBILE, RIBBON = "mobile", "ribbon"
RING_M, HANGS_M = 0.5, 0.2
"""Height of the ring that the ribbon runs through, above the hips, and of the mobile below it; a guess."""
MOBILE_KG, MOBILE_N_M, MOBILE_N_S_M = 0.05, 5.0, 0.2
"""Mass of the mobile, stiffness of the arm that it hangs on, and its damping: 1.6 Hz, damping ratio .2; a guess."""


@dataclass(frozen=True, slots=True)
class Setup:
    """The average child of an age, with muscles, and what is done with it."""

    age_months: float
    held: bool = False
    """Whether trunk, head and arms are held upright, the soles on the floor; otherwise it lies on its back."""
    left_kg: float = 0.0  # Weight at the left ankle.
    right_kg: float = 0.0
    tied: Literal["", "left", "right"] = ""  # The leg whose ankle a ribbon ties to a mobile; no leg if empty.
    strength: float = 1.0  # Factor on the strength of the legs.
    feels: bool = False  # Whether it has touch and balance, which reflexes need.


def open_infant(setup: Setup) -> InfantEnv:
    """Return the environment of an infant, not yet reset; there is nothing else in its world."""
    bundle = bundle_of(setup)
    xml, files = mjcf_of(bundle.files, bundle.manifest.scene)
    scene = mujoco.MjSpec.from_string(xml, include=files, assets=files)
    for side, mass_kg in zip(SIDES, (setup.left_kg, setup.right_kg), strict=True):
        if mass_kg:
            ankle = scene.body(f"{side}_foot").pos  # Where the foot turns, in the frame of the shank.
            ball = mujoco.mjtGeom.mjGEOM_SPHERE
            scene.body(f"{side}_lower_leg").add_geom(
                name=f"{side}_weight", type=ball, size=[0.01, 0, 0], pos=ankle, mass=mass_kg, contype=0, conaffinity=0
            )
    if setup.tied:
        _add_mobile(scene, setup.tied)
    model = scene.compile()
    prepare(model)
    if setup.held:
        free = [f"robot:{side}_{joint}" for side in SIDES for joint in ("hip1", "knee", "foot1", "toes")]
        held = np.ones(model.nv, bool)  # All but the legs, which move forwards and backwards only.
        held[[int(model.joint(name).dofadr[0]) for name in free]] = False
        model.dof_armature[held] = HELD_ARMATURE
    return InfantEnv(Variant(bundle, model))


def ribbon_m(env: InfantEnv) -> float:
    """Return the length of the way from the ankle through the ring to the mobile."""
    return float(env.data.ten_length[env.model.tendon(RIBBON).id])


def tie_ribbon(env: InfantEnv, length_m: float) -> None:
    """Give the ribbon a length: while its way is shorter, it is slack and pulls nothing."""
    env.model.tendon_range[env.model.tendon(RIBBON).id, 1] = length_m


def mobile_speed_m_s(env: InfantEnv) -> float:
    """Return how fast the mobile moves up or down."""
    return abs(float(env.data.qvel[env.model.joint(MOBILE).dofadr[0]]))


def legs_of(model: mujoco.MjModel) -> list[int]:
    """Return the bodies of both legs."""
    return [model.body(f"{side}_{part}").id for side in SIDES for part in LEG_PARTS]


def leg_kg(age_months: float) -> float:
    """Return the mass of one leg of the average child."""
    with closing(open_infant(Setup(age_months))) as env:
        return float(env.model.body_mass[legs_of(env.model)].sum() / len(SIDES))


def bundle_of(setup: Setup) -> Bundle:
    """Return the infant without weights, mobile and apparatus."""
    scene = {"kind": "flat", "pose": "standing" if setup.held else "supine"}
    actuation = {"model": "muscle", "strength": {"legs": setup.strength}}
    senses = {"senses": {"touch": {}, "vestibular": {}}} if setup.feels else {}
    return building.build(child("legs", setup.age_months, scene=scene, actuation=actuation, **senses))


def _add_mobile(scene: mujoco.MjSpec, side: str) -> None:
    """Hang a mobile on a springy arm above the hips, with a ribbon through a ring above it to an ankle.

    The ribbon is a spatial tendon of limited length: straight, it pulls at both of its ends; slack, at none.
    """
    world = scene.worldbody
    mobile = world.add_body(name=MOBILE, pos=[0.0, 0.0, RING_M - HANGS_M], gravcomp=1.0)
    slide = mujoco.mjtJoint.mjJNT_SLIDE
    mobile.add_joint(name=MOBILE, type=slide, axis=[0, 0, 1], stiffness=MOBILE_N_M, damping=MOBILE_N_S_M)
    ball = mujoco.mjtGeom.mjGEOM_SPHERE
    mobile.add_geom(name=MOBILE, type=ball, size=[0.02, 0, 0], mass=MOBILE_KG, contype=0, conaffinity=0)
    mobile.add_site(name=MOBILE)
    world.add_site(name="ring", pos=[0.0, 0.0, RING_M])
    ribbon = scene.add_tendon(name=RIBBON, limited=1, range=[0.0, 10.0])
    for site in (f"BODY_25:{side[0].upper()}Ankle", "ring", MOBILE):
        ribbon.wrap_site(site)


LIMBS = ("left_arm", "right_arm", "left_hip", "right_hip", "left_knee", "right_knee")
"""Parts whose drive has a gain of its own; feet and toes are driven with the knee."""
OF_LIMB = {"arm": ("shoulder", "elbow", "wrist", "hand", "fingers"), "hip": ("hip",), "knee": ("knee", "foot", "toes")}
"""Beginnings of the names of actuators, after the side."""
PARTS = {"arm": ("arm",), "leg": ("hip", "knee")}  # Parts of the limbs of the policy, whose bursts begin at one rate.
Forces = Callable[[mujoco.MjData], None]  # Sets forces from outside, which act for a control step.


class Mover:
    """Moves an infant by a policy, and measures how fast its limbs move.

    With the command c of the policy, the command at rest r = clip(0, low, high), and the gain g of an actuator's part,
    the infant is commanded clip(r + g (c - r), low, high). Without a policy of the caller's, it is `general_movements`,
    whose bursts of an arm or a leg can also begin more often: by the geometric mean of the gains of its parts.
    """

    def __init__(self, env: InfantEnv, seed: int, maker: PolicyMaker | None = None, forces: Forces | None = None):
        """Reset the infant, and bind a policy to it; *seed* is that of both."""
        self.env = env
        self._observation: Observation = env.reset(seed=seed)[0]
        self._moving = None if maker else Moving(batch_of_one(env))
        self._policy: Policy = maker(env) if maker else self._move_itself
        self._generator = np.random.default_rng(seed)
        self._forces = forces
        self._limbs = limb_of_actuators(env)
        self._limbs_of_dofs = limb_of_dofs(env.model)
        self._low, self._high = env.actuation.low, env.actuation.high
        self._rest = np.clip(0.0, self._low, self._high)
        self._gains = np.ones(len(LIMBS))
        self._movement, self._since = np.zeros(len(LIMBS)), 0

    def set_gains(self, gains: FloatArray, *, rates: bool = False) -> None:
        """Change the gain of the strength of each part of `LIMBS`, shape (6,), and perhaps of its rate as well."""
        self._gains = np.asarray(gains, np.float64)
        if rates and self._moving:
            self._moving.movement.rate_gains = np.array([[self._rate(limb) for limb in POLICY_LIMBS]])

    def move(self, seconds: float) -> FloatArray:
        """Let time pass; return the configurations after each control step, shape (t, nq)."""
        return np.array([data.qpos.copy() for data in self.steps(seconds)])

    def film(self, seconds: float) -> Filmed:
        """Let time pass, a second of it before the film begins; return what a camera above the infant saw."""
        film = Film()
        for _ in self.steps(SETTLING_S + seconds):
            film.watch(self.env)
        return film.to_recording(self.env.manifest.name)

    def steps(self, seconds: float) -> Iterator[mujoco.MjData]:
        """Yield the state after each control step of some time."""
        for _ in range(round(seconds * self.rate_hz)):
            if self._forces:
                self._forces(self.env.data)
            action = self._policy(self._generator, self._observation)
            gains = np.append(self._gains, 1.0)[self._limbs]
            scaled = np.clip(self._rest + gains * (action - self._rest), self._low, self._high).astype(np.float32)
            self._observation = self.env.step(scaled)[0]
            slots, size = self._limbs_of_dofs + 1, len(LIMBS) + 1
            sums = np.bincount(slots, np.abs(self.env.data.qvel), size)
            speeds = (sums / np.maximum(np.bincount(slots, minlength=size), 1))[1:]
            self._movement = self._movement + speeds
            self._since = self._since + 1
            yield self.env.data

    def take_movement(self) -> FloatArray:
        """Return the mean joint speed of each part of `LIMBS` since this was last asked for, shape (6,), [rad/s]."""
        movement = self._movement / max(self._since, 1)
        self._movement, self._since = np.zeros(len(LIMBS)), 0
        return movement

    @property
    def rate_hz(self) -> float:
        """Control steps per second."""
        return 1000.0 / self.env.manifest.step_ms

    def _move_itself(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        assert self._moving
        return self._moving([generator], observation)[0]

    def _rate(self, limb: str) -> float:
        """Return the gain of the rate of a limb of the policy; 1 for trunk and head."""
        side, _, part = limb.partition("_")
        parts = [LIMBS.index(f"{side}_{name}") for name in PARTS.get(part, ())]
        return float(np.exp(np.log(self._gains[parts]).mean())) if parts else 1.0


def limb_of_actuators(env: InfantEnv) -> np.ndarray:
    """Return the place in `LIMBS` of the limb that each element of an action drives, shape (n,); -1 for none."""
    names = [env.model.actuator(int(index)).name.removeprefix("act:") for index in env.actuation.actuators]
    return np.array([_limb(name) for name in names])


def limb_of_dofs(model: mujoco.MjModel) -> np.ndarray:
    """Return the place in `LIMBS` of the limb that each degree of freedom belongs to, shape (nv,); -1 for none."""
    return np.array([_limb(model.joint(int(joint)).name.removeprefix("robot:")) for joint in model.dof_jntid])


def _limb(name: str) -> int:
    side, _, rest = name.partition("_")
    limbs: Sequence[str] = [part for part, starts in OF_LIMB.items() if rest.startswith(starts)]
    limb = f"{side}_{limbs[0]}" if limbs else ""
    return LIMBS.index(limb) if limb in LIMBS else -1
