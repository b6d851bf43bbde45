"""Clothes: parts of the body's own mesh that are raised, so that they move with it and end in clean hems."""

from collections import Counter
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial import cKDTree
from support.posed_skins import crossings, edges_of, posed, random_frames
from support.skin_bodies import child

from mimoc.compiler.looks.sculpture import BARE, OUTFITS, dressed, template_mesh
from mimoc.compiler.looks.skin import skin_of
from mimoc.compiler.mjcf.scene import SkinLayer, encode_skn

HANDS = ("mitten", "five_finger")
WORN = [outfit for outfit in OUTFITS if outfit != BARE]
SEAM_M = 0.001  # How far the edge of a hem may be from what is below it: it is sunk a little into it.
THROUGH_M = 0.001  # How far trousers may pass through a shirt.
OF_A_THIGH = 0.3
"""Share of the thighs in what moves an edge of trousers, from which it may press into a belly: there solids overlap,
too, and both are soft."""
SHARPEST_DEG, SHORTEST_M = 75.0, 0.001  # The largest turn between two edges of a hem, and the least length of one.
PAIRS = [(hands, outfit) for hands in HANDS for outfit in WORN]


@cache
def layers(age_months: float, hands: str, outfit: str) -> dict[str, SkinLayer]:
    tree = replace(child(age_months, hands), clothes=outfit)
    return {layer.name: layer for layer in skin_of(tree).layers if layer.name not in ("head", "hair")}


def open_edges(faces: np.ndarray) -> list[tuple[int, int]]:
    """Return the edges that no face has in the other direction."""
    directed = {(int(a), int(b)) for face in faces for a, b in zip(face, np.roll(face, -1), strict=True)}
    return [(a, b) for a, b in directed if (b, a) not in directed]


@pytest.mark.parametrize(("hands", "outfit"), PAIRS)
def test_each_outfit_has_its_layers(hands, outfit):
    assert list(layers(9, hands, outfit)) == ["body", *OUTFITS[outfit]]


@pytest.mark.parametrize(("hands", "outfit"), PAIRS)
def test_every_triangle_of_the_body_is_seen_once(hands, outfit):
    """What cloth covers is not drawn below it, so nothing can come through; strips at hems are all that is added."""
    mesh = template_mesh(hands).mesh
    pieces = dressed(template_mesh(hands), outfit)
    drawn = Counter(tuple(sorted(face)) for piece in pieces for face in piece.sources[piece.faces].tolist())
    assert all(drawn[tuple(sorted(face))] == 1 for face in mesh.faces.tolist())
    assert sum(len(set(face)) == 3 for face in drawn) == len(mesh.faces)


@pytest.mark.parametrize("age_months", [0, 6, 24])
@pytest.mark.parametrize(("hands", "outfit"), PAIRS)
def test_hems_are_closed(hands, outfit, age_months):
    """Only the neck, which is in the head, is open; where a layer ends, it ends in what is below."""
    meshes = layers(age_months, hands, outfit)
    others = {
        name: cKDTree(np.vstack([mesh.verts_m for key, mesh in meshes.items() if key != name])) for name in meshes
    }
    for name, mesh in meshes.items():
        ends = np.unique(open_edges(mesh.faces))
        if name == "body":
            ends = ends[mesh.weights[ends][:, mesh.bones.index("head")] < 0.3]
        far_m, _ = others[name].query(mesh.verts_m[ends])
        assert far_m.max() < (SEAM_M if name != "body" else 0.006), name


@pytest.mark.parametrize(("hands", "outfit"), PAIRS)
def test_hems_are_smooth(hands, outfit):
    """Their edges are as long as others, and turn little from one to the next."""
    mesh = template_mesh(hands).mesh
    for garment in OUTFITS[outfit].values():
        rim = open_edges(mesh.faces[template_mesh(hands).garments[garment].is_covered])
        after = dict(rim)
        assert len(after) == len(rim)
        along = {a: mesh.verts_m[b] - mesh.verts_m[a] for a, b in rim}
        length_m = {a: np.linalg.norm(edge) for a, edge in along.items()}
        assert min(length_m.values()) > SHORTEST_M
        cosines = [along[a] @ along[b] / length_m[a] / length_m[b] for a, b in rim]
        assert np.degrees(np.arccos(min(cosines))) < SHARPEST_DEG, garment


def through_m(age_months: float, hands: str, poses: int) -> float:
    """Return how far trousers pass through the shirt in random poses, but where thighs press into the belly."""
    tree = replace(child(age_months, hands), clothes="shirt_and_trousers")
    meshes = layers(age_months, hands, "shirt_and_trousers")
    shirt, trousers = meshes["shirt"], meshes["trousers"]
    thighs = [index for index, bone in enumerate(trousers.bones) if bone.endswith("_leg")]
    edges = edges_of(trousers)
    edges = edges[trousers.weights[:, thighs].sum(axis=1)[edges].max(axis=1) < OF_A_THIGH]
    deepest = 0.0
    for placed in random_frames(tree, poses, 34):
        _, depths = crossings(posed(trousers, placed), edges, posed(shirt, placed), shirt.faces)
        deepest = max(deepest, *depths, 0.0)
    return deepest


@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("age_months", [0, 24])
def test_no_trousers_come_through_a_shirt(hands, age_months):
    assert through_m(age_months, hands, 25) < THROUGH_M


@pytest.mark.full
@pytest.mark.parametrize("hands", HANDS)
@pytest.mark.parametrize("age_months", [0, 3, 9, 24])
def test_no_trousers_come_through_a_shirt_in_five_hundred_poses(hands, age_months):
    assert through_m(age_months, hands, 500) < THROUGH_M


@pytest.mark.parametrize("hands", HANDS)
def test_an_outfit_has_the_same_vertices_and_faces_at_all_ages(hands):
    for outfit in WORN:
        young, old = layers(0, hands, outfit), layers(24, hands, outfit)
        for name in young:
            assert np.array_equal(young[name].faces, old[name].faces)
            assert np.array_equal(young[name].texcoords, old[name].texcoords)


def test_the_same_child_has_the_same_bytes_twice():
    tree = replace(child(4), clothes="bodysuit")
    skin_of.cache_clear()
    first = [encode_skn(layer) for layer in skin_of(tree).layers]
    skin_of.cache_clear()
    assert [encode_skn(layer) for layer in skin_of(tree).layers] == first
