"""Small movements: smooth, as large as they are asked to be, and the same for a copy."""

import copy

import numpy as np
import pytest

import mimoc
from mimoc.policies.behaviours.behaviour import Subject
from mimoc.policies.behaviours.small_movements import LIMBS, NEW, SIZE_DEG, STIRRING, Moving, SmallMovements
from mimoc.policies.control.infant import DrivenInfant

MOVING = Moving({"arm": 1.0, "head": 0.5}, (6.0, 12.0))


@pytest.fixture(scope="module")
def subjects():
    specs = (mimoc.InfantSpec(mimoc=1, name="kim", age_months=age) for age in (6, 12))
    envs = [mimoc.make(spec).unwrapped for spec in specs]
    return [Subject(DrivenInfant.of(env.model, env.manifest), env.manifest) for env in envs]


def moved(movements, steps, seed=0):
    generator = np.random.default_rng(seed)
    return np.array([(movements.advance(generator), movements.offsets_rad)[1] for _ in range(steps)])


def test_angles_vary_by_the_weight_of_the_joint_and_less_in_a_new_posture(subjects):
    """Stirring by a third adds to the movements of limbs, less what the filters take."""
    for subject, share in zip(subjects, (NEW, 1.0), strict=True):
        offsets_deg = np.degrees(moved(SmallMovements(subject, MOVING), 6000))
        for index, name in enumerate(subject.infant.joint_names):
            part = name.removeprefix("left_").removeprefix("right_")
            limb = next((limb for limb in MOVING.limbs if part in LIMBS[limb]), None)
            size_deg = share * SIZE_DEG * MOVING.limbs[limb] * LIMBS[limb][part] if limb else 0.0
            assert 0.6 * size_deg <= offsets_deg[:, index].std() <= 1.4 * np.hypot(1.0, STIRRING) * size_deg


def test_movements_are_smooth(subjects):
    """From one control step of 10 ms to the next, no joint turns by more than a tenth of its largest deviation."""
    offsets_rad = moved(SmallMovements(subjects[1], MOVING), 2000)
    largest = np.abs(offsets_rad).max(axis=0)
    assert (np.abs(np.diff(offsets_rad, axis=0)).max(axis=0) <= 0.1 * largest).all()


def test_a_copy_goes_on_alike_and_a_new_episode_begins_in_the_posture(subjects):
    movements = SmallMovements(subjects[0], MOVING)
    moved(movements, 50)
    twin = copy.deepcopy(movements)
    assert np.array_equal(moved(movements, 50, seed=1), moved(twin, 50, seed=1))
    movements.begin()
    assert not movements.offsets_rad.any()
