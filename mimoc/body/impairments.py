"""What impairments make of a healthy child's body: weaker motors, narrower ranges, less tone, stretch reflexes.

A spastic muscle resists the more, the faster it is stretched (Lance 1980). Its reflex is a torque against the speed w
of its joint, from a threshold w_0 on and within the strength T of a healthy muscle,

    tau = min(max(gain K c (w - w_0), 0), T)

with the damping c of the relaxed joint, which grows with the child (`mimoc.body.joints`). It is none of the motor's: it
answers whatever is commanded, at any arousal, and at once (a stretch reflex takes some 20 ms, which is left out).
"""

from collections.abc import Mapping
from dataclasses import replace

from mimoc.base.errors import ContractureError
from mimoc.body.joints import MAX_MARGIN_SHARE
from mimoc.body.origins import Origin
from mimoc.body.tree import BodyTree, Joint, Motor, StretchReflex, Tone
from mimoc.schema.impairments import PRETERM_WEEKS, ImpairmentsSpec, ToneSpec
from mimoc.schema.names import RANGED, SIDES, in_regions

KEY = "spec.impairments"
REFLEX = 2.6
"""K: such that spastic knees swing, from straight, at .69 of the peak speed of healthy ones at 18 months, as those of
children with cerebral palsy do (202 and 293 degrees/s, White et al. 2007, Gait Posture 26: 97-105; fitted)."""
THRESHOLD_RAD_S = 1.0  # w_0, an assumption: slow movements stretch without a reflex.
SPASTIC: Mapping[str, tuple[int, ...]] = {"elbow": (-1,), "hip1": (-1,), "hip2": (1,), "foot1": (-1,)}
"""Signs of the torques of the muscles that are spastic at some joints: flexors of elbow and hip, adductors, and those
that point the foot (clinical pattern of spasticity; from memory, so an assumption). At all others, both ways are."""
MIN_PRETERM_TONE, MIN_WEEKS = 0.5, 25.0
"""Share of newborn tone that is left at term of children born that early; at birth from 37 weeks on all of it, and in
proportion between. That preterm infants have less flexor tone at term was found by Palmer et al. 1982 (Neuropediatrics
13: 183-189) and Ricci et al. 2008 (Early Hum Dev 84: 751-761); how much less is an assumption."""


def impair(tree: BodyTree, impairments: ImpairmentsSpec) -> BodyTree:
    """Return the impaired body of a child from a healthy one of its corrected age, or raise a ContractureError."""
    asked = impairments.complete
    joints = dict(tree.joints)
    tones = in_regions(asked.tone, joints)
    reflexes = tuple(
        reflex
        for motor in tree.motors
        if (said := tones.get(motor.joint)) and said[1].kind == "spastic"
        for reflex in _reflexes(motor, joints[motor.joint], said[1].amount, _key(impairments, "tone", said[0]))
    )
    for name, (region, tone) in tones.items():
        if tone.kind == "hypotonic":
            joints[name] = _floppy(joints[name], tone.amount, _key(impairments, "tone", region))
    for movement, range_deg in asked.range.items():
        if RANGED[movement] in joints:
            joints[RANGED[movement]] = _contracted(
                joints[RANGED[movement]], movement, range_deg, _key(impairments, "range", movement)
            )
    weak = in_regions(asked.weakness, [motor.joint for motor in tree.motors])
    newborn_tone = _preterm_tone(impairments)
    motors = (_impaired_motor(motor, impairments, weak, tones, newborn_tone) for motor in tree.motors)
    bodies = (replace(body, joints=tuple(joints[joint.name] for joint in body.joints)) for body in tree.bodies)
    seen: Mapping[str, float] = {**asked.acuity}
    eyes = {f"{side}_eye": seen.get(f"{side}_eye", seen.get("eyes", 1.0)) for side in SIDES}
    return replace(
        tree,
        bodies=tuple(bodies),
        motors=tuple(motors),
        reflexes=reflexes,
        acuity=tuple((eye, share) for eye, share in eyes.items() if share < 1),
        field_deg=tuple(sorted(asked.field_deg.items())),
    )


def _key(impairments: ImpairmentsSpec, section: str, name: str) -> str:
    """Return the key of the spec that says something: that of the preset, if it does."""
    leaf = ".kind" if section == "tone" else ""
    return f"{KEY}.{section}.{name}{leaf}" if name in getattr(impairments, section) else f"{KEY}.preset"


def _impaired_motor(
    motor: Motor,
    impairments: ImpairmentsSpec,
    weak: Mapping[str, tuple[str, float]],
    tones: Mapping[str, tuple[str, ToneSpec]],
    newborn_tone: float,
) -> Motor:
    if motor.joint in weak:
        region, share = weak[motor.joint]
        factors = (*motor.factors, (_key(impairments, "weakness", region), share))
        fmax = tuple(force * share for force in motor.fmax)
        motor = replace(motor, gear_nm=motor.gear_nm * share, fmax=fmax, factors=factors)
    if motor.tone is None:
        return motor
    tone = motor.tone
    if newborn_tone < 1:
        tone = _less(tone, newborn_tone, f"{KEY}.{impairments.birth_key}")
    if motor.joint in tones and tones[motor.joint][1].kind == "hypotonic":
        region, hypotonic = tones[motor.joint]
        tone = _less(tone, hypotonic.amount, _key(impairments, "tone", region))
    return replace(motor, tone=tone)


def _less(tone: Tone, share: float, key: str) -> Tone:
    stiffness = tone.stiffness_nm_per_rad * share
    return replace(tone, stiffness_nm_per_rad=stiffness, factors=(*tone.factors, (key, share)))


def _preterm_tone(impairments: ImpairmentsSpec) -> float:
    weeks = impairments.complete.gestation_weeks
    if weeks is None:
        return 1.0
    missing = min(max(PRETERM_WEEKS - weeks, 0.0) / (PRETERM_WEEKS - MIN_WEEKS), 1.0)
    return 1 - (1 - MIN_PRETERM_TONE) * missing


def _floppy(joint: Joint, share: float, key: str) -> Joint:
    why = ("stiffness", f" x {share:g}, since the muscles are hypotonic ({key})", key)
    return replace(joint, stiffness_nm_per_rad=joint.stiffness_nm_per_rad * share, changes=(*joint.changes, why))


def _contracted(joint: Joint, movement: str, range_deg: tuple[float, float], key: str) -> Joint:
    """Return a joint with what is left of its range at this age."""
    low, high = joint.range_deg
    left = max(low, range_deg[0]), min(high, range_deg[1])
    if left[0] >= left[1]:
        raise ContractureError(
            movement,
            f"a healthy child of this age moves from {low:.0f} to {high:.0f} degrees, of which [{range_deg[0]:g}, "
            f"{range_deg[1]:g}] leaves nothing; give a range within it",
        )
    changes = tuple(
        (attribute, f"; within [{range_deg[0]:g}, {range_deg[1]:g}] degrees, a contracture ({key})", key)
        for attribute in ("range", "springref")
    )
    margin_deg = min(joint.margin_deg, MAX_MARGIN_SHARE * (left[1] - left[0]))
    rest_deg = min(max(joint.springref_deg, left[0]), left[1])
    return replace(
        joint, range_deg=left, springref_deg=rest_deg, margin_deg=margin_deg, changes=(*joint.changes, *changes)
    )


def _reflexes(motor: Motor, joint: Joint, gain: float, key: str) -> list[StretchReflex]:
    stem = joint.name.removeprefix("robot:").partition("_")[2]
    reflexes = []
    for sign in SPASTIC.get(stem, (-1, 1)):
        most_nm = motor.gear_nm * abs(motor.force_range[0 if sign < 0 else 1])
        slope_nms = gain * REFLEX * joint.damping_nms_per_rad
        if most_nm and slope_nms:
            reflexes.append(StretchReflex(joint.name, sign, slope_nms, THRESHOLD_RAD_S, most_nm, key, motor.name))
    return reflexes


def reflex_origins(reflex: StretchReflex) -> dict[str, Origin]:
    """Return where the numbers of a stretch reflex come from, by attribute in MJCF."""
    slope = (
        f"stretch reflex of a spastic muscle: gain x {REFLEX:g} x damping of the joint, from {THRESHOLD_RAD_S:g} rad/s "
        "on (fitted to the pendulum test of children with cerebral palsy, White et al. 2007; the threshold is assumed)"
    )
    return {
        "biasprm": Origin(slope, (f"joint.{reflex.joint}.damping", reflex.key)),
        "forcerange": Origin("up to the torque of its muscle in a healthy child", (f"actuator.{reflex.motor}.gear",)),
    }
