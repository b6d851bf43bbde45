"""Nothing breaks down and no joint is flung out, however an infant is made and whatever it is commanded.

`benchmarks/flailing.py` draws 300 infants; here are 48, one of every kind that it draws, and the worst that were found.
"""

import sys
from collections.abc import Iterator
from itertools import islice, repeat
from pathlib import Path

import mujoco
import numpy as np
import pytest
from support.full import full_but

import mimoc
from mimoc.compiler.measuring import ROOT, compile_infant
from mimoc.runtime.check import MAX_ENERGY_J_PER_KG, flail

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
from flailing import draw, flailed, infants

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


# Joints of drawn children: with physics steps of 5 ms, none goes further than 10 degrees beyond its range; with 10 ms,
# up to 30, as a blow can turn a finger by 30 degrees in a single step. 600 children are drawn, average ones and
# individuals between percentiles 1 and 99 of the WHO, of any age, with mittens and five fingers, torques, muscles and
# servos. Commands at the ends of their ranges change at random, or all at once, up to 50 times a second to and fro;
# each child is tried with two of five durations.

KINDS, CHUNKS = 12, 50
UNUSUAL = 48
"""Numbers after which `draw` comes back to infants without scaled parts and muscles."""
STEPS_MS = (5, 10)
HELD_STEPS = (1, 2, 5, 10, 30)
"""For how many control steps of 10 ms a command is held."""
BEYOND_DEG = {5: 10, 10: 30}
"""By physics step in milliseconds."""


def drawn_child(number: int) -> dict:
    generator = np.random.default_rng(number)
    spec = draw(generator, number // KINDS * UNUSUAL + number % KINDS)
    step_ms = STEPS_MS[number // KINDS % 2]
    return {**spec, "development": "maturing", "control": {"timestep_ms": step_ms, "step_ms": 10}}


def commands(model, generator, steps: int, *, at_random: bool) -> Iterator[np.ndarray]:
    low, high = model.actuator_ctrlrange.T
    driven = model.actuator_gear[:, 0] > 0
    while True:
        driven = generator.random(model.nu) < 0.5 if at_random else ~driven
        yield from repeat(np.where(driven, high, low), steps)


@pytest.mark.full
@pytest.mark.parametrize("chunk", full_but([0, 1], range(CHUNKS)))
def test_no_joint_of_a_drawn_child_goes_far_beyond_its_range(chunk):
    for number in range(KINDS * chunk, KINDS * (chunk + 1)):
        spec = drawn_child(number)
        model = compile_infant(mimoc.InfantSpec.model_validate(spec))
        generator = np.random.default_rng(number)
        for steps in (HELD_STEPS[number % 5], HELD_STEPS[(number + 2) % 5]):
            for at_random in (True, False):
                data = mujoco.MjData(model)
                mujoco.mj_resetDataKeyframe(model, data, model.key(spec["scene"]["pose"]).id)
                to_and_fro = commands(model, generator, steps, at_random=at_random)
                result = flail(data, to_and_fro, 0.01, ROOT)
                assert result.warnings == (), spec
                assert result.energy_j_per_kg < MAX_ENERGY_J_PER_KG / 2, spec
                assert result.beyond_deg < BEYOND_DEG[spec["control"]["timestep_ms"]], (
                    result.joint,
                    steps,
                    at_random,
                    spec,
                )
