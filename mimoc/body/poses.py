"""Starting poses of an infant, and where a body in a pose comes to rest on the ground as it rolls about y."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mimoc.base.geometry.primitives import Extents, girth
from mimoc.base.geometry.rotations import quaternion_from_axis
from mimoc.base.geometry.solvers import narrowed
from mimoc.body import published
from mimoc.body.kinematics import FloatArray, length_m, pose, pose_all
from mimoc.body.reference import CURVES, HEIGHT
from mimoc.body.tree import BodyTree, Joint
from mimoc.fits import measure
from mimoc.fits.tables import settled_deg
from mimoc.schema.names import SIDES

_STEP_RAD = math.radians(0.5)  # Step of pitch in the search for the resting pitch.
_STEPS = 16  # Number of steps that are tried at once.
_NEAR_M_PER_RAD = 6.0
"""A geom that is so much higher than the lowest does not become it: no part of an infant is farther than 1.5 m from
another, so each falls and rises by less than half of this."""
_PRECISION_RAD = 1e-9


@dataclass(frozen=True, slots=True)
class Rollers:
    """The k geoms with which a body touches the ground in each of p poses, in the frame of its hip."""

    centres: FloatArray  # Shape (p, k, 3), [m].
    rotations: FloatArray  # Hip from geom, shape (p, k, 3, 3).
    reach: Extents  # From their centres, shapes (p, k, 3), [m].
    centres_of_mass: FloatArray  # Centre of mass of the whole body, shape (p, 3), [m].

    def rest(self, pitches_rad: FloatArray) -> list[tuple[float, float]]:
        """Return the pitch at which the body comes to rest from others, (p,), and the height of its hip there, in [m].

        It rolls downhill to the next minimum of the height of its centre of mass, as if it were rigid.
        """
        lowest, touching = self._downhill(pitches_rad), self
        lows, highs = lowest - _STEP_RAD, lowest + _STEP_RAD
        for width_rad in (_STEP_RAD, _PRECISION_RAD):
            touching = touching._lowest(lows, highs)
            lows, highs = narrowed(touching._heights, lows, highs, width_rad)
        pitches = [round(pitch, 6) for pitch in ((lows + highs) / 2).tolist()]  # Further digits are noise.
        heights = self._depths(_downs(np.array(pitches)[:, None])).max(axis=(1, 2))
        return list(zip(pitches, heights.tolist(), strict=True))

    def _downhill(self, pitches_rad: FloatArray) -> FloatArray:
        """Return the last pitch in steps from where each pose starts, before it goes uphill, shape (p,)."""
        behind, ahead = self._heights(pitches_rad[:, None] + (-_STEP_RAD, _STEP_RAD)).T
        steps_rad = np.where(behind < ahead, -_STEP_RAD, _STEP_RAD)[:, None]
        paths_rad = pitches_rad[:, None] + steps_rad * np.arange(_STEPS + 1)
        while True:
            rising = np.diff(self._heights(paths_rad), axis=1) >= 0
            onwards = ~rising.any(axis=1)
            if not onwards.any():
                return paths_rad[np.arange(len(paths_rad)), rising.argmax(axis=1)]
            paths_rad[onwards] += paths_rad[onwards, -1:] - paths_rad[onwards, :1]

    def _heights(self, pitches_rad: FloatArray) -> FloatArray:
        """Return the height of the centre of mass above the ground at m pitches of each pose, shape (p, m), [m]."""
        downs = _downs(pitches_rad)
        return self._depths(downs).max(axis=2) - (downs @ self.centres_of_mass[:, :, None])[:, :, 0]

    def _depths(self, downs: FloatArray) -> FloatArray:
        """Return how far each geom reaches from the hip along m directions, shape (p, m, 3), as (p, m, k), [m]."""
        local = np.swapaxes(downs[:, None] @ self.rotations, 1, 2)
        of_geoms = Extents(self.reach.half_edges[:, None], self.reach.half_axes[:, None]).along(local)
        return downs @ np.swapaxes(self.centres, 1, 2) + of_geoms

    def _lowest(self, lows_rad: FloatArray, highs_rad: FloatArray) -> "Rollers":
        """Return this with only the geoms that can be the lowest at pitches within brackets, shapes (p,)."""
        middles_rad = (lows_rad + highs_rad) / 2
        halves_rad = (highs_rad - lows_rad) / 2
        depths_m = self._depths(_downs(middles_rad[:, None]))[:, 0]
        near = depths_m > (depths_m.max(axis=1) - _NEAR_M_PER_RAD * halves_rad)[:, None]
        kept = np.argsort(~near, axis=1)[:, : near.sum(axis=1).max()]
        poses = np.arange(len(kept))[:, None]
        reach = Extents(self.reach.half_edges[poses, kept], self.reach.half_axes[poses, kept])
        return Rollers(self.centres[poses, kept], self.rotations[poses, kept], reach, self.centres_of_mass)


def rollers(tree: BodyTree, poses_rad: Sequence[Mapping[str, float]]) -> Rollers:
    """Return the geoms of a body that can touch the ground, in some poses, given as angles by joint."""
    posed = pose_all(tree, poses_rad)
    solid = posed.solid
    reach, shape = solid.extents, solid.centres.shape
    edges, axes = (np.broadcast_to(array, shape) for array in (reach.half_edges, reach.half_axes))
    return Rollers(solid.centres, solid.rotations, Extents(edges, axes), posed.centre_of_mass)


def _downs(pitches_rad: FloatArray) -> FloatArray:
    """Return the directions of gravity in the frame of a hip that is rotated about y, shape (..., 3)."""
    downs = np.zeros((*pitches_rad.shape, 3))
    downs[..., 0], downs[..., 2] = np.sin(pitches_rad), -np.cos(pitches_rad)
    return downs


@dataclass(frozen=True, slots=True)
class Pose:
    """Joint angles and orientation of the hip."""

    pitch_deg: float  # Rotation of the hip about y: 90 is face down, -90 face up.
    angles_deg: Mapping[str, float]  # Angles by joint, without `robot:`; `{side}` stands for both sides.
    on_feet: bool = False
    """Whether hips that do not straighten bend the knees, such that the soles are flat below the hips."""
    relaxed: bool = True
    """Whether joints without an angle are where their springs are slack; if not, they are straight."""
    held: tuple[str, ...] = ()  # Joints, likewise, that strength holds: without it, an infant leaves this pose.


_TRUNK = ("hip_*", "chest_*", "head_*")
_SEATED = {f"{{side}}_{joint}": angle for joint, angle in (("hip1", -102), ("hip2", -33), ("hip3", 0), ("knee", -25))}
"""A seat in which infants keep their balance, whatever they do with their hands."""
POSES: Mapping[str, Pose] = {
    "supine": Pose(-90, {"head_tilt": 0, "head_swivel": 0}),
    "prone": Pose(90, {}),
    "sitting": Pose(0, {**_SEATED, "hip_bend1": 8, "hip_bend2": 8}, held=(*_TRUNK, "{side}_hip*", "{side}_knee")),
    "standing": Pose(
        0,
        {f"{{side}}_{joint}": 0 for joint in ("hip1", "hip2", "hip3", "knee", "foot1", "foot2", "foot3")},
        on_feet=True,
        held=(*_TRUNK, "{side}_hip*", "{side}_knee", "{side}_foot*"),
    ),
}
"""What is the same at all ages in the poses of infants; `poses_of` adds the angles at which the rest of the body rests.
Joints that do not reach an angle at some age stop at the end of their range. Lumbar joints satisfy their couplings."""

SLUMPED = "slumped"  # How infants sit who cannot hold up trunk and head yet, among the poses of `data/postures.csv`.
SLUMP_DEG: Mapping[str, float] = {"hip_bend1": 10.0, "hip_bend2": 10.0, "head_tilt": 18.0}
"""How much farther forward than in `sitting` a newborn's trunk and head are (D, by eye): its back is one curve."""
SLUMP_MONTHS = (1.0, 4.0)
"""Until when an infant sits as a newborn does, and from when it sits upright if somebody supports it: the curve leaves
the neck, the chest and then the loins (Amiel-Tison; Bly 1994; M); linear between (D)."""


def slumped(age_months: float) -> Pose:
    """Return how the maturing infant of an age sits while somebody supports it, its arms left out."""
    bent, upright = SLUMP_MONTHS
    share = min(1.0, max(0.0, (upright - age_months) / (upright - bent)))
    sitting = POSES["sitting"]
    angles = {joint: sitting.angles_deg.get(joint, 0.0) + share * more for joint, more in SLUMP_DEG.items()}
    return replace(sitting, angles_deg={**sitting.angles_deg, **angles})


FREE_DEG: Mapping[str, Mapping[str, float]] = {
    "supine": {"{side}_shoulder_ad_ab": 75.0, "{side}_fingers": -40.0},
    "prone": {"{side}_hip2": -60.0},
    "sitting": {"{side}_shoulder_ad_ab": 75.0, "{side}_elbow": -90.0},
    "standing": {"{side}_shoulder_ad_ab": 35.0, "{side}_elbow": -60.0},
}
"""Angles at which arms are free of trunk and thighs, hands of forearms and feet of each other, in poses in which they
lie on them."""
FREED, ALIKE = 2.0, 0.01
"""Share of the way to these angles, for each unit by which a child differs in proportion from the average child, beyond
a difference that changes nothing. Fitted to P1 and P99 in length, weight and head, at 0, 6 and 24 months."""

PITCH = "pitch"  # Rotation of the hip about y, among the angles of `data/postures.csv`.
CHEST_JOINT = "robot:chest_lean"  # One of the joints of bodies whose chest has some.
CONTACT_DEPTH_M = 1e-4
"""Penetration depth of a resting body, such that the first physics step already supports its weight."""


def standing_height(tree: BodyTree) -> float:
    """Return the height of the hip above the soles when all joints are at zero, in [m]."""
    return pose(tree, {}).extent(np.array([0.0, 0.0, -1.0]))


def poses_of(tree: BodyTree, upright: bool = True) -> dict[str, Pose]:
    """Return the poses of `POSES` as a body takes them, with the angles at which a body of its age comes to rest.

    Arms of a child of other proportions are lifted off, as they would begin inside its thighs or its trunk. Unless
    *upright*, or by the published law, young infants slump as they sit.
    """
    slumps = not upright and tree.development == "maturing" and tree.age_months < SLUMP_MONTHS[1]
    hands = tree.hands if tree.hands == "five_finger" else "mitten"  # Others' hands were not laid down.
    share = min(1.0, FREED * max(0.0, _disproportion(tree) - ALIKE))
    poses = {}
    for name, wanted in POSES.items():
        row = name
        if slumps and name == "sitting":
            row, wanted = SLUMPED, slumped(tree.age_months)
        settled = settled_deg(tree.development, hands, CHEST_JOINT in tree.joints, row, tree.age_months)
        pitch_deg = settled.pop(PITCH, wanted.pitch_deg)
        for joint, free_deg in FREE_DEG.get(name, {}).items():
            if share and joint in settled:
                settled[joint] += share * (free_deg - settled[joint])
        poses[name] = replace(wanted, pitch_deg=pitch_deg, angles_deg={**settled, **wanted.angles_deg})
    return poses


def _disproportion(tree: BodyTree) -> float:
    """Return how much thicker or thinner the thighs of a body are for its length than the average child's of its age.

    That is the difference of two ratios to the average child: of the girth of a thigh, and of the length of the body.
    """
    average = measure(tree.age_months, CURVES[tree.development])
    girth_m = average["mid_thigh_circumference"]
    height_m = average[HEIGHT]
    if tree.development == "published":
        girth_m = 2 * math.pi * published.thigh(dict(average))[0]
        height_m = published.standing_height(average)
    thighs = [tree.geoms[name] for name in ("left_upper_leg1", "right_upper_leg1") if name in tree.geoms]
    if not thighs:
        return 0.0
    return abs(girth(thighs[0].type, thighs[0].size_m) / girth_m - length_m(tree) / height_m)


def pose_angles(tree: BodyTree, wanted: Pose) -> dict[str, float]:
    """Return the angle of each hinge of *tree* in a pose, in [rad], within its range."""
    named_deg = {
        "robot:" + name.format(side=side): angle for name, angle in wanted.angles_deg.items() for side in SIDES
    }
    angles = {
        name: math.radians(clip(joint, named_deg.get(name, joint.springref_deg if wanted.relaxed else 0.0)))
        for name, joint in tree.joints.items()
    }
    if wanted.on_feet:
        for side in SIDES:
            angles |= _on_foot(tree, side, angles)
    return angles


def clip(joint: Joint, angle_deg: float) -> float:
    """Return the angle within a joint's range that is nearest to the given one, in degrees."""
    low, high = joint.range_deg
    return min(max(angle_deg, low), high)


def _on_foot(tree: BodyTree, side: str, angles: Mapping[str, float]) -> dict[str, float]:
    """Return the angles of knee and ankle of a leg whose hip may not straighten, in [rad].

    The knee is bent so that the ankle is below the hip, and the ankle such that the sole is parallel to the ground.
    """
    hip, knee, ankle = (f"robot:{side}_{joint}" for joint in ("hip1", "knee", "foot1"))
    bodies = {body.name: body for body in tree.bodies}
    if not {hip, knee, ankle} <= set(angles):
        return {}
    thigh_m, shank_m = (math.dist(bodies[f"{side}_{end}"].pos_m, (0, 0, 0)) for end in ("lower_leg", "foot"))
    forward = -angles[hip]
    bent = forward + math.asin(max(-1.0, min(1.0, thigh_m / shank_m * math.sin(forward))))
    return {
        knee: math.radians(clip(tree.joints[knee], -math.degrees(bent))),
        ankle: math.radians(clip(tree.joints[ankle], math.degrees(bent - forward))),
    }


def resting_state(tree: BodyTree, wanted: Pose) -> tuple[float, ...]:
    """Return a pose at rest on the ground as qpos: position and quaternion of the hip, then the hinges."""
    (state,) = resting_states(tree, [wanted])
    return state


def resting_states(tree: BodyTree, wanted: Sequence[Pose]) -> list[tuple[float, ...]]:
    """Return some poses at rest on the ground as qpos; see `resting_state`.

    The body, as if it were rigid, rolls about y to the minimum of the height of its centre of mass that is downhill
    from the pitch of each pose.
    """
    poses_rad = [pose_angles(tree, start) for start in wanted]
    rests = rollers(tree, poses_rad).rest(np.array([math.radians(start.pitch_deg) for start in wanted]))
    return [
        (0.0, 0.0, height_m - CONTACT_DEPTH_M, *quaternion_from_axis((0.0, 1.0, 0.0), pitch_rad), *angles.values())
        for angles, (pitch_rad, height_m) in zip(poses_rad, rests, strict=True)
    ]
