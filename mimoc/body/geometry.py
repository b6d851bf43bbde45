"""Shapes, joints and centres of the parts, from an infant's proportions.

Everything is written for the right side, in MIMo's frames: x forward, y left, z up on trunk and legs;
along the limb on the arms. Numbers are the reference body's, in m.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from mimoc.body.proportions import CLEARANCE_M, Foot, Hand, Limb, Proportions, Trunk
from mimoc.body.tree import Vec3
from mimoc.errors import GeometryError

REFERENCE_HEAD_RADIUS_M = 0.0735


@dataclass(frozen=True, slots=True)
class Solid:
    """Size and centre of a geom, as MuJoCo wants them."""

    size_m: tuple[float, ...]
    pos_m: Vec3


@dataclass(frozen=True, slots=True)
class Layout:
    """Where things are on the right side, by their names in `anatomy`."""

    origins: Mapping[str, Vec3] = field(default_factory=dict)
    """Bodies, in the frame of their parent."""
    solids: Mapping[str, Solid] = field(default_factory=dict)
    """Geoms, in the frame of their body."""
    anchors: Mapping[str, Vec3] = field(default_factory=dict)
    """Joints that do not turn about the origin of their body."""

    def __or__(self, other: "Layout") -> "Layout":
        """Return both layouts as one."""
        return Layout(
            {**self.origins, **other.origins},
            {**self.solids, **other.solids},
            {**self.anchors, **other.anchors},
        )


def lay_out(p: Proportions) -> Layout:
    """Return the layout of a whole body.

    Raises:
        GeometryError: If a segment is wider than it is long.
    """
    return (
        _lay_out_trunk(p.trunk, p.head_radius_m)
        | _lay_out_head(p.trunk, p.head_radius_m)
        | _lay_out_arm(p)
        | _lay_out_hand(p.hand, p.forearm)
        | _lay_out_leg(p)
        | _lay_out_foot(p.foot, p.shank)
    )


def _lay_out_trunk(t: Trunk, head_radius_m: float) -> Layout:
    z = t.axial
    depth = t.pelvis[0] / 0.048
    neck = head_radius_m / REFERENCE_HEAD_RADIUS_M
    bend = {
        f"robot:hip_{motion}{level}": (0.0, 0.0, -0.05 * z) for motion in ("lean", "rot", "bend") for level in (1, 2)
    }
    return Layout(
        origins={
            "hip": (0.0, 0.0, 0.0),
            "lower_body": (0.002 * depth, 0.0, 0.076 * z),
            "upper_body": (-0.002 * depth, 0.0, 0.091 * z),
            "chest": (0.0, 0.0, 0.090 * z),
        },
        solids={
            "lb": _across(t.pelvis, -0.002 * depth, 0.005 * z),
            "cb": _across(t.waist, 0.005 * depth, -0.008 * z),
            "ub1": _across(t.belly, 0.007 * depth, -0.032 * z),
            "ub2": _across(t.ribs, 0.004 * depth, 0.030 * z),
            "neck": Solid((0.028 * neck, 0.02 * z), (-0.004 * neck, 0.0, 0.125 * z)),
            "ub3": _across(t.girdle, 0.0, 0.0),
        },
        anchors=bend,
    )


def _lay_out_head(t: Trunk, radius_m: float) -> Layout:
    s = radius_m / REFERENCE_HEAD_RADIUS_M
    return Layout(
        origins={"head": (0.0, 0.0, 0.135 * t.axial), "{side}_eye": (0.07 * s, -0.0245 * s, 0.067375 * s)},
        solids={
            "head": Solid((radius_m,), (0.01 * s, 0.0, radius_m)),
            "geom:{side}_eye1": Solid((0.01125 * s,), (0.0, 0.0, 0.0)),
        },
        anchors={"robot:head_tilt": (0.0, 0.0, 0.0123 * s), "robot:head_tilt_side": (0.0, 0.0, 0.0245 * s)},
    )


def _lay_out_arm(p: Proportions) -> Layout:
    depth = p.trunk.girdle[0] / 0.041
    return Layout(
        origins={
            "{side}_upper_arm": (-0.005 * depth, -p.trunk.shoulder_y_m, 0.003 * p.trunk.axial),
            "{side}_lower_arm": (0.0, 0.0, p.upper_arm.length_m),
            "{side}_hand": (0.0, -0.7 * p.hand.half_thickness_m, p.forearm.length_m),
        },
        solids={
            "{side}_uarm1": _along("upper arm", p.upper_arm, p.forearm.radius_m),
            "{side}_larm": _along("forearm", p.forearm, p.hand.half_thickness_m),
        },
        anchors={
            "robot:{side}_shoulder_horizontal": (0.0, -p.upper_arm.radius_m, 0.0),
            "robot:{side}_hand1": (0.0, 0.7 * p.hand.half_thickness_m, 0.0),
        },
    )


def _lay_out_hand(h: Hand, forearm: Limb) -> Layout:
    """Return palm and fingers, which end at the hand's length in a tip as round as the hand is thick."""
    tip_m = h.half_thickness_m + 2 * CLEARANCE_M
    palm_m = (h.length_m - tip_m) * 0.0416 / 0.083
    fingers_m = h.length_m - tip_m - palm_m
    if h.length_m <= 4 * tip_m:
        raise GeometryError(f"a hand {h.length_m:.3f} m long cannot be {2 * h.half_thickness_m:.3f} m thick")
    thumb_m = 0.5 * h.half_thickness_m
    rim_m = h.half_fist_m - 2 * CLEARANCE_M
    return Layout(
        origins={"{side}_fingers": (0.0, 0.0, palm_m)},
        solids={
            "geom:{side}_hand1": Solid((h.half_fist_m, h.half_thickness_m, palm_m / 2), (thumb_m, 0.0, palm_m / 2)),
            "geom:{side}_hand2": Solid((tip_m, rim_m), (thumb_m, 0.0, palm_m)),
            "geom:{side}_fingers1": Solid(
                (h.half_breadth_m - 2 * CLEARANCE_M, h.half_thickness_m, fingers_m / 2), (0.0, 0.0, fingers_m / 2)
            ),
            "geom:{side}_fingers2": Solid((tip_m, h.half_breadth_m), (0.0, 0.0, fingers_m)),
        },
    )


def _lay_out_leg(p: Proportions) -> Layout:
    thigh, shank = p.thigh, p.shank
    depth = p.trunk.pelvis[0] / 0.048
    into_foot_m = shank.length_m + 0.6 * p.foot.half_height_m
    lower_start_m, lower_end_m = 0.6 * shank.length_m, into_foot_m - p.ankle_radius_m
    if lower_end_m <= lower_start_m:
        raise GeometryError(
            f"a shank {shank.length_m:.3f} m long cannot have an ankle {2 * p.ankle_radius_m:.3f} m thick"
        )
    return Layout(
        origins={
            "{side}_upper_leg": (0.005 * depth, -p.trunk.hip_y_m, -0.007 * p.trunk.axial),
            "{side}_lower_leg": (0.0, 0.0, -thigh.length_m),
            "{side}_foot": (0.0, 0.0, -shank.length_m),
        },
        solids={
            "geom:{side}_upper_leg1": _flip(_along("thigh", thigh, shank.radius_m)),
            "geom:{side}_lower_leg1": Solid(
                (shank.radius_m, 0.044 / 0.177 * shank.length_m), (0.0, 0.0, -0.044 / 0.177 * shank.length_m)
            ),
            "geom:{side}_lower_leg2": Solid(
                (p.ankle_radius_m, (lower_end_m - lower_start_m) / 2), (0.0, 0.0, -(lower_start_m + lower_end_m) / 2)
            ),
        },
    )


def _lay_out_foot(f: Foot, shank: Limb) -> Layout:
    """Return heel, sole and toes, spread along x so that the foot has its length."""
    heel_m, toe_m = f.half_breadth_m - CLEARANCE_M, f.half_height_m
    s = (f.length_m - heel_m - toe_m) / 0.084
    if s <= 0:
        raise GeometryError(f"a foot {f.length_m:.3f} m long cannot be {2 * f.half_breadth_m:.3f} m wide")
    half_width_m, half_height_m = f.half_breadth_m, f.half_height_m
    ankle = (0.0, 0.0, 1.5 * half_height_m)
    return Layout(
        origins={"{side}_toes": (0.054 * s, 0.0, 0.0)},
        solids={
            "geom:{side}_foot1": Solid((heel_m, half_height_m - CLEARANCE_M), (-0.016 * s, 0.0, 0.0)),
            "geom:{side}_foot2": Solid((0.035 * s, half_width_m, half_height_m), (0.019 * s, 0.0, 0.0)),
            "geom:{side}_foot3": Solid(
                (half_height_m - CLEARANCE_M, half_width_m - 2 * CLEARANCE_M), (0.054 * s, 0.0, 0.0)
            ),
            "geom:{side}_toes1": Solid(
                (0.007 * s, half_width_m - CLEARANCE_M, half_height_m - CLEARANCE_M), (0.007 * s, 0.0, 0.0)
            ),
            "geom:{side}_toes2": Solid((toe_m, half_width_m), (0.014 * s, 0.0, 0.0)),
        },
        anchors={f"robot:{{side}}_foot{k}": ankle for k in (1, 2, 3)},
    )


def _across(section: tuple[float, float], x_m: float, z_m: float) -> Solid:
    """Return a capsule along y from its radius and half width."""
    radius_m, half_width_m = section
    if half_width_m <= radius_m:
        raise GeometryError(f"a trunk {2 * half_width_m:.3f} m wide cannot be {2 * radius_m:.3f} m deep")
    return Solid((radius_m, half_width_m - radius_m), (x_m, 0.0, z_m))


def _along(what: str, limb: Limb, embed_m: float) -> Solid:
    """Return a capsule along +z whose axis starts at its joint and which ends *embed_m* past the next one."""
    axis_m = limb.length_m + embed_m - limb.radius_m
    if axis_m <= 0:
        raise GeometryError(f"{what}: a limb {limb.length_m:.3f} m long cannot be {2 * limb.radius_m:.3f} m thick")
    return Solid((limb.radius_m, axis_m / 2), (0.0, 0.0, axis_m / 2))


def _flip(solid: Solid) -> Solid:
    """Return the same solid hanging down instead of standing up."""
    x_m, y_m, z_m = solid.pos_m
    return Solid(solid.size_m, (x_m, y_m, -z_m))
