"""Children with skin, and the distances of points from the solids that they are made of."""

from functools import cache

import numpy as np
from hypothesis import assume, strategies as st
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

from mimoc.anatomy.anatomy import assemble
from mimoc.base.errors import GeometryError
from mimoc.body.grow import grow_body, grow_tree
from mimoc.body.tree import Body, BodyTree, Geom
from mimoc.components.senses.touch.build import SkinPoints
from mimoc.fits import measure
from mimoc.schema import InfantSpec
from mimoc.schema.names import MEASUREMENT_KEYS, SIDED_MEASUREMENT_KEYS, limb_bodies, trunk_bodies

HANDS = ("mitten", "five_finger")
SIDES = ("left", "right")
MIRROR = np.array([1, -1, 1])
SPACING_M = {  # Of MIMo, at 18 months (senses.md, section 4).
    "head": 0.013, "hip": 0.025, "lower_body": 0.025, "upper_body": 0.030, "chest": 0.030,
    "upper_arm": 0.024, "lower_arm": 0.024, "hand": 0.007, "fingers": 0.002, "lfmetacarpal": 0.007,
    "ffdistal": 0.002, "mfdistal": 0.002, "rfdistal": 0.002, "lfdistal": 0.002, "thdistal": 0.002,
    "ffmiddle": 0.004, "mfmiddle": 0.004, "rfmiddle": 0.004, "lfmiddle": 0.004, "thhub": 0.004,
    "ffknuckle": 0.004, "mfknuckle": 0.004, "rfknuckle": 0.004, "lfknuckle": 0.004, "thbase": 0.004,
    "upper_leg": 0.027, "lower_leg": 0.038, "foot": 0.015, "toes": 0.010, "big_toe": 0.010,
}  # fmt: skip


@cache
def average(age_months: float, hands: str) -> BodyTree:
    return grow_tree(measure(age_months), assemble(hands, False))


def child(age_months: float = 9, hands: str = "mitten", **body) -> BodyTree:
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "body": {"hands": hands, **body}}
    return grow_body(InfantSpec.model_validate(spec)).tree


@st.composite
def children(draw) -> BodyTree:
    hands, age_months = draw(st.sampled_from(HANDS)), draw(st.floats(0, 24))
    parts = st.sampled_from((*trunk_bodies(), *limb_bodies(hands)))
    factors = st.fixed_dictionaries({"length": st.floats(0.5, 2), "girth": st.floats(0.5, 2)})
    changes = draw(st.dictionaries(st.sampled_from((*MEASUREMENT_KEYS, *SIDED_MEASUREMENT_KEYS)), st.floats(0.8, 1.3)))
    base = measure(age_months).base
    given_cm = {key: 100 * base[_measurement(key)].value_m * factor for key, factor in changes.items()}
    try:
        return child(age_months, hands, parts=draw(st.dictionaries(parts, factors, max_size=4)), measurements=given_cm)
    except GeometryError:
        assume(False)
        raise


def _measurement(key: str) -> str:
    return key.removesuffix("_cm").removeprefix("left_").removeprefix("right_")


def part(name: str) -> str:
    return name.removeprefix("left_").removeprefix("right_")


def local_of(geom: Geom, points_m: np.ndarray) -> np.ndarray:
    return Rotation.from_euler("XYZ", geom.euler_deg, degrees=True).inv().apply(points_m - np.array(geom.pos_m))


def to_body(geom: Geom, local: np.ndarray) -> np.ndarray:
    return Rotation.from_euler("XYZ", geom.euler_deg, degrees=True).apply(local) + geom.pos_m


def nearest_m(geom: Geom, local: np.ndarray) -> np.ndarray:
    """Return the nearest points of a solid; those inside stay where they are."""
    if geom.type == "box":
        return np.clip(local, -np.array(geom.size_m), geom.size_m)
    if geom.type == "ellipsoid":  # Those on the way to its middle.
        return local / np.maximum(1, np.linalg.norm(local / geom.size_m, axis=1))[:, None]
    radius_m, half_m = (*geom.size_m, 0.0)[:2]
    flat = local * (1, 1, geom.type != "cylinder")
    axis = np.clip(local * (0, 0, 1), -half_m, half_m) * (geom.type != "sphere")
    out = flat - axis * (geom.type == "capsule")
    return axis + out * np.minimum(1, radius_m / np.maximum(np.linalg.norm(out, axis=1), 1e-12))[:, None]


def outside_m(geom: Geom, points_m: np.ndarray) -> np.ndarray:
    """Return how far points are from a geom; inside it is negative."""
    local = local_of(geom, points_m)
    if geom.type == "box":
        return _beyond(np.abs(local) - geom.size_m)
    if geom.type == "ellipsoid":  # To first order, so exact at its surface.
        share = np.linalg.norm(local / geom.size_m, axis=1)
        return share * (share - 1) / np.maximum(np.linalg.norm(local / np.square(geom.size_m), axis=1), 1e-12)
    if geom.type == "cylinder":
        return _beyond(np.column_stack((np.hypot(*local[:, :2].T), np.abs(local[:, 2]))) - geom.size_m)
    half_m = geom.size_m[1] if geom.type == "capsule" else 0.0
    return np.linalg.norm(local - np.clip(local, -half_m, half_m) * (0, 0, 1), axis=1) - geom.size_m[0]


def _beyond(gaps_m: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.maximum(gaps_m, 0), axis=1) + np.minimum(gaps_m.max(axis=1), 0)


def outside_all_m(body: Body, points_m: np.ndarray) -> np.ndarray:
    return np.min([outside_m(geom, points_m) for geom in body.geoms], axis=0)


def outside_parent_m(tree: BodyTree, body: Body, points_m: np.ndarray) -> np.ndarray:
    """Return how far points of a body are from the one that it is attached to, all joints at zero."""
    parents = [other for other in tree.bodies if other.name == body.parent]
    if not parents:
        return np.full(len(points_m), np.inf)
    turned_m = Rotation.from_euler("XYZ", body.euler_deg, degrees=True).apply(points_m.copy())
    return outside_all_m(parents[0], turned_m + body.pos_m)


def seen(body: Body, count: int) -> np.ndarray:
    """Return that many places on each geom of a body, less those that another one covers."""
    shell = np.random.default_rng(0).uniform(-1, 1, (count, 3))
    shell /= np.abs(shell).max(axis=1, keepdims=True)
    found = []
    for geom in body.geoms:
        far_m = shell * (np.array(geom.size_m) if geom.type == "box" else sum(geom.size_m)) * 1.2
        places_m = nearest_m(geom, far_m)
        above_m = places_m + 1e-4 * (far_m - places_m)
        is_seen = outside_all_m(body, to_body(geom, above_m)) > 0
        found.append(to_body(geom, places_m[is_seen]))
    return np.concatenate(found)


def neighbours(tree: BodyTree, skin: SkinPoints, name: str) -> np.ndarray:
    """Return how far the nearest neighbour of each point of a body is, in spacings."""
    points_m = skin.points_m[name]
    return KDTree(points_m).query(points_m, k=2)[0][:, 1] / skin.spacing_m[name]


def numbers(skin: SkinPoints) -> dict[str, int]:
    return {body: len(points_m) for body, points_m in skin.points_m.items()}
