"""Joints of a child keep to their ranges, whatever it is commanded.

With physics steps of 5 ms, none goes further than 10 degrees beyond its range; with 10 ms, up to 30: a blow can turn a
finger by 30 degrees in a single step.

600 children are drawn, average ones and individuals between percentiles 1 and 99 of the WHO, of any age, with mittens
and five fingers, torques, muscles and servos. Commands at the ends of their ranges change at random, or all at once, up
to 50 times a second to and fro; each child is tried with two of five durations.
"""

import sys
from collections.abc import Iterator
from itertools import repeat
from pathlib import Path

import mujoco
import numpy as np
import pytest
from support.full import full_but

import mimoc
from mimoc.compiler.measuring import ROOT, compile_infant
from mimoc.runtime.check import MAX_ENERGY_J_PER_KG, flail

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
from flailing import draw

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
