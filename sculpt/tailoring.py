"""Hems as smooth curves on the body, and garments as what is between them. Lengths are mm."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from cutting import Curve, Drawn
from fields import Array, smooth_min
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from mimoc.body.kinematics import Frame

SLEEVE, LEG = 0.66, 0.84  # Where sleeves and legs end, as shares of upper arm and thigh.
SHIRT_HEM, WAIST, TILT = 5.0, 33.0, 0.06
"""Heights of the shirt's hem and of the waist of trousers and nappy above the hip, and how much these fall forwards."""
NECK, NECKLINE = (2.0, 0.0, 268.0), 40.0  # Middle and radius of the neckline, a ball that is flatter from side to side.
GROIN, INWARDS, AHEAD = 33.0, 0.12, 0.33
"""Where legs come out of a bodysuit: so far down the bent thigh, and farther on its inner side and ahead."""
CROTCH = 17.0  # Half of the breadth of cloth between the legs.


def hems(frames: Mapping[str, Frame]) -> dict[str, Curve]:
    """Return all hems of the right side, by name."""
    arm, leg = _along(frames["right_upper_arm"], (0, -4, 90)), _along(frames["right_upper_leg"], (0, 0, -112))
    origin, turn = frames["right_upper_leg"][0] * 1000, frames["right_upper_leg"][1]

    def near(place: Callable, low: float, high: float, radius: float) -> Callable[[Array], np.ndarray]:
        def window(p: Array) -> np.ndarray:
            t, far = place(p)
            return (low < t) & (t < high) & (far < radius)

        return window

    def trunk(p: Array) -> np.ndarray:
        return (np.abs(p[:, 2] - WAIST) < 60) & (np.hypot(p[:, 0], p[:, 1]) < 100)

    def groin(p: Array) -> Array:
        x, y, z = ((p - origin) @ turn).T
        return smooth_min(-z - (GROIN + INWARDS * y + AHEAD * x), np.abs(p[:, 1]) - CROTCH, 14)

    neck = Curve(
        lambda p: NECKLINE - np.linalg.norm((p - NECK) * (1, 0.84, 1), axis=1),
        lambda p: np.linalg.norm(p - NECK, axis=1) < 70,
    )
    return {
        "neck": neck,
        "sleeve": Curve(lambda p: (arm(p)[0] - SLEEVE) * 90, near(arm, 0.2, 1.1, 40)),
        "shirt_hem": Curve(lambda p: p[:, 2] - SHIRT_HEM, trunk),
        "waist": Curve(lambda p: p[:, 2] - WAIST + TILT * p[:, 0], trunk),
        "groin": Curve(groin, near(leg, -0.6, 0.8, 75)),
        "leg": Curve(lambda p: (leg(p)[0] - LEG) * 112, near(leg, 0.4, 1.2, 60)),
    }


def _along(frame: Frame, end: tuple[float, float, float]) -> Callable[[Array], tuple[Array, Array]]:
    """Return a function of points: how far along a bone they are, from 0 to 1, and how far from its line."""
    origin, along = frame[0] * 1000, frame[1] @ np.array(end, float)

    def place(p: Array) -> tuple[Array, Array]:
        t = (p - origin) @ along / (along @ along)
        return t, np.linalg.norm(p - origin - t[:, None] * along, axis=1)

    return place


TORSO, BELT, SEAT, THIGH = "torso", "belt", "seat", "thigh"
PANELS = {
    TORSO: ("chest", (30.0, 0.0, -30.0)),
    BELT: ("hip", (70.0, 0.0, (SHIRT_HEM + WAIST) / 2)),
    SEAT: ("hip", (20.0, 0.0, -60.0)),
    THIGH: ("right_upper_leg", (36.0, 0.0, -75.0)),
}
"""A place in each panel, in the frame of a body."""
GARMENTS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "bodysuit": ((TORSO, BELT, SEAT), ("neck", "sleeve", "groin")),
    "shirt": ((TORSO, BELT), ("neck", "sleeve", "shirt_hem")),
    "trousers": ((BELT, SEAT, THIGH), ("waist", "leg")),
    "nappy": ((BELT, SEAT), ("waist", "groin")),
}
"""The panels of each garment, and the hems that it ends at."""
LIFTS = {"bodysuit": (1.5, 2.2), "shirt": (3.4, 2.8), "trousers": (2.4, 2.2), "nappy": (2.0, 8.0)}
"""How high each is above the skin at its hems, and far from them."""
FAR = 30.0  # Distance from hems at which it is that high.


@dataclass(frozen=True)
class Cut:
    """Garments that are cut out of a mesh, by name."""

    is_covered: Mapping[str, np.ndarray]  # Whether each face is of the garment.
    hem_mm: Mapping[str, Array]  # Distance of each vertex from the nearest hem.
    lifts_mm: Mapping[str, Array]  # Height of the cloth above each vertex.


def cut_out(drawn: Drawn, curves: Mapping[str, Curve], frames: Mapping[str, Frame]) -> Cut:
    """Return all garments on a symmetric mesh with hems in it."""
    panel = _panels(drawn, frames)
    is_covered = {
        name: np.isin(panel, [[*PANELS].index(part) for part in parts]) for name, (parts, _) in GARMENTS.items()
    }
    hem_mm, lifts_mm = {}, {}
    for name, (_, ends) in GARMENTS.items():
        columns = [1 + [*curves].index(end) for end in ends]
        hem_mm[name] = _distance(drawn, drawn.lies_on[:, columns].any(axis=1))
        t = np.clip(hem_mm[name] / FAR, 0, 1)
        low, high = LIFTS[name]
        lifts_mm[name] = low + (high - low) * t * t * (3 - 2 * t)
    return Cut(is_covered, hem_mm, lifts_mm)


def _panels(drawn: Drawn, frames: Mapping[str, Frame]) -> np.ndarray:
    """Return the number of the panel that each face is of, or -1: faces between which there is no hem are of one."""
    sides: dict[tuple[int, int], int] = {}
    pairs = []
    for number, face in enumerate(drawn.faces.tolist()):
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            if (drawn.lies_on[a, 1:] & drawn.lies_on[b, 1:]).any():
                continue
            other = sides.setdefault((min(a, b), max(a, b)), number)
            pairs.append((other, number))
    joined = coo_matrix((np.ones(len(pairs)), np.array(pairs).T), shape=(len(drawn.faces),) * 2)
    _, patch = connected_components(joined, directed=False)
    middles = drawn.verts[drawn.faces].mean(axis=1)
    panel = np.full(len(drawn.faces), -1)
    for number, (body, place) in enumerate(PANELS.values()):
        origin, turn = frames[body]
        spot = origin * 1000 + turn @ np.array(place)
        for side in (spot, spot * (1, -1, 1)):
            panel[patch == patch[np.linalg.norm(middles - side, axis=1).argmin()]] = number
    return panel


def _distance(drawn: Drawn, at: np.ndarray) -> Array:
    """Return how far each vertex is from the nearest of some of them, straight across."""
    points = drawn.verts[at]
    return np.array([np.linalg.norm(points - vert, axis=1).min() for vert in drawn.verts])


MIN_THICKNESS = 0.8  # Thickness of cloth that is pressed onto the floor.


def thinned(cut: Cut, room_mm: Array) -> Cut:
    """Return garments that are thin where there is little room between the body and the floor that it rests on."""
    lifts_mm = {name: np.minimum(lifts, np.maximum(MIN_THICKNESS, room_mm)) for name, lifts in cut.lifts_mm.items()}
    return replace(cut, lifts_mm=lifts_mm)


def arrays(cut: Cut) -> dict[str, np.ndarray]:
    """Return what ships of garments."""
    return {
        "garments": np.array(list(GARMENTS)),
        "covers": sum(cut.is_covered[name].astype(np.uint8) << index for index, name in enumerate(GARMENTS)),
        "lifts_50um": np.rint(20 * np.array([cut.lifts_mm[name] for name in GARMENTS])).astype(np.uint8),
    }
