"""The trunk from pelvis to shoulders: level sections that have the measured girths and breadths."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from mimoc.anatomy.part import REST_ABDUCTION_DEG
from mimoc.base.errors import GeometryError

CLEARANCE_M = 1e-4
"""Distance by which a part is made smaller than its neighbour where their surfaces would coincide (MIMo v2)."""

Section = tuple[float, float]
"""Radius and half width of a capsule along y, caps included, in [m]: a level cut through it is a stadium."""

CHEST, WAIST, HIP = 2.939, 2.730, 2.815
"""Girth over breadth of each section: means over the seven infant groups of AnthroKids, the hip's 1 % more (D). Those
of single groups scatter by 4 % (chest 2.84 to 3.04) because breadths and girths come from different children, so one
ratio keeps the shape of a body steady as it grows; the waist's breadth is `WAIST_BREADTH`."""
WAIST_BREADTH = 0.93  # Breadth of the waist over `hip_breadth`, which was not measured on infants (D).

ROUNDEST = 3.087
"""Largest girth over breadth of a section: the straight part is then 5 % of the radius; a circle has pi."""
FLATTEST = 2.2  # Smallest girth over breadth of a section: it is then three times as broad as deep.
GIVE = 0.04  # How far girth and breadth may be from those asked for where both cannot be had.

JOINT_SPACING = 0.866
"""Distance of the shoulder joints over `shoulder_breadth`, taken over the deltoids: MIMo's at 18 months (S)."""
DELTOID_BREADTH = 1.01
"""Breadth over hanging upper arms, over `shoulder_breadth`, unless the arms at rest would touch the chest."""

GIRDLE = 0.62  # Radius of the shoulder girdle over that of the chest: MIMo's radius at 18 months.
SHOULDER_BACK = 0.5  # How far the shoulder joints are behind the middle of the chest, in its radii (D).
GIRDLE_BACK = SHOULDER_BACK / 2  # How far the shoulder girdle is behind the middle of the chest, in its radii (D).
SHOULDER_ABOVE_CHEST_M = 0.063  # Height of the shoulder joints above the middle of the chest in the reference body.

DEEPEST_PELVIS, DEEPEST_CHEST = 0.21, 0.26
"""Largest radii over the height between head and rump; those of the average child are at most .18 and .19."""
USUAL_PELVIS = 0.18  # Radius of the pelvis over the same height up to which the hip joints move back with it (D).
NO_ROOM = "crown_rump_length leaves no room for a trunk below this head"

RUMP = 0.62  # Height of the hip joints above the lowest point of the pelvis, in its radii.
BUTTOCKS = 0.73
"""Distance of the hip joints from the back of the pelvis, in its radii. Together with `RUMP` it makes rump-sole,
rump-knee and knee-sole length come out right at all ages (D)."""
HIP_SPACING = 0.52
"""Distance of the hip joints over `hip_breadth`, such that the thighs do not make the hips broader (D; MIMo .60)."""


@dataclass(frozen=True, slots=True)
class Trunk:
    """Pelvis to shoulders: sections, and the places of the joints of the limbs."""

    axial: float  # Spacing of the trunk's bodies along z, 1 in the reference body.
    pelvis: Section
    waist: Section
    belly: Section
    ribs: Section
    girdle: Section
    shoulder_y_m: float  # Distance from the midline to the shoulder joint.
    arm_inwards_m: float
    """How much nearer to the midline than its joint the upper arm's axis is; negative in stout children."""
    hip_y_m: float  # Distance from the midline to the hip joint.
    rump_m: float  # Height of the hip joint above the lowest point of the pelvis.
    buttocks_m: float  # Distance from the hip joint to the back of the pelvis.


def measured_trunk(
    m: Mapping[str, float], base: Mapping[str, float], head_radius_m: float, arm_radius_m: float
) -> Trunk:
    """Return the trunk of a child: sections from girths and breadths, height from crown-rump length and head.

    Measurements are in [m], by AnthroKids name; *base* has them before any was replaced. Raises a GeometryError if a
    measurement does not fit the others.
    """
    room_m = m["crown_rump_length"] - 2 * head_radius_m
    pelvis = section("hip", m, base, ("hip_circumference", "hip_breadth"), HIP)
    pelvis = _no_deeper(pelvis, DEEPEST_PELVIS * room_m)
    waist = section("waist", m, base, ("waist_circumference", "hip_breadth"), WAIST, WAIST_BREADTH)
    ribs = section("chest", m, base, ("chest_circumference", "chest_breadth"), CHEST)
    ribs = _no_deeper(ribs, DEEPEST_CHEST * room_m)
    axial = axial_spacing(m["crown_rump_length"], head_radius_m, pelvis[0])
    shoulder_y_m = JOINT_SPACING / 2 * m["shoulder_breadth"]
    wanted_m = shoulder_y_m + arm_radius_m - DELTOID_BREADTH / 2 * m["shoulder_breadth"]
    room_inwards_m = room_beside(  # Until an arm at rest touches the chest.
        outwards_m=shoulder_y_m - ribs[1] + ribs[0],
        above_m=SHOULDER_ABOVE_CHEST_M * axial,
        behind_m=SHOULDER_BACK * ribs[0],
        apart_m=ribs[0] + arm_radius_m + CLEARANCE_M,
    )
    inwards_m = min(wanted_m, room_inwards_m)
    # The axes of the upper arms are as far behind the girdle as it is behind the chest.
    radius_m = GIRDLE * ribs[0]
    beside_m = math.sqrt((radius_m + arm_radius_m + CLEARANCE_M) ** 2 - (GIRDLE_BACK * ribs[0]) ** 2)
    return Trunk(
        axial=axial,
        pelvis=pelvis,
        waist=waist,
        belly=ribs,
        ribs=ribs,
        girdle=(radius_m, shoulder_y_m - inwards_m - beside_m + radius_m),
        shoulder_y_m=shoulder_y_m,
        arm_inwards_m=inwards_m,
        hip_y_m=HIP_SPACING / 2 * m["hip_breadth"],
        rump_m=RUMP * pelvis[0],
        buttocks_m=pelvis[0] - (1 - BUTTOCKS) * min(pelvis[0], USUAL_PELVIS * room_m),
    )


def _no_deeper(wanted: Section, radius_m: float) -> Section:
    """Return a section with at most this radius, at least half of its own, narrower by half of what it is less deep."""
    if radius_m <= wanted[0] / 2:
        raise GeometryError(NO_ROOM)
    factor = min(1.0, radius_m / wanted[0])
    return wanted[0] * factor, wanted[1] * math.sqrt(factor)


def room_beside(
    outwards_m: float, above_m: float, behind_m: float, apart_m: float, abduction_deg: float = REST_ABDUCTION_DEG
) -> float:
    """Return how far an arm at rest can be moved towards the midline until its axis is so near that of the chest.

    Seen along the arm, its axis and the end of the chest's axis are points, *outwards_m*, *above_m* and *behind_m* from
    each other; the chest is the lower of the two, and *apart_m* the distance that is kept.
    """
    tilt_rad = math.radians(abduction_deg)
    beside_m = outwards_m * math.cos(tilt_rad) + above_m * math.sin(tilt_rad)
    return beside_m - math.sqrt(max(apart_m**2 - behind_m**2, 0.0))


def section(
    what: str,
    m: Mapping[str, float],
    base: Mapping[str, float],
    names: tuple[str, str],
    ratio: float,
    narrower: float = 1.0,
) -> Section:
    """Return the section that has a measured girth and breadth, by their *names*, or is that much *narrower*.

    Both are changed by up to 2 % such that an average child has the given ratio of girth over breadth, but for those
    that were replaced since *base*.

    Raises:
        GeometryError: If it would be deeper than broad, or too flat.
    """
    girth, breadth = names
    even = math.sqrt(ratio * narrower * base[breadth] / base[girth])
    girth_m = m[girth] * (even if m[girth] == base[girth] else 1.0)
    breadth_m = narrower * m[breadth] / (even if m[breadth] == base[breadth] else 1.0)
    return stadium(what, girth_m, breadth_m)


def stadium(what: str, girth_m: float, breadth_m: float) -> Section:
    """Return the section of girth 2 pi r + 4 h and breadth 2 (r + h), within `GIVE`, or raise a GeometryError."""
    asked = girth_m / breadth_m
    possible = min(max(asked, FLATTEST), ROUNDEST)
    give = math.sqrt(possible / asked)
    if abs(give - 1) > GIVE:
        least_m = girth_m / ROUNDEST / (1 + GIVE) ** 2
        most_m = girth_m / FLATTEST * (1 + GIVE) ** 2
        raise GeometryError(
            f"a {what} {girth_m:.3f} m around cannot be {breadth_m:.3f} m broad, but {least_m:.3f} to {most_m:.3f} m"
        )
    girth_m, breadth_m = girth_m * give, breadth_m / give
    return (girth_m - 2 * breadth_m) / (2 * (math.pi - 2)), breadth_m / 2


def axial_spacing(crown_rump_m: float, head_radius_m: float, pelvis_radius_m: float) -> float:
    """Return the spacing of the trunk's bodies.

    The lowest point of the pelvis lies one radius below .005 axial, the head's at .302 axial, both from the hip's
    origin.
    """
    return (crown_rump_m - 2 * head_radius_m - pelvis_radius_m) / (0.302 - 0.005)
