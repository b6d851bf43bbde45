"""The policy `reflexes`: ages, senses, memory, many infants, and what is said of it."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as some
from support.examiner import SENSES

import mimoc
from mimoc.base.errors import PolicyError
from mimoc.policies.named import policy_of
from mimoc.policies.policy import Batch, batch_of_one
from mimoc.policies.reflexes import repertoire
from mimoc.policies.reflexes.binding import Reflexes, bind_many
from mimoc.policies.reflexes.repertoire import REFLEXES, AgeWindow
from mimoc.policies.reflexes.sensing import Sensed
from mimoc.runtime.worlds import NUMPY, torch_library

AGES = some.floats(0, 24)
LOSING = [reflex for reflex in REFLEXES.values() if reflex.ages.loss_months]
COMING = [reflex for reflex in REFLEXES.values() if reflex.ages.onset_months]


def sensed(chance=0.5, **changes):
    """Return what an infant senses that lies still and is touched nowhere."""
    zero, step_s = np.zeros(1), 0.01
    rest = {"pressure_n": {}, "angle_rad": {}, "speed_rad_s": {}, "rate_rad_s": (zero, zero, zero)}
    rest |= {"head_rate_rad_s": (zero, zero, zero), "head_force_m_s2": (zero + 9.81, zero, zero)}
    rest |= {"up": (zero + 1, zero, zero), "posture": zero, "weight_n": zero + 40}
    return Sensed(**{"xp": NUMPY, "step_s": step_s, "chance": zero + chance, **rest, **changes})


def started(reflex):
    return {name: np.full(1, value) for name, value in REFLEXES[reflex].start.items()}


@given(AGES, some.sampled_from(LOSING))
def test_a_reflex_is_lost_between_half_of_the_lower_age_and_the_upper(age_months, reflex):
    (lower, upper), gain = reflex.ages.loss_months, reflex.ages.gain(age_months)
    if not reflex.ages.onset_months:
        assert (gain == 1) == (age_months <= lower / 2)
    assert (gain == 0) == (age_months >= upper)
    assert 0 <= gain <= 1


@given(AGES, some.sampled_from(COMING))
def test_a_reflex_comes_between_its_ages_of_onset(age_months, reflex):
    (first, last), gain = reflex.ages.onset_months, reflex.ages.gain(age_months)
    if age_months <= first:
        assert gain == 0
    if age_months >= last and not reflex.ages.loss_months:
        assert gain == 1


@given(AGES, AGES, some.sampled_from(list(REFLEXES.values())))
def test_gains_change_slowly_with_age(one, other, reflex):
    assert abs(reflex.ages.gain(one) - reflex.ages.gain(other)) <= abs(one - other) + 1e-9


def test_a_window_without_ages_is_a_reflex_for_life():
    assert AgeWindow().gain(np.array([0.0, 24.0])).tolist() == [1, 1]


def test_a_pull_tightens_the_grip():
    touched = {"pressure_n": {"right palm": np.ones(1)}}
    drives, _ = repertoire.palmar_grasp(sensed(**touched), started("palmar_grasp"))
    pulled = sensed(**touched, speed_rad_s={"right_fingers": np.full(1, 2.0)})
    tighter, _ = repertoire.palmar_grasp(pulled, started("palmar_grasp"))
    assert tighter["right finger flexion"] > drives["right finger flexion"] > 0
    assert drives["left finger flexion"] == 0


def test_rooting_stops_where_the_head_has_turned_and_gets_used_to_a_touch():
    touched, state = sensed(pressure_n={"left cheek": np.ones(1)}), started("rooting")
    first, state = repertoire.rooting(touched, state)
    turned = sensed(pressure_n={"left cheek": np.ones(1)}, angle_rad={"head_swivel": np.full(1, 0.75)})
    assert first["head turn left"] > 0
    assert repertoire.rooting(turned, state)[0]["head turn left"] == 0
    for _ in range(3000):
        drives, state = repertoire.rooting(touched, state)
    assert drives["head turn left"] < 0.01


def test_the_tonic_reflex_is_there_two_fifths_of_the_time():
    draw, acts, count = np.random.default_rng(0), [], 2000
    state = {name: np.zeros(count) for name in REFLEXES["tonic_neck"].start}
    for _ in range(3000):
        turned = sensed(draw.random(count), angle_rad={"head_swivel": np.full(count, 0.9)})
        drives, state = repertoire.tonic_neck(turned, state)
        acts.append(np.mean(drives["left elbow extension"] > repertoire.ARM / 2))
    assert np.mean(acts[1000:]) == pytest.approx(0.4, abs=0.03)


def test_reflexes_without_their_sense_do_nothing_and_are_named(built):
    with mimoc.InfantEnv(built(age_months=1, senses={"vestibular": {}})) as env:
        policy = policy_of(env, "reflexes")
        policy(np.random.default_rng(0), env.reset(seed=0)[0])
        names = policy.metrics()
    assert {name for name, value in names.items() if value is True} == {
        *(f"{name}_without_touch" for name in ("palmar_grasp", "plantar_grasp", "rooting", "stepping", "placing")),
        "tonic_neck_without_proprioception",
    }
    assert names["moro_share"] == 0


@pytest.mark.parametrize("senses", [{}, {"touch": {"density": 0.3}}, {"proprioception": {}}])
def test_any_senses_will_do(built, senses):
    with mimoc.InfantEnv(built(age_months=1, senses=senses)) as env:
        action = policy_of(env, "reflexes")(np.random.default_rng(0), env.reset(seed=0)[0])
        assert env.action_space.contains(action)


def test_a_child_can_be_late(built):
    with mimoc.InfantEnv(built(age_months=5, senses=SENSES)) as env:
        observations = {name: reading[None] for name, reading in env.reset(seed=0)[0].items()}
        for months, gain in (("0", 0.25), ("1", 0.5), ("-1", 0.0)):
            policy = bind_many(batch_of_one(env), months)
            policy([np.random.default_rng(0)], observations)
            assert policy.gains.get("moro", 0) == pytest.approx(gain)
        for wrong in ("soon", "13", "nan"):
            with pytest.raises(PolicyError, match=rf"'reflexes:{wrong}': expected by how many months .* reflexes:1.5"):
                policy_of(env, f"reflexes:{wrong}")


def test_reflexes_follow_an_infant_that_grows():
    spec = {"mimoc": 1, "name": "infant", "age_months": 1, "senses": SENSES}
    with mimoc.make(mimoc.InfantSpec.model_validate(spec)).unwrapped as env:
        policy = policy_of(env, "reflexes")
        policy(np.random.default_rng(0), env.reset(seed=0)[0])
        before = dict(policy.many.gains)
        policy(np.random.default_rng(0), env.grow(to=9))
        after = policy.many.gains
    assert before["moro"] == 1
    assert "moro" not in after
    assert after["protective_sideways"] == 1


@pytest.mark.extras
def test_torch_gives_the_same_as_numpy(built):
    import torch

    with mimoc.InfantEnv(built(age_months=1, senses=SENSES, actuation={"model": "muscle"})) as env:
        xp, put = torch_library(torch.zeros(1))
        alone = Reflexes(batch_of_one(env))
        beside = Reflexes(Batch((env, env), lambda: None, xp, put))
        observation, _ = env.reset(seed=0)
        for step in range(30):
            rows = {name: reading[None] for name, reading in observation.items()}
            action = alone([np.random.default_rng(step)], rows)[0]
            both = {name: torch.tensor(np.concatenate([row, row])) for name, row in rows.items()}
            actions = beside([np.random.default_rng(step)] * 2, both)
            np.testing.assert_allclose(actions.numpy(), [action] * 2, atol=1e-4)
            observation, *_ = env.step(env.action_space.sample())
        beside.reset(torch.tensor([True, False]))
        assert beside._state["moro"]["since"].tolist()[0] == 100


def test_a_reset_forgets_what_was_sensed(built):
    with mimoc.InfantEnv(built(age_months=1, senses=SENSES)) as env:
        policy, generator = policy_of(env, "reflexes"), np.random.default_rng(0)
        observation, _ = env.reset(seed=0)
        first = policy.many._state
        policy(generator, observation)
        assert policy.many._state != first
        policy.reset()
        assert policy.many._state == first


def row(reflex):
    """Return the row of a reflex on its page."""
    onset, loss = reflex.ages.onset_months, reflex.ages.loss_months
    since = "birth" if onset is None else f"{onset[0]:g} to {onset[1]:g}"
    until = "stays" if loss is None else f"{loss[0]:g} to {loss[1]:g}"
    cells = since, until, ", ".join(reflex.senses), reflex.source
    return f"| `{reflex.name}` | {reflex.stimulus} | {reflex.response} | {' | '.join(cells)} |"


def test_the_page_says_of_each_reflex_what_its_record_says():
    page = Path(__file__).parents[3] / "docs" / "reflexes.md"
    rows = [line for line in page.read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    assert sorted(rows) == sorted(map(row, REFLEXES.values()))
