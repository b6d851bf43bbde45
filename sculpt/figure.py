"""The figure of a child of nine months, sculpted on its solids in the pose that its skin is bound in.

Lengths are mm; frames are those of the bodies of the right side, since the figure is symmetric.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from fields import Array, Field, Solid, column, ellipsoid, moved, rounded_box, smooth_max, smooth_min, tube

from mimoc.body.kinematics import Frame

TRUNK = column(
    (  # height, back, front, half width, widest place
        (-60.0, -44.0, 54.0, 63.0, 0.45),
        (-20.0, -48.0, 61.0, 71.0, 0.45),
        (4.5, -49.0, 65.0, 77.0, 0.45),
        (45.0, -44.5, 68.5, 83.5, 0.47),
        (85.0, -46.0, 69.5, 82.5, 0.50),
        (127.6, -54.0, 67.0, 74.5, 0.48),
        (175.8, -57.0, 63.0, 65.5, 0.46),
        (210.0, -53.0, 50.0, 60.0, 0.45),
        (238.0, -45.0, 27.0, 50.0, 0.45),
        (262.0, -36.0, 12.0, 38.0, 0.45),
    ),
    power=2.25,
)


@dataclass(frozen=True)
class Figure:
    """The shapes of a body, by what they are blended with."""

    solids: tuple[Solid, ...]
    joints: Mapping[str, Array]

    def field(self) -> Field:
        """Return all of it."""
        return lambda p: blend(self.solids, folded(p))


BLENDS = {"trunk": 9.0, "seat": 22.0, "neck": 18.0, "girdle": 26.0}
"""How far the shapes of the trunk are blended with one another."""
FINGERS = 0.9  # How far fingers are blended with one another: hardly, or they are webbed.


def folded(p: Array) -> Array:
    """Return points on the right side."""
    return p * (1, -1, 1) if (p[:, 1] > 0).all() else np.column_stack((p[:, 0], -np.abs(p[:, 1]), p[:, 2]))


def blend(solids: tuple[Solid, ...], p: Array) -> Array:
    """Return the figure at points on the right side: each limb blended in itself, then with the trunk."""
    by_group: dict[str, list[Field]] = {}
    for solid in solids:
        by_group.setdefault(solid.group, []).append(solid.field)
    trunk = _joined(by_group["trunk"], BLENDS["trunk"], p)
    for group in ("seat", "neck", "girdle"):
        for field in by_group[group]:
            trunk = smooth_min(trunk, field(p), BLENDS[group])
    arm = _joined(by_group["arm"], 9.0, p)
    hand = _joined(by_group["palm"], 6.0, p)
    hand = smooth_min(hand, _joined(by_group["finger"], FINGERS, p), 4.0)
    arm = smooth_min(arm, hand, 8.0)
    leg = _joined(by_group["leg"], 9.0, p)
    foot = _joined(by_group["foot"], 9.0, p)
    toes = _joined(by_group["toe"], 1.0, p)
    foot = smooth_max(smooth_min(foot, toes, 4.0), by_group["sole"][0](p), 4.0)
    leg = smooth_min(leg, foot, 13.0)
    return np.minimum(smooth_min(trunk, arm, 30.0), smooth_min(trunk, leg, 34.0))


def _joined(fields: list[Field], k: float, p: Array) -> Array:
    joined = fields[0](p)
    for field in fields[1:]:
        joined = smooth_min(joined, field(p), k)
    return joined


def build(frames: Mapping[str, Frame], hands: str) -> Figure:
    """Return the figure with a kind of hands, from origin and rotation of each body in the frame of the hip, [m]."""

    def at(part: str, field: Field) -> Field:
        origin, turn = frames[part.format(side="right")]
        return moved(field, origin * 1000, turn)

    shapes = [*_trunk(), *_arm(), *_leg(hands), *(_mitten() if hands == "mitten" else _five_finger())]
    solids = tuple(Solid(part, at(part, field), group) for part, group, field in shapes)
    return Figure(solids, {name: origin * 1000 for name, (origin, _) in frames.items()})


Shapes = Iterator[tuple[str, str, Field]]  # Body, group and shape in the frame of the body.


def _trunk() -> Shapes:
    def bounded(p: Array) -> Array:
        body = smooth_max(TRUNK(p), p[:, 2] - 258, 24)
        return smooth_max(body, -51.5 - p[:, 2], 60)

    yield "hip", "trunk", bounded
    yield "hip", "seat", ellipsoid((-12, -35, -11), (33.5, 33, 35))
    yield "chest", "girdle", tube((-10, -36, -2), (-25, -82, 2), (22.5, 20))
    yield "head", "neck", tube((-11, 0, -30), (-3, 0, 30), (33, 30, 32))


def _arm() -> Shapes:
    yield "{side}_upper_arm", "arm", tube((0, -4, 0), (0, -4, 90), (22, 23.6, 22.5, 19.8), (0, 0.3, 0.7, 1))
    yield "{side}_lower_arm", "arm", tube((0, -1, 0), (0, -5, 79), (20, 22, 19.5, 15.2, 14.2), (0, 0.25, 0.6, 0.9, 1))


def _leg(hands: str) -> Shapes:
    yield "{side}_upper_leg", "leg", tube((0, 0, 0), (2, 0, -112), (35, 36.5, 33.4, 34, 27), (0, 0.3, 0.52, 0.62, 1))
    yield (
        "{side}_lower_leg",
        "leg",
        tube((0, 0, 0), (-1, 0, -141), (27, 27.5, 27.2, 22, 18.6, 19), (0, 0.2, 0.4, 0.68, 0.9, 1)),
    )
    yield "{side}_foot", "foot", ellipsoid((-13, 0, 0), (20.5, 17.5, 18))
    yield "{side}_foot", "foot", tube((-6, 1, 13), (26, 2, -3), (17, 13))
    yield "{side}_foot", "foot", tube((-8, 2, -2), (42, 9, -3.5), (14, 12, 10.4))
    yield "{side}_foot", "foot", tube((-8, -2, -3), (35, -10, -4.5), (13, 11, 9.2))
    yield "{side}_foot", "sole", lambda p: -13.4 - p[:, 2]
    big = "{side}_big_toe" if hands == "five_finger" else "{side}_toes"
    yield big, "toe", _toe(big, hands, (44, 13.4, -4.5), (60.5, 14.2, -5.8), (7.4, 7.7, 7.2))
    for y, start, end, radius in (
        (1.4, 44, 58.5, 5.1),
        (-5.6, 43, 56, 5.0),
        (-12.0, 41, 53, 4.8),
        (-17.6, 38, 49, 4.6),
    ):
        tip = (end, y * 1.03, -13.4 + radius + 0.6)
        yield "{side}_toes", "toe", _toe("{side}_toes", hands, (start, y, -6.2), tip, (radius * 0.94, radius))


def _toe(part: str, hands: str, start: tuple, end: tuple, radii: tuple) -> Field:
    """Return a toe, whose ends are given in the frame of the foot."""
    home = {"mitten": (44, 0, 0), "{side}_big_toe": (45.7, 15.5, 0)}
    origin = home.get(hands) or home.get(part, (45.7, -6.6, 0))
    return tube(np.subtract(start, origin), np.subtract(end, origin), radii)


def _mitten() -> Shapes:
    yield "{side}_hand", "palm", rounded_box((1, 0, 15), (20.5, 9, 22), 8.4)
    yield "{side}_hand", "palm", tube((0, 1.5, -8), (1, 0.5, 10), (14, 12))
    yield "{side}_hand", "palm", tube((13, -2, 4), (20, -4, 18), (8, 6.6))
    yield "{side}_hand", "finger", tube((18, -3.5, 14), (25, -4.5, 33), (6.8, 6.2, 5.4))
    for x, length, radius in ((15.2, 38.5, 5.6), (5.1, 41.5, 5.8), (-5.0, 39.5, 5.6), (-14.6, 32.5, 5.0)):
        yield (
            "{side}_fingers",
            "finger",
            tube((x, 0, -6), (x * 1.06, 0, length), (radius * 1.16, radius * 1.04, radius * 0.74)),
        )


def _five_finger() -> Shapes:
    yield "{side}_hand", "palm", rounded_box((-3, 0, 0), (17.5, 8, 18.5), 7.4)
    yield "{side}_hand", "palm", tube((-6, 3, -20), (-4, 1, -6), (13, 11))
    yield "{side}_lfmetacarpal", "palm", rounded_box((-8, 0, 2), (6.4, 7.4, 14), 6)
    for name, lengths, radii in (
        ("ff", (18.9, 9.5, 5.8), (5.2, 4.4, 3.7)),
        ("mf", (21, 10.5, 6.6), (5.4, 4.6, 3.9)),
        ("rf", (18.9, 9.5, 5.8), (5.2, 4.4, 3.7)),
        ("lf", (18.5, 9.2, 5.8), (4.8, 4.1, 3.5)),
    ):
        first, middle, last = lengths
        yield (
            f"{{side}}_{name}knuckle",
            "finger",
            tube((0, 0, -3), (0, 0, first), (radii[0] * 1.08, radii[0], radii[1])),
        )
        yield f"{{side}}_{name}middle", "finger", tube((0, 0, 0), (0, 0, middle), (radii[1], (radii[1] + radii[2]) / 2))
        yield (
            f"{{side}}_{name}distal",
            "finger",
            tube((0, 0, 0), (0, 0, last), ((radii[1] + radii[2]) / 2, radii[2] * 0.9)),
        )
    yield "{side}_thbase", "palm", tube((0, 0, 2), (0, 0, 15), (7.6, 6.0))
    yield "{side}_thhub", "finger", tube((0, 0, 0), (0, 0, 11.8), (5.6, 5.0))
    yield "{side}_thdistal", "finger", tube((0, 0, 0), (0, 0, 9.4), (5.0, 5.1, 4.6))
