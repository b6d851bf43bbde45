"""Infants on their backs or held upright, with weights at the ankles, or with a ribbon from an ankle to a mobile."""

from contextlib import closing
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import mjcf_of, prepare
from mimoc.bundle.variants import Variant
from mimoc.compiler import pipeline
from mimoc.motion.points import SIDES
from mimoc.runtime.env import InfantEnv
from mimoc.studies.experiments.notebook import child

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
    return pipeline.build(child("legs", setup.age_months, scene=scene, actuation=actuation, **senses))


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
