"""The arrays of general movements: rows are infants, all libraries agree, and commands stay in their range."""

import warnings
from dataclasses import fields, replace
from functools import cache

import array_api_strict
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.store import built

from mimoc.bundle.model import load_model
from mimoc.policies.general_movements.generator import GeneralMovements, draw
from mimoc.policies.general_movements.law import AGES_MONTHS, COLUMNS, Joints, Law, joints_of, law_at
from mimoc.runtime.actuation import bind_actuation

STEP_S = 0.01
MODELS = ("muscle", "torque", "position")


@cache
def joints(model: str = "muscle", hands: str = "mitten", age_months: float = 3.0) -> Joints:
    bundle = built(
        {
            "mimoc": 1,
            "name": "mover",
            "age_months": age_months,
            "actuation": {"model": model},
            "body": {"hands": hands},
        }
    )
    return joints_of(bundle.manifest.actuation, bind_actuation(bundle.manifest.actuation, load_model(bundle)))


def commands(laws: list[Law], seeds: list[int], steps: int = 100, arousal: float = 1.0, **options) -> np.ndarray:
    """Return what infants are commanded, shape (steps, k, n)."""
    movement = GeneralMovements(options.pop("joints", None) or joints(), laws, STEP_S, **options)
    generators = [np.random.default_rng(seed) for seed in seeds]
    movement.start(draw(generators, 0, movement.starts)[1])
    numbers = (draw(generators, movement.uniforms, movement.normals) for _ in range(steps))
    return np.array([movement.step(*pair, arousal) for pair in numbers])


def test_an_infant_among_many_moves_as_it_does_alone():
    """To the bit, whatever the ages of the others are."""
    laws = [law_at(age) for age in (0.0, 3.0, 5.0, 12.0, 24.0)]
    together = commands(laws, [0, 1, 2, 3, 4])
    for row, law in enumerate(laws):
        assert np.array_equal(commands([law], [row])[:, 0], together[:, row])


def test_the_seed_decides():
    again, once, other = (commands([law_at(3)], [seed]) for seed in (7, 7, 8))
    assert np.array_equal(again, once)
    assert not np.array_equal(again, other)


@settings(max_examples=20, deadline=None)
@given(
    age_months=st.floats(0, 24),
    seed=st.integers(0, 2**32),
    model=st.sampled_from(MODELS),
    hands=st.sampled_from(("mitten", "five_finger")),
    arousal=st.floats(0, 2),
    strength=st.floats(0, 5),
)
def test_commands_stay_in_their_range(age_months, seed, model, hands, arousal, strength):
    """At any age, with any actuators, however strong the bursts are."""
    body = joints(model, hands)
    law = replace(law_at(age_months), strength=strength)
    given_commands = commands([law], [seed], 30, arousal, joints=body)
    assert np.isfinite(given_commands).all()
    assert (given_commands >= body.low).all()
    assert (given_commands <= body.high).all()


@pytest.mark.parametrize("model", MODELS)
def test_without_arousal_bursts_end(model):
    """What is left is the posture and its slow changes."""
    awake, asleep = (commands([law_at(3)], [0], 300, arousal, joints=joints(model)) for arousal in (1.0, 0.0))
    assert np.abs(np.diff(asleep, axis=0)).max() < 0.5 * np.abs(np.diff(awake, axis=0)).max()


def test_left_and_right_move_alike_on_average():
    body, energy = joints("torque"), np.zeros(2)
    for row in commands([law_at(3)] * 8, list(range(8)), 1000, joints=body).transpose(1, 0, 2):
        for index, side in enumerate(("left", "right")):
            names = [name.startswith(f"robot:{side}") for name in body.names] + [False]
            energy[index] += row[:, np.array(names)[body.hinges]].std()
    assert 0.8 < energy[0] / energy[1] < 1.25


def hip_and_knee(age_months: float) -> tuple[float, float]:
    """Return how the commands of hip and knee correlate, and those of both hips, with motors."""
    body = joints("torque")
    rows = commands([law_at(age_months)] * 10, list(range(10)), 1500, joints=body)
    columns = {name: rows[..., list(body.hinges).index(body.names.index(f"robot:{name}"))].T for name in LEGS}
    pairs = [("left_hip1", "left_knee"), ("left_hip1", "right_hip1")]
    return tuple(
        np.mean([np.corrcoef(*row)[0, 1] for row in zip(*map(columns.get, pair), strict=True)]) for pair in pairs
    )


LEGS = "left_hip1", "right_hip1", "left_knee"


@pytest.mark.full
def test_joints_of_a_leg_come_apart_and_legs_come_together_with_age():
    """Thelen 1985; Chen 2020; Thelen, Ridley-Johnson & Fisher 1983; as one most of all at 2 months (Piek 1996)."""
    coupled, phases = zip(*map(hip_and_knee, (0, 2, 4, 9)), strict=True)
    assert coupled[1] > max(coupled[2:]) + 0.3
    assert coupled[1] > coupled[0] > 0.8
    assert phases[0] < -0.2 < 0.05 < min(phases[2:])


def test_the_law_has_every_number():
    assert set(COLUMNS) == {field.name for field in fields(Law)}
    assert {len(column) for column in COLUMNS.values()} == {len(AGES_MONTHS)}


def test_the_law_is_continuous_in_age():
    for age in AGES_MONTHS:
        before, at, after = (law_at(age + shift) for shift in (-1e-6, 0.0, 1e-6))
        for name in COLUMNS:
            assert getattr(before, name) == pytest.approx(getattr(at, name), abs=1e-4)
            assert getattr(after, name) == pytest.approx(getattr(at, name), abs=1e-4)


def test_a_grown_infant_keeps_its_style_and_its_movement():
    """The next command after a day of growth is nearly what it would have been."""
    movements = [GeneralMovements(joints(), [law_at(3)], STEP_S) for _ in range(2)]
    numbers = np.random.default_rng(0)
    start = numbers.standard_normal((1, movements[0].starts))
    for movement in movements:
        movement.start(start)
    for step in range(50):
        if step == 49:
            movements[1].set_laws([law_at(3 + 1 / 30)])
        pair = numbers.random((1, movements[0].uniforms)), numbers.standard_normal((1, movements[0].normals))
        same, grown = (movement.step(*pair) for movement in movements)
    assert grown == pytest.approx(same, abs=0.02)


@pytest.mark.extras
def test_torch_gives_the_same_within_single_precision():
    import torch
    from array_api_compat import torch as array_library

    def put(array):
        return torch.as_tensor(np.asarray(array), dtype=None if array.dtype.kind in "ib" else torch.float32)

    expected, given_commands = both(array_library, put)
    assert given_commands == pytest.approx(expected, abs=1e-4)


def test_it_asks_for_no_more_than_the_array_standard():
    xp = array_api_strict
    with warnings.catch_warnings(), xp.ArrayAPIStrictFlags(boolean_indexing=False, data_dependent_shapes=False):
        warnings.simplefilter("ignore")  # Which version of the standard it is.
        expected, given_commands = both(xp, xp.asarray)
    assert given_commands == pytest.approx(expected, abs=1e-12)


def both(xp, put, steps: int = 150) -> tuple[np.ndarray, np.ndarray]:
    """Return what three infants are commanded at last, with NumPy and with another library."""
    laws, numbers = [law_at(age) for age in (0.5, 3.0, 9.0)], np.random.default_rng(1)
    plain, other = GeneralMovements(joints(), laws, STEP_S), GeneralMovements(joints(), laws, STEP_S, xp=xp, put=put)
    start = numbers.standard_normal((3, plain.starts))
    plain.start(start)
    other.start(put(start))
    for _ in range(steps):
        uniform, normal = numbers.random((3, plain.uniforms)), numbers.standard_normal((3, plain.normals))
        expected, given_commands = plain.step(uniform, normal), other.step(put(uniform), put(normal))
    return expected, np.asarray(given_commands)
