"""Nothing breaks down and no joint is flung out, however an infant is made and whatever it is commanded.

`benchmarks/flailing.py` draws 300 infants; here are 48, one of every kind that it draws, and the worst that were found.
"""

import sys
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from support.full import full_but

import mimoc

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
from flailing import flailed, infants

from mimoc.runtime.check import MAX_ENERGY_J_PER_KG

FEW = 6
"""Infants of a chunk; 8 chunks have one of every stratum."""
MEDIAN_DEG, LARGEST_DEG = 15, 60
LARGE_HAND = {"left_hand": {"length": 1.87, "girth": 1.99}}
LARGE_THUMB = {
    "left_thbase": {"length": 1.5, "girth": 2.0},
    "left_thhub": {"length": 0.5, "girth": 0.5},
    "left_thdistal": {"length": 0.5, "girth": 0.5},
}
STOUT = {"sex": "female", "length_percentile": 1, "weight_percentile": 92, "head_percentile": 1}
SHORT_WAIST = {"lower_body": {"length": 0.5, "girth": 2.0}}
WORST = {
    "a large palm": (24, "torque", {"parts": LARGE_HAND}, {}),
    "a palm for a giant": (24, "torque", {"parts": {**LARGE_HAND, "left_fingers": {"length": 0.5, "girth": 0.5}}}, {}),
    "a large thumb": (24, "torque", {"hands": "five_finger", "parts": LARGE_THUMB}, {}),
    "strong fingers": (24, "torque", {"hands": "five_finger"}, {"hands": 10}),
    "a newborn with servos": (0, "position", {"hands": "five_finger"}, {}),
    "a short waist": (12, "muscle", {"parts": {"lower_body": {"length": 0.5, "girth": 0.5}}}, {}),
    "a short, stout child without a waist": (9.7, "torque", {"individual": STOUT, "parts": SHORT_WAIST}, {}),
    "arms beside a broad trunk": (17, "torque", {"parts": {"upper_body": {"girth": 2.0}}}, {}),
    "arms at a narrow chest": (9, "position", {"chest_joint": True, "parts": {"chest": {"girth": 0.5}}}, {}),
}
"""Age, actuation model, body, strength."""


@pytest.fixture(scope="module")
def beyond_deg():
    """Return what gives the largest overshoot of an infant, after it was seen that nothing broke down or was flung.

    The energy is held to what `mimoc check` allows: parts that begin inside each other had up to 96 J/kg.
    """

    def measure(drawn, bundle, generator):
        found = flailed(drawn, bundle, generator)
        assert [flailing.warnings for flailing in found] == [(), ()], drawn
        assert max(flailing.energy_j_per_kg for flailing in found) < MAX_ENERGY_J_PER_KG, drawn
        return max(flailing.beyond_deg for flailing in found)

    return measure


@pytest.mark.full
@pytest.mark.parametrize("chunk", full_but([0, 1], range(8)))
def test_drawn_infants_stay_calm_and_keep_their_joints(chunk, beyond_deg):
    """The median is over all actuation models; with motors, five fingers alone are wilder, as MIMo's are."""
    generator = np.random.default_rng(chunk)
    found = [beyond_deg(*drawn, generator) for drawn in islice(infants(generator, FEW * chunk), FEW)]
    assert max(found) < LARGEST_DEG
    assert np.median(found) < MEDIAN_DEG


@pytest.mark.parametrize("name", WORST)
def test_the_worst_that_were_found_keep_their_joints(name, beyond_deg):
    age_months, model, body, strength = WORST[name]
    actuation, scene = {"model": model, "strength": strength}, {"kind": "flat", "pose": "supine"}
    spec = {"mimoc": 1, "name": "x", "age_months": age_months, "body": body, "actuation": actuation, "scene": scene}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(spec))
    assert beyond_deg(spec, bundle, np.random.default_rng(0)) < LARGEST_DEG
