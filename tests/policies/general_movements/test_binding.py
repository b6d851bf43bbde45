"""Infants under the policy `general_movements`."""

from contextlib import closing
from functools import cache

import numpy as np
import pytest
from support.store import built

from mimoc.base.quantities.movement import CORE
from mimoc.movement.filming import Filmed, film_policy
from mimoc.movement.real_infants import real_infants
from mimoc.movement.report import measure_all
from mimoc.movement.sample import distance, standard_scores
from mimoc.policies.general_movements.generator import bind, bind_many
from mimoc.policies.policy import Batch
from mimoc.runtime.opening.environments import open_infant
from mimoc.schema.infant import InfantSpec

POLICY = "general_movements"


def infant(**changes):
    spec = {"mimoc": 1, "name": "mover", "age_months": 3, "scene": {"kind": "flat", "pose": "supine"}}
    return built(spec | {"actuation": {"model": "muscle"}} | changes)


def test_each_of_many_moves_as_it_does_alone():
    """Whatever their ages and their arousal are."""
    envs = [open_infant(infant(age_months=age)) for age in (0, 3, 9)]
    envs[1].set_arousal(1.5)
    generators = [np.random.default_rng(seed) for seed in range(3)]
    together = bind_many(Batch(tuple(envs), lambda: np.array([[env.arousal] for env in envs])))
    rows = np.array([together(generators, None) for _ in range(50)])
    for number, env in enumerate(envs):
        alone, generator = bind(env), np.random.default_rng(number)
        assert np.array_equal([alone(generator, {}) for _ in range(50)], rows[:, number])
        env.close()


def test_arousal_makes_it_move_more():
    def speed(arousal: float) -> float:
        with closing(open_infant(infant(actuation={"model": "torque"}))) as env:
            env.reset(seed=0, options={"arousal": arousal})
            policy, generator, speeds = bind(env), np.random.default_rng(0), []
            for _ in range(400):
                env.step(policy(generator, {}))
                speeds.append(np.abs(env.data.qvel[6:]).mean())
        return float(np.mean(speeds))

    asleep, quiet, awake = map(speed, (0.0, 1.0, 2.0))
    assert asleep < 0.5 * quiet < 0.5 * awake


def test_an_infant_moves_on_when_it_grows():
    with closing(open_infant(InfantSpec(mimoc=1, name="grower", age_months=3))) as env:
        env.reset(seed=0)
        policy, generator = bind(env), np.random.default_rng(0)
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
        policy, generator = bind(env), np.random.default_rng(0)
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
    return next(film_policy(infant(age_months=age_months), POLICY, [seed], 33.0))


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
