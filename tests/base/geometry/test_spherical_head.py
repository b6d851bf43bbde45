"""Times at the ears are Woodworth's in every direction, and levels near those of the sphere's diffraction."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.special import eval_legendre, spherical_jn, spherical_yn
from support import store

from mimoc.base.geometry.spherical_head import (
    RADIUS_OF_ADULTS_M,
    SOUND_M_S,
    ear_angles,
    ear_delays_s,
    head_radius_m,
    interaural_time_s,
    level_gain,
)

TABLE = {0: (5.2, 393), 1: (5.7, 424), 3: (6.1, 460), 6: (6.6, 492), 12: (7.0, 523), 18: (7.2, 538), 24: (7.3, 549)}
"""Radius [cm] and largest time difference [µs] by age, of WHO's head circumferences."""
radii_m = st.floats(0.04, 0.1)
angles_rad = st.floats(-np.pi, np.pi)


def direction(azimuth_rad: float, elevation_rad: float = 0.0) -> np.ndarray:
    """Return a unit vector, x forward and y to the left, shape (1, 3)."""
    level = np.cos(elevation_rad)
    return np.array([[level * np.cos(azimuth_rad), level * np.sin(azimuth_rad), np.sin(elevation_rad)]])


@pytest.mark.parametrize("age_months", TABLE)
def test_heads_have_the_radius_and_the_time_difference_of_their_age(age_months):
    bundle = store.built({"mimoc": 1, "name": "x", "age_months": age_months, "senses": {"hearing": {}}})
    radius_m = bundle.manifest.senses.hearing.radius_m
    radius_cm, time_us = TABLE[age_months]
    assert radius_m == pytest.approx(head_radius_m(bundle.manifest.child.head_circumference_cm / 100), rel=1e-6)
    assert 100 * radius_m == pytest.approx(radius_cm, rel=0.03)
    assert 1e6 * interaural_time_s(np.pi / 2, radius_m) == pytest.approx(time_us, rel=0.03)


def test_adults_have_655_microseconds():
    assert 1e6 * interaural_time_s(np.pi / 2, RADIUS_OF_ADULTS_M) == pytest.approx(655, abs=1)


@given(angles_rad, st.floats(-np.pi / 2, np.pi / 2), radii_m)
def test_ears_differ_by_woodworths_time_in_every_direction(azimuth_rad, elevation_rad, radius_m):
    towards = direction(azimuth_rad, elevation_rad)
    ((left_s, right_s),) = ear_delays_s(ear_angles(towards), radius_m)
    aside_rad = np.arcsin(np.clip(towards[0, 1], -1, 1))
    assert right_s - left_s == pytest.approx(
        np.sign(aside_rad) * interaural_time_s(abs(aside_rad), radius_m), abs=1e-11
    )


@given(angles_rad, radii_m)
def test_no_way_around_the_head_is_shorter_than_through_it_or_longer_than_half_its_girth(azimuth_rad, radius_m):
    delays_s = ear_delays_s(ear_angles(direction(azimuth_rad)), radius_m)
    assert (delays_s >= -radius_m / SOUND_M_S - 1e-12).all()
    assert (delays_s <= np.pi / 2 * radius_m / SOUND_M_S + 1e-12).all()


@given(st.floats(50, 12_000), angles_rad, radii_m)
def test_what_is_in_front_is_as_loud_at_both_ears_and_the_left_ear_hears_the_left_louder(hz, azimuth_rad, radius_m):
    (left, right), (front, other) = (
        level_gain(hz, ear_angles(direction(angle)), radius_m)[0] for angle in (azimuth_rad, 0.0)
    )
    assert front == pytest.approx(other)
    if abs(np.sin(azimuth_rad)) > 0.1 and abs(np.cos(azimuth_rad)) > 0.6:
        assert (left > right) == (np.sin(azimuth_rad) > 0)


def diffracted(kr: float, cosines: np.ndarray) -> np.ndarray:
    """Return the pressure of a plane wave on a rigid sphere, relative to that without it (Duda & Martens 1998)."""
    orders = np.arange(int(30 + 3 * kr))
    slopes = spherical_jn(orders, kr, True) - 1j * spherical_yn(orders, kr, True)
    terms = [1j ** (m - 1) * (2 * m + 1) / slope * eval_legendre(m, cosines) for m, slope in enumerate(slopes)]
    return np.abs(sum(term for term in terms if np.isfinite(term).all())) / kr**2


@pytest.mark.parametrize("kr", [0.1, 0.5, 1, 2, 4, 8])
def test_level_differences_are_those_of_a_spheres_diffraction_within_5_db(kr):
    radius_m, azimuths = 0.07, np.radians([0, 15, 30, 45, 60])
    hz = kr * SOUND_M_S / (2 * np.pi * radius_m)
    angles = ear_angles(np.concatenate([direction(azimuth) for azimuth in azimuths]))
    ours, theirs = level_gain(hz, angles, radius_m), diffracted(kr, np.cos(angles))
    ours_db, theirs_db = (20 * np.log10(both[:, 0] / both[:, 1]) for both in (ours, theirs))
    assert np.abs(ours_db - theirs_db).max() < (1 if kr <= 0.5 else 5)
