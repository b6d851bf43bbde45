"""Nothing breaks down and no joint is flung out, however an infant is made and whatever it is commanded.

`benchmarks/flailing.py` draws 300 infants; here are 48, one of every kind that it draws, and the worst that were found.
"""

import dataclasses
import re
import sys
from collections.abc import Iterator
from itertools import islice, repeat
from pathlib import Path

import mujoco
import numpy as np
import pytest
from support.full import full_but

import mimoc
from mimoc.base.errors import ModelError
from mimoc.bundle.model import load_model
from mimoc.compiler.measuring import ROOT, compile_infant
from mimoc.runtime.check import COMMANDS, MAX_BEYOND_DEG, MAX_ENERGY_J_PER_KG, PoseCheck, check_stability, flail

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


# What `mimoc check` finds.


def changed(bundle, pattern, replacement):
    """Return a bundle whose body says something else."""
    body, count = re.subn(pattern, replacement, bundle.files["scene.xml"].decode())
    assert count
    return dataclasses.replace(bundle, files={**bundle.files, "scene.xml": body.encode()})


@pytest.mark.matrix
def test_every_config_stays_calm_in_every_pose(config):
    for check in check_stability(config):
        assert check.passed
        assert check.warnings == ()
        assert 0 < check.energy_j_per_kg < MAX_ENERGY_J_PER_KG / 2
        assert check.beyond_deg < MAX_BEYOND_DEG / 1.3


def test_a_body_that_explodes_fails_quietly(bundle, capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    explosive = changed(bundle, 'gear="[^"]+"', 'gear="1e9"')
    checks = list(check_stability(explosive))
    assert not any(check.passed for check in checks)
    assert all(set(check.warnings) & {"BADQPOS", "BADQVEL", "BADQACC"} for check in checks)
    assert capfd.readouterr() == ("", "")
    assert not list(tmp_path.iterdir())


def test_a_body_that_is_far_too_strong_fails(bundle):
    strong = changed(bundle, 'gear="([^"]+)"', lambda gear: f'gear="{30 * float(gear[1])}"')
    assert not all(check.passed for check in check_stability(strong))


def test_the_same_bundle_is_judged_the_same(bundle):
    assert list(check_stability(bundle)) == list(check_stability(bundle))


def test_a_bundle_that_does_not_compile_is_an_error(bundle):
    with pytest.raises(ModelError):
        list(check_stability(changed(bundle, "<joint ", "<jiont ")))


@pytest.mark.parametrize(
    ("warnings", "energy_j_per_kg", "beyond_deg", "passed"),
    [
        ((), 1.0, 0.0, True),
        ((), MAX_ENERGY_J_PER_KG, MAX_BEYOND_DEG, True),
        ((), MAX_ENERGY_J_PER_KG + 1, 0.0, False),
        ((), float("inf"), 0.0, False),
        ((), 1.0, MAX_BEYOND_DEG + 1, False),
        (("CONTACTFULL",), 1.0, 0.0, False),
    ],
)
def test_a_pose_passes_without_warnings_and_within_bounds(warnings, energy_j_per_kg, beyond_deg, passed):
    assert PoseCheck(warnings, energy_j_per_kg, beyond_deg, "robot:left_knee", "supine").passed == passed


def test_a_joint_that_is_flung_out_fails_and_is_named(bundle):
    """An elbow with a motor forty times as strong."""
    strong = changed(bundle, '(name="act:left_elbow".*? gear)="[^"]+"', r'\1="150"')
    found = list(check_stability(strong))
    assert not any(check.warnings for check in found)
    flung = {check.joint for check in found if not check.passed}
    assert flung
    assert flung <= {"robot:left_elbow", "robot:left_fingers"}


@pytest.mark.parametrize("model", ["torque", "muscle", "position"])
def test_alternating_commands_push_every_joint_to_and_fro(built, model):
    """At full command each way, switched every 50 to 100 ms; of two muscles one pulls and the other rests."""
    infant = load_model(built(actuation={"model": model}))
    stream = COMMANDS["alternating"](infant, np.random.default_rng(0), 0.01)
    rows = np.array([next(stream) for _ in range(1000)])
    low, high = infant.actuator_ctrlrange.T
    assert set(np.unique(rows)) == {low[0], high[0]}
    ways = (rows - low) / (high - low) * 2 - 1
    pulls = ways * np.sign(infant.actuator_gear[:, 0])
    assert (pulls == pulls[:, :1]).all()
    switches = np.flatnonzero(np.diff(pulls[:, 0]))
    assert set(np.diff(switches)) == {5, 6, 7, 8, 9, 10}


def test_every_pose_of_the_manifest_is_checked(bundle):
    assert [check.pose for check in check_stability(bundle)] == list(bundle.manifest.poses)
