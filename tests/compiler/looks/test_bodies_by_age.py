"""The shape of bodies by age: bellies, rolls and dimples come and go, and bent limbs keep their girth."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from support.posed_skins import edges_of, lengths, posed, random_frames
from support.skin_bodies import child

from mimoc.body.kinematics import frames
from mimoc.compiler.looks.sculpture import BARE, template_mesh
from mimoc.compiler.looks.skin import skin_of
from mimoc.compiler.mjcf.scene import SkinLayer

HANDS = ("mitten", "five_finger")
BENT_DEG = 120.0
KEPT = 0.85  # Share of a limb's girth that is left when it is bent.
FARTHEST_STRETCH = 2.5
JOINTS = {
    "elbow": ("lower_arm", -BENT_DEG),
    "knee": ("lower_leg", -BENT_DEG),
    "hip1": ("upper_leg", -BENT_DEG),
    "shoulder_ad_ab": ("upper_arm", BENT_DEG),
}
"""The body that each joint moves, and its angle."""
BEYOND = {"shoulder_ad_ab": 0.3}
"""Share of the limb beyond the joint at which it is measured; others are measured at the joint, in the plane that
halves its angle."""


def bare(age_months: float, hands: str):
    return replace(child(age_months, hands), clothes=BARE)


@cache
def body(age_months: float, hands: str) -> SkinLayer:
    return skin_of(bare(age_months, hands)).layers[0]


def fullness_mm(age_months: float, hands: str) -> np.ndarray:
    sculpted = template_mesh(hands)
    return 1000 * sculpted.fullness_m[sculpted.ages_months.tolist().index(age_months)]


@pytest.mark.parametrize("hands", HANDS)
def test_bellies_are_roundest_at_six_to_twelve_months(hands):
    """In front, between hip and chest, above what is pressed flat in prone."""
    most = {age: np.quantile(fullness_mm(age, hands), 0.995) for age in (0, 3, 6, 12, 24)}
    assert most[6] > most[3] > most[0]
    assert most[12] > most[24] > most[0]


@pytest.mark.parametrize("hands", HANDS)
def test_rolls_of_fat_come_after_birth_and_go_when_children_walk(hands):
    mesh, parts = template_mesh(hands).mesh, template_mesh(hands).parts
    limbs = np.isin(np.array(parts)[mesh.bones[:, 0]], [f"{side}_{part}" for side in ("left", "right") for part in
                                                      ("upper_leg", "lower_arm")])  # fmt: skip
    uneven = {age: np.ptp(np.quantile(fullness_mm(age, hands)[limbs], (0.02, 0.98))) for age in (0, 3, 6, 12, 24)}
    assert min(uneven[3], uneven[6], uneven[12]) > 1.5 * max(uneven[0], uneven[24])


def girth_m(verts: np.ndarray, faces: np.ndarray, place: np.ndarray, normal: np.ndarray, radius_m: float) -> float:
    """Return the perimeter of the convex hull of a section of a mesh by a plane, near a place in it."""
    height = (verts - place) @ normal
    pairs = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    a, b = pairs[height[pairs[:, 0]] * height[pairs[:, 1]] < 0].T
    points = verts[a] + (height[a] / (height[a] - height[b]))[:, None] * (verts[b] - verts[a]) - place
    points = points[np.linalg.norm(points, axis=1) < radius_m]
    across = np.linalg.svd(normal[None])[2][1:]
    return float(ConvexHull(points @ across.T).area)


@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("age_months", [0, 9, 24])
@pytest.mark.parametrize("joint", JOINTS)
def test_limbs_keep_their_girth_when_they_are_bent(joint, age_months, hands):
    part, bent_deg = JOINTS[joint]
    tree, mesh = bare(age_months, hands), body(age_months, hands)
    home = next(item for item in tree.bodies if item.name == f"right_{part}")
    solid, faces = home.geoms[0], mesh.faces
    if joint in BEYOND:
        faces = faces[(mesh.weights[:, mesh.bones.index(home.name)] > 0.4)[faces].all(axis=1)]
    along = np.array(solid.pos_m) / np.linalg.norm(solid.pos_m)
    girths = []
    for angle in (0.0, bent_deg):
        placed = frames(tree, {f"robot:right_{joint}": np.radians(angle)})
        origin, turn = placed[home.name]
        straight = frames(tree, {})[home.name][1]
        outwards = turn @ along
        place = origin + BEYOND.get(joint, 0.0) * 2 * np.linalg.norm(solid.pos_m) * outwards
        normal = outwards if joint in BEYOND else outwards + straight @ along
        reach_m = (4.0 if joint == "hip1" else 2.6) * solid.size_m[0]
        normal = normal / np.linalg.norm(normal)
        girths.append(girth_m(posed(mesh, placed), faces, place, normal, reach_m))
    assert girths[1] / girths[0] > KEPT


def stretch(age_months: float, hands: str, poses: int) -> float:
    """Return how many times longer edges get in random poses than they are in the pose that they were sculpted in."""
    tree = replace(child(age_months, hands), clothes="shirt_and_trousers")
    most = 1.0
    meshes = [(mesh, edges_of(mesh)) for mesh in (*skin_of(tree).layers[:3], body(age_months, hands))]
    for placed in random_frames(tree, poses, 16):
        for mesh, edges in meshes:
            most = max(most, (lengths(posed(mesh, placed), edges) / lengths(mesh.verts_m, edges)).max())
    return most


@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_no_edge_is_stretched_much_in_random_poses(age_months, hands):
    assert stretch(age_months, hands, 20) < FARTHEST_STRETCH


@pytest.mark.full
@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_no_edge_is_stretched_much_in_two_hundred_random_poses(age_months, hands):
    assert stretch(age_months, hands, 200) < FARTHEST_STRETCH
