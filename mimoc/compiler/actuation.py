"""The actuators that an actuation model adds to a body, how fast they follow the command, and its changes to joints."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from mimoc.base.kinds import function_of
from mimoc.base.mujoco_layout import AffineBias
from mimoc.body.impairments import reflex_origins
from mimoc.body.origins import Entry, Origin
from mimoc.body.tree import BodyTree, Joint, StretchReflex, as_on_mimos_head
from mimoc.compiler.mjcf.elements import Actuator, PassiveActuator
from mimoc.compiler.mjcf.scene import Keyframe
from mimoc.schema.actuation import ActuationSpec, VoiceEntry
from mimoc.schema.kinds import ACTUATIONS


@dataclass(frozen=True, slots=True)
class ActuationSetup:
    """The actuators of an infant, and its joints with the stiffness and damping that remain beside the actuators."""

    actuators: tuple[Actuator, ...]  # The actuators, in the order of the model.
    defaults: tuple[tuple[str, str], ...]  # Attributes that all actuators share.
    integrator: str  # MuJoCo's integrator: implicit in velocity if the actuators have damping.
    joints: Mapping[str, Joint]  # The hinges by name, with the stiffness and damping that remain beside the actuators.
    reflexes: tuple[PassiveActuator, ...] = ()
    """Actuators that take no commands: the stretch reflexes of spastic muscles."""
    at_rest: Callable[[Keyframe], Keyframe] = lambda keyframe: keyframe  # Returns a state with the actuators at rest.
    origins: Mapping[str, Origin] = field(default_factory=dict)
    """Where numbers come from, by key: `actuator.NAME.ATTRIBUTE` for a setting of an actuator, `joint.NAME.stiffness`
    and `joint.NAME.damping` for what is changed of a joint. Others are put down to the actuation model as such."""


def build_actuation(spec: ActuationSpec, tree: BodyTree, timestep_s: float) -> ActuationSetup:
    """Return what the actuation model of a spec makes of a body."""
    kind = ACTUATIONS[spec.model]
    section = getattr(spec, kind.name) if kind.spec else None
    setup: ActuationSetup = function_of(kind.build, "build")(section, tree, timestep_s)
    setup = _with_reflexes(_with_quick_eyes(setup, tree), tree)
    return setup if spec.arousal == 1 else _at_arousal(setup, spec.arousal)


def quick_joints(tree: BodyTree) -> set[str]:
    """Return the joints whose actuators follow commands within `EYES_S`: by the law `maturing`, those of the eyes."""
    return {joint for joint, group in tree.muscle_groups.items() if group == "eyes" and tree.growth}


def _with_quick_eyes(setup: ActuationSetup, tree: BodyTree) -> ActuationSetup:
    quick = quick_joints(tree) if "dynprm" in dict(setup.defaults) else set[str]()
    actuators, origins = list[Actuator](), dict(setup.origins)
    for actuator in setup.actuators:
        if actuator.joint in quick:
            actuator = replace(actuator, settings=(*actuator.settings, ("dynprm", (EYES_S,))))
            origins[f"actuator.{actuator.name}.dynprm"] = Origin(EYES_RULE, ("spec.development",), "s")
        actuators.append(actuator)
    return replace(setup, actuators=tuple(actuators), origins=origins)


def _with_reflexes(setup: ActuationSetup, tree: BodyTree) -> ActuationSetup:
    if not tree.reflexes:
        return setup
    origins = {
        f"actuator.{reflex.name}.{attribute}": origin
        for reflex in tree.reflexes
        for attribute, origin in reflex_origins(reflex).items()
    }
    return replace(setup, reflexes=tuple(map(_reflex, tree.reflexes)), origins={**setup.origins, **origins})


def _reflex(reflex: StretchReflex) -> PassiveActuator:
    push = reflex.sign * reflex.most_nm
    bias = AffineBias(-reflex.sign * reflex.slope_nms * reflex.threshold_rad_s, 0.0, -reflex.slope_nms)
    return PassiveActuator(reflex.name, reflex.joint, bias, (min(push, 0.0), max(push, 0.0)))


def _at_arousal(setup: ActuationSetup, arousal: float) -> ActuationSetup:
    """Return the actuators of a quiet infant, and its joints, with the muscle tone of some arousal."""
    joints = dict(setup.joints)
    for actuator in setup.actuators:
        if len(actuator.tone) == len(HINGE_TONE):
            joints[actuator.joint] = with_tone(joints[actuator.joint], *((arousal - 1) * x for x in actuator.tone))
    return replace(setup, actuators=tuple(_biased(actuator, arousal) for actuator in setup.actuators), joints=joints)


def _biased(actuator: Actuator, arousal: float) -> Actuator:
    bias = dict(actuator.settings).get("biasprm", ())
    if not actuator.tone or len(actuator.tone) != len(bias):
        return actuator
    changed = tuple(now + (arousal - 1) * tone for now, tone in zip(bias, actuator.tone, strict=True))
    settings = ((name, changed if name == "biasprm" else values) for name, values in actuator.settings)
    return replace(actuator, settings=tuple(settings))


HINGE_TONE = "stiffness", "stiffness x rest angle"  # What the muscle tone of a hinge is.


def with_tone(joint: Joint, stiffness_nm_per_rad: float, moment_nm: float) -> Joint:
    """Return a hinge whose spring has muscle tone, in [N m/rad], and tone x rest angle, in [N m], besides."""
    stiffness = joint.stiffness_nm_per_rad + stiffness_nm_per_rad
    if not stiffness:
        return replace(joint, stiffness_nm_per_rad=0.0)
    rest_rad = joint.stiffness_nm_per_rad * math.radians(joint.springref_deg) + moment_nm
    return replace(joint, stiffness_nm_per_rad=stiffness, springref_deg=math.degrees(rest_rad / stiffness))


MATURING_S = 0.06
"""Time constant of every actuator from birth to 24 months under `maturing`, in [s] (D).

No infant's muscle has been timed. Half-relaxation of the soleus takes 90 ms at 3 years and 40 ms at 10 (Lin, Brown &
Walsh 1994, S), contraction times are an adult's early (McComas, Sica & Petito 1973, S): one constant for both, longer
than an adult's.
"""
EYES_S = 0.01  # Time constant of the motors of eyes under `maturing`, in [s] (D).
EYES_RULE = "infants' saccades follow the main sequence of adults' (Hainline et al. 1984, S; D)"
"""Why they are faster than others."""
AT_ONCE = 0.0  # Time constant of an actuator without an activation.

Settings = tuple[tuple[str, str], ...]

TIME_CONSTANT = "actuator.dynprm"  # Key of the time constant for `mimoc explain`.


def activation(tree: BodyTree, published_s: float) -> Settings:
    """Return the attributes that all actuators of a body share for their activation.

    Under `published`, its time constant is *published_s*, in [s]; `AT_ONCE` is no activation.
    """
    time_constant_s = MATURING_S if tree.development == "maturing" else published_s
    if time_constant_s == AT_ONCE:
        return (("dyntype", "none"),)
    return (("actlimited", "false"), ("dyntype", "filterexact"), ("dynprm", f"{time_constant_s}"))


def activation_origin(tree: BodyTree, published: str) -> dict[str, Origin]:
    """Return where the time constant of a body's actuators comes from, by key; *published* is empty if none is."""
    maturing = "relaxation of the soleus at 3 years (Lin, Brown & Walsh 1994), derived for 0 to 24 months"
    rule = maturing if tree.development == "maturing" else published
    return {TIME_CONSTANT: Origin(rule, ("spec.development",), "s")} if rule else {}


CALM_MONTHS, CALM_HZ = (0.0, 3.0, 6.0, 9.0), (335.0, 445.0, 450.0, 415.0)
"""Mean fundamental frequency of calm sounds by age: Laufer & Horii 1977 (0 to 24 weeks), Kent & Murray 1982 (3, 6 and
9 months). There is none of later months."""
BELOW_CALM = 2**-0.5  # Lowest frequency, relative to that: half an octave below; assumed.
HIGHEST_HZ = 583.0 + 2 * 151.0
"""Mean of the highest frequency of cries, and two standard deviations (1 to 7 days, n 172; Michelsson et al. 2002)."""
LOUDEST_DB = 85.0  # Level of the loudest cry at 1 m; assumed.
MOUTH_M = (0.066, 0.0, 0.02)  # Place of the mouth on MIMo's head, below the nose.


def voice_of(tree: BodyTree) -> VoiceEntry:
    """Return the voice of a body."""
    return VoiceEntry(
        head="head",
        mouth_m=as_on_mimos_head(tree.geoms["head"], MOUTH_M),
        low_hz=BELOW_CALM * float(np.interp(tree.age_months, CALM_MONTHS, CALM_HZ)),
        high_hz=HIGHEST_HZ,
        loudest_db=LOUDEST_DB,
    )


def trace_voice(voice: VoiceEntry | None) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each number of a voice, if there is one."""
    if voice is None:
        return
    calm = "half an octave below calm sounds (Laufer & Horii 1977, Kent & Murray 1982; by how much is assumed)"
    cry = "mean of the highest frequency of cries + 2 SD, 583 + 2 x 151 Hz (Michelsson et al. 2002)"
    rules = {
        "low_hz": Origin(calm, ("spec.actuation.voice", "spec.age_months"), "Hz"),
        "high_hz": Origin(cry, ("spec.actuation.voice",), "Hz"),
        "loudest_db": Origin("a cry at 1 m, assumed", ("spec.actuation.voice",), "dB"),
    }
    for name, origin in rules.items():
        yield f"actuation.voice.{name}", origin.entry(getattr(voice, name))
