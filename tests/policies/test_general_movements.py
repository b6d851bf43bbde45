"""The arrays of general movements: rows are infants, all libraries agree, and commands stay in their range."""

import warnings
from contextlib import closing
from dataclasses import fields, replace
from functools import cache

import array_api_strict
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.store import built

from mimoc.base.movement_quantities import CORE
from mimoc.bundle.model import load_model
from mimoc.movement.filming import Filmed, film_policy
from mimoc.movement.report import measure_all
from mimoc.movement.sample import distance, real_infants, standard_scores
from mimoc.policies.felt_hinges import FeltHinges, Turned
from mimoc.policies.general_movements import GeneralMovements, Moving, draw
from mimoc.policies.movement_law import AGES_MONTHS, COLUMNS, Joints, Law, joints_of, law_at
from mimoc.policies.named import policy_of
from mimoc.policies.policy import Batch, batch_of_one
from mimoc.runtime.actuation import bind_actuation
from mimoc.runtime.opening import open_infant
from mimoc.schema.infant import InfantSpec

STEP_S = 0.01
MODELS = ("muscle", "torque", "position")


@cache
def joints(model: str = "muscle", hands: str = "mitten", age_months: float = 3.0) -> Joints:
    keys = {"actuation": {"model": model}, "body": {"hands": hands}}
    bundle = built({"mimoc": 1, "name": "mover", "age_months": age_months, **keys})
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
        neck = numbers.normal(0.0, 0.3, (2, 3, len(joints().neck)))
        expected = plain.step(uniform, normal, 1.0, Turned(*neck))
        given_commands = other.step(put(uniform), put(normal), 1.0, Turned(*map(put, neck)))
    return expected, np.asarray(given_commands)


def infant(**changes):
    spec = {"mimoc": 1, "name": "mover", "age_months": 3, "scene": {"kind": "flat", "pose": "supine"}}
    return built(spec | {"actuation": {"model": "muscle"}} | changes)


def test_each_of_many_moves_as_it_does_alone():
    """Whatever their ages and their arousal are."""
    envs = [open_infant(infant(age_months=age)) for age in (0, 3, 9)]
    envs[1].set_arousal(1.5)
    generators = [np.random.default_rng(seed) for seed in range(3)]
    together = Moving(Batch(tuple(envs), lambda: np.array([[env.arousal] for env in envs])))
    rows = np.array([together(generators, {}) for _ in range(50)])
    for number, env in enumerate(envs):
        alone, generator = policy_of(env, "general_movements"), np.random.default_rng(number)
        assert np.array_equal([alone(generator, {}) for _ in range(50)], rows[:, number])
        env.close()


@pytest.mark.parametrize(("age_months", "is_kept"), [(1, False), (3, True)])
@pytest.mark.parametrize("senses", [{}, {"proprioception": {}}])
def test_the_head_is_kept_in_the_midline_from_three_months_on(age_months, is_kept, senses):
    """By the angles of the neck that it feels, or, without the sense, by those of the simulation, which is said."""
    with closing(open_infant(infant(age_months=age_months, senses=senses))) as env:
        observation, _ = env.reset(seed=0)
        swivel = env.data.joint("robot:head_swivel")
        swivel.qpos[:] = 1.0
        policy, generator = policy_of(env, "general_movements"), np.random.default_rng(0)
        for _ in range(200):
            observation, *_ = env.step(policy(generator, observation))
        assert (abs(float(swivel.qpos[0])) < np.radians(20)) == is_kept
        assert policy.metrics() == ({} if senses else {"midline_without_proprioception": True})


def test_what_is_felt_of_the_neck_is_what_proprioception_says():
    with closing(open_infant(infant(senses={"proprioception": {}}))) as env:
        names = ["robot:head_tilt", "robot:head_swivel"]
        felt = FeltHinges(batch_of_one(env), names)
        env.data.joint("robot:head_tilt").qpos[:] = 0.25
        late = {"proprioception": np.linspace(0.0, 1.0, len(env.layout("proprioception")))[None]}
        columns = [env.layout("proprioception").index(f"{name} angle [rad]") for name in names]
        assert felt(late).angles_rad == pytest.approx(late["proprioception"][:, columns])
        assert felt({}).angles_rad == pytest.approx(np.array([[0.25, 0.0]]), abs=1e-3)


def test_asleep_infants_let_the_head_lie():
    """And the more awake they are, up to quiet wakefulness, the more they keep it in the midline."""
    body = joints("torque")
    movement = GeneralMovements(body, [law_at(3)] * 3, STEP_S)
    movement.start(np.zeros((3, movement.starts)))
    aside = Turned(np.full((3, 3), 0.1), np.zeros((3, 3)))
    numbers = np.ones((3, movement.uniforms)), np.zeros((3, movement.normals))
    level = np.array([[0.0], [0.5], [2.0]])
    swivel = list(body.hinges).index(body.names.index("robot:head_swivel"))
    assert movement.step(*numbers, level, aside)[:, swivel] == pytest.approx([0.0, -0.125, -0.25])


def test_arousal_makes_it_move_more():
    def speed(arousal: float) -> float:
        with closing(open_infant(infant(actuation={"model": "torque"}))) as env:
            env.reset(seed=0, options={"arousal": arousal})
            policy, generator, speeds = policy_of(env, "general_movements"), np.random.default_rng(0), []
            for _ in range(400):
                env.step(policy(generator, {}))
                speeds.append(np.abs(env.data.qvel[6:]).mean())
        return float(np.mean(speeds))

    asleep, quiet, awake = map(speed, (0.0, 1.0, 2.0))
    assert asleep < 0.5 * quiet < 0.5 * awake


def test_an_infant_moves_on_when_it_grows():
    with closing(open_infant(InfantSpec(mimoc=1, name="grower", age_months=3))) as env:
        env.reset(seed=0)
        policy, generator = policy_of(env, "general_movements"), np.random.default_rng(0)
        for age in (3.0, 3.5, 9.0):
            env.grow(age)
            for _ in range(20):
                action = policy(generator, {})
                assert env.action_space.contains(action)
                env.step(action)


@pytest.mark.parametrize(
    "changes",
    [
        {"actuation": {"regions": ["legs"]}},
        {"actuation": {"regions": ["eyes"]}},
        {"actuation": {"locked": ["trunk"], "model": "position"}},
        {"body": {"remove": ["left_upper_arm"]}},
        {"development": "published"},
    ],
)
def test_any_infant_can_move(changes):
    """With some of the joints, parts and laws of others."""
    with closing(open_infant(infant(**changes))) as env:
        env.reset(seed=0)
        policy, generator = policy_of(env, "general_movements"), np.random.default_rng(0)
        for _ in range(20):
            action = policy(generator, {})
            assert env.action_space.contains(action)
            env.step(action)


@pytest.mark.full
def test_kicks_change_with_age():
    """Hip and knee come apart by 4 to 6 months (Chen 2020); newborns' legs alternate (Thelen et al. 1983)."""
    newborn, older = (measure_all(films(age, 6)).means for age in (0, 6))
    assert newborn["hip_knee_r"] > older["hip_knee_r"] + 0.1
    assert newborn["hips_together_r"] < min(-0.1, older["hips_together_r"])
    for measures in (newborn, older):
        assert 5 < measures["kicks_per_min"] < 20
        assert 25 < measures["hip_excursion_deg"] < 60


@cache
def film(age_months: float, seed: int) -> Filmed:
    """Return an infant that is filmed as long as the real ones."""
    return next(film_policy(infant(age_months=age_months), "general_movements", [seed], 33.0))


def films(age_months: float, count: int) -> list[Filmed]:
    return [film(age_months, seed) for seed in range(12, 12 + count)]


@pytest.mark.full
def test_three_month_olds_move_like_real_infants():
    """All 21 measures within 2 SD of 12 real infants, and no farther from them than 1.2 (theirs .77-1.57)."""
    sample, measured = real_infants(), measure_all(films(3, 12))
    core = {name: measured.means[name] for name in (quantity.name for quantity in CORE)}
    assert max(map(abs, standard_scores(core, sample).values())) < 2.0
    assert distance(measured.means, sample) < 1.2
    assert np.median([distance(one, sample) for one in measured.infants]) < 1.57


@pytest.mark.full
def test_amplitude_falls_and_continuity_rises_at_three_months():
    """From writhing to fidgety movements."""
    writhing, fidgety = (measure_all(films(age, 8)).means for age in (1, 3))
    assert fidgety["hip_excursion_deg"] < 0.9 * writhing["hip_excursion_deg"]
    assert fidgety["foot_unit_peak_trunk_s"] < writhing["foot_unit_peak_trunk_s"]
    assert fidgety["foot_moving_share"] > writhing["foot_moving_share"]
