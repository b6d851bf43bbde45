"""Heads and hair by age: what makes a face look its age, measured."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from support.skin_bodies import child

from mimoc.compiler.looks.head import BARE, CLEAR, GROWTH, deform_head, density, growth_at
from mimoc.compiler.looks.sculpture import template_mesh
from mimoc.compiler.looks.skin import skin_of

AGES_MONTHS = (0, 3, 6, 12, 24)
RIM = 1.12  # The rims of the lids are within so many radii of an eyeball.


def sculpted():
    return template_mesh("mitten").head


@cache
def shape(age_months: float) -> np.ndarray:
    """Return the vertices of a head in half axes of its solid, in the frame of that."""
    tree = child(age_months)
    head = tree.geoms["head"]
    return (deform_head(sculpted(), tree) - np.array(head.pos_m)) / np.array(head.size_m)


def middle(age_months: float) -> np.ndarray:
    """Return the vertices in the middle of a face."""
    verts = shape(age_months)
    return verts[(np.abs(verts[:, 1]) < 0.08) & (verts[:, 0] > 0.3)]


def chin(age_months: float) -> float:
    """Return how low the chin is."""
    verts = middle(age_months)
    return float(verts[verts[:, 0] > 0.6][:, 2].min())


def nose_tip(age_months: float) -> np.ndarray:
    verts = middle(age_months)
    near = verts[(verts[:, 2] < -0.15) & (verts[:, 2] > -0.5)]
    return near[near[:, 0].argmax()]


def rising(values) -> bool:
    return all(a < b for a, b in pairwise(values))


def test_chins_become_lower_and_noses_longer():
    assert rising([-chin(age) for age in AGES_MONTHS])
    assert rising([float(nose_tip(age)[0]) for age in AGES_MONTHS])
    assert rising([-float(nose_tip(age)[2]) for age in AGES_MONTHS])


def test_bridges_of_noses_become_higher():
    def bridge(age_months: float) -> float:
        verts = middle(age_months)
        return float(verts[np.abs(verts[:, 2] + 0.09) < 0.06][:, 0].max())

    assert rising([bridge(age) for age in AGES_MONTHS])


def test_cheeks_are_fullest_at_three_months_and_slimmest_at_two_years():
    def breadth(age_months: float) -> float:
        verts = shape(age_months)
        return float(np.ptp(verts[(np.abs(verts[:, 2] + 0.6) < 0.08)][:, 1]))

    assert breadth(3) > breadth(0)
    assert breadth(3) > breadth(12) > breadth(24)


def test_eyes_of_a_newborn_are_just_below_the_middle_and_rise_as_the_chin_sinks():
    shares = [(1 + 0.09) / (1 - chin(age)) for age in AGES_MONTHS]
    assert 0.5 < shares[0] < 0.62
    assert rising([-share for share in shares])


def test_newborns_open_their_eyes_least():
    def opening(age_months: float) -> float:
        upper, lower = sculpted().lids[AGES_MONTHS.index(age_months)]
        return upper + lower

    assert min(AGES_MONTHS, key=opening) == 0


def test_faces_are_the_same_on_both_sides():
    verts = shape(6)
    mirrored = verts[(verts[:, 0] > 0.5) & (verts[:, 1] > 0.05)] * (1, -1, 1)
    far = np.linalg.norm(mirrored[:, None] - verts[None], axis=2).min(axis=1)
    assert np.quantile(far, 0.98) < 0.02


def test_who_misses_an_eye_has_its_lids_closed():
    def opening_m(**body) -> float:
        """Return how far apart the lids of the left eye are."""
        reference = sculpted()
        verts = reference.at_ages_m[2]
        place = reference.eye_m * (1, -1, 1)
        rim = np.linalg.norm(verts - place, axis=1) < RIM * reference.eye_radius_m
        near = rim & (np.abs(verts[:, 1] - place[1]) < 0.003)
        return float(np.ptp(deform_head(reference, child(9, **body))[near][:, 2]))

    assert opening_m(remove=["left_eye"]) < 0.5 * opening_m()


@pytest.mark.parametrize("age_months", [0, 3, 6, 6.5, 9, 12, 18, 24])
def test_hair_that_is_seen_is_never_in_the_head(age_months):
    """Where its picture is hair, it is higher than the skin; and where it is lower, its picture is skin."""
    head, hair = skin_of(child(age_months)).layers[-2:]
    scalp, share = sculpted().hair, density(sculpted().hair, age_months)
    under = hair.verts_m - head.verts_m[scalp.verts]
    a, b, c = (hair.verts_m[scalp.faces[:, index]] for index in range(3))
    normal = np.zeros_like(under)
    np.add.at(normal, scalp.faces, np.repeat(np.cross(b - a, c - a)[:, None], 3, axis=1))
    height_m = (under * normal).sum(axis=1) / np.linalg.norm(normal, axis=1)
    assert height_m[share >= CLEAR].min() > 0.0001
    assert height_m[share <= BARE].max() < 0


def test_hair_becomes_denser_and_thicker():
    for earlier, later in pairwise(GROWTH):
        assert (earlier.cover, earlier.thick_mm, earlier.fringe) <= (later.cover, later.thick_mm, later.fringe)
    assert growth_at(36) == growth_at(24)
    assert 5 <= growth_at(24).thick_mm <= 8


def test_hair_is_thin_at_the_back_from_lying_on_it():
    def ratio(age_months: float) -> float:
        scalp = sculpted().hair
        share = density(scalp, age_months)
        inside = scalp.inside_deg[:, 0] > 20
        return float(share[inside & (scalp.worn > 0.8)].mean() / share[inside & (scalp.worn < 0.1)].mean())

    assert ratio(3) < 0.6
    assert ratio(24) == pytest.approx(1, abs=0.05)
