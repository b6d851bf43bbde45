"""What infants take the state of their body to be: the filter, its convergence, delays, and where it works."""

import copy
from typing import Any

import mujoco
import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

import mimoc
from mimoc.base.errors import ControlError
from mimoc.policies.control.estimate import steady_gain
from mimoc.policies.named import policy_of
from mimoc.policies.policy import begin

SENSES = {"proprioception": {}, "vestibular": {}}
NOISE = {"motor": "maturing", "vestibular_thresholds": "age", "proprioception_deg": 0.5}
LATE = {"preset": "physiological"}


def infant(age_months=9.0, **keys) -> Any:
    spec: Any = {"mimoc": 1, "name": "kim", "age_months": age_months, "senses": SENSES, **keys}
    return mimoc.make(mimoc.InfantSpec(**{"scene": {"pose": "sitting"}, **spec})).unwrapped


class Sitting:
    """An infant that sits, its policy, and how far its estimate errs."""

    def __init__(self, env, policy="sit", seed=0):
        env.reset(seed=seed)
        self.env = env
        self.policy: Any = policy_of(env, policy)
        self.observation = begin(self.policy)
        self.generator = np.random.default_rng(seed)

    @property
    def estimate(self) -> Any:
        return self.policy._ensemble.estimate

    def step(self, steps=1, add=0.0):
        for _ in range(steps):
            action = self.policy(self.generator, self.observation)
            self.observation = self.env.step(np.clip(action + np.float32(add), -1, 1))[0]

    def error_deg(self) -> float:
        """Return the largest error of an angle that is sensed, now."""
        estimate = self.estimate
        now = estimate._past.qpos[-1 - estimate.lead_steps]
        hinges = estimate._angles
        return float(np.degrees(np.abs(now[hinges] - self.env.data.qpos[hinges]).max()))


@pytest.fixture(scope="module")
def nine():
    return infant()


@pytest.fixture(scope="module")
def late():
    return infant(delays=LATE, noise=NOISE)


def test_the_gain_is_that_of_the_steady_kalman_filter():
    transition, sensed = np.array([[1.0, 0.1], [0.3, 1.0]]), np.array([[1.0, 0.0]])
    process, noise = np.diag([1e-3, 1e-2]), np.array([0.04])
    gain, surprises = steady_gain(transition, sensed, process, noise)
    spread = solve_discrete_are(transition.T, sensed.T, process, np.diag(noise))
    of_surprise = sensed @ spread @ sensed.T + np.diag(noise)
    np.testing.assert_allclose(gain, spread @ sensed.T @ np.linalg.inv(of_surprise), rtol=1e-6)
    np.testing.assert_allclose(surprises, np.sqrt(np.diag(of_surprise)), rtol=1e-6)


def test_what_grows_unsensed_has_no_steady_filter():
    with pytest.raises(ControlError, match="no steady filter"):
        steady_gain(np.diag([2.0, 0.5]), np.array([[0.0, 1.0]]), np.eye(2), np.ones(1))


def test_without_noise_and_delays_the_estimate_is_the_truth(nine):
    sitting = Sitting(nine, "sit(still)")
    for _ in range(20):
        sitting.step()
        assert sitting.error_deg() < 0.2


def test_an_estimate_that_is_wrong_comes_back(nine):
    sitting = Sitting(nine, "sit(still)")
    estimate = sitting.estimate
    changes = np.zeros((len(estimate._past.qpos), 2 * len(estimate._dofs)))
    changes[:, nine.model.jnt_dofadr[nine.model.joint("robot:left_elbow").id]] = np.radians(10.0)
    estimate._shift(changes)
    mujoco.mj_step1(estimate._model, estimate.data)
    sitting.step(2)
    wrong_deg = sitting.error_deg()
    sitting.step(40)
    assert sitting.error_deg() < 0.2 * wrong_deg


def test_commands_to_nearer_muscles_are_held_back_to_act_with_the_others(late):
    estimate = Sitting(late).estimate
    acts = {estimate.delay_steps[one.commands[0]] + one.held * estimate.control_steps for one in estimate._groups}
    assert len({group.held for group in estimate._groups}) > 1
    assert max(acts) - min(acts) < estimate.control_steps
    assert estimate.lead_steps == estimate.delay_steps.max()


def test_commands_that_others_add_are_foreseen(late):
    sitting = Sitting(late)
    sitting.step(3)
    before = sitting.estimate._sent[-1].copy()
    sitting.estimate.see(sitting.policy._reader(sitting.observation), late.data, sitting.estimate._said + 0.1)
    np.testing.assert_allclose(sitting.estimate._sent[-1], before + 0.1)


def test_an_estimate_that_is_lost_begins_again_and_says_so(late):
    sitting = Sitting(late)
    sitting.step(3)
    sitting.estimate.data.qvel[6:] = 100.0
    sitting.step(1)
    assert np.abs(sitting.estimate.data.qvel).max() < 10.0
    assert any("lost once" in note for note in sitting.policy.notes())


@pytest.mark.full
def test_a_state_goes_on_as_it_did(late):
    sitting = Sitting(late)
    sitting.step(5)
    state, physics = copy.deepcopy(sitting.policy.state), late.get_state()
    generator, observation = copy.deepcopy(sitting.generator), sitting.observation
    sitting.step(5)
    went_to = late.data.qpos.copy()
    sitting.policy.state = state
    late.set_state(physics)
    sitting.generator, sitting.observation = generator, observation
    sitting.step(5)
    np.testing.assert_array_equal(late.data.qpos, went_to)


@pytest.mark.full
def test_a_second_episode_is_the_first_again(late):
    first = Sitting(late, seed=1)
    first.step(5)
    went_to = late.data.qpos.copy()
    late.reset(seed=1)
    first.observation, first.generator = begin(first.policy), np.random.default_rng(1)
    first.step(5)
    np.testing.assert_array_equal(late.data.qpos, went_to)


@pytest.mark.full
@pytest.mark.parametrize(("age_months", "held"), [(4.0, False), (9.0, True)])
def test_infants_sit_from_their_own_senses_at_nine_months_and_fall_at_four(age_months, held):
    sitting = Sitting(infant(age_months, delays=LATE, noise=NOISE))
    sitting.step(round(5000 / sitting.env.manifest.step_ms))
    assert sitting.policy.metrics()["held_share"] == held


@pytest.mark.full
def test_noise_of_the_age_does_no_harm():
    env = infant(delays=LATE, noise={**NOISE, "proprioception_deg": "age"})
    sitting = Sitting(env)
    sitting.step(200)
    assert np.isfinite(env.data.qpos).all()
    assert np.isfinite(sitting.estimate.data.qpos).all()


def test_what_is_missing_is_said(nine):
    env = infant(senses={"vestibular": {}})
    for one, policy, said in (
        (env, "sit", "as no sense tells the angles of joints"),
        (nine, "sit", "without 'touch'"),
        (nine, "sit(truth)", "true state of its body, as asked"),
    ):
        sitting: Any = policy_of(one, policy)
        assert said in sitting.notes()[0]


def test_an_idea_of_the_body_of_years_ago_is_refused(tmp_path, invoke):
    spec = tmp_path / "kim.yaml"
    spec.write_text("mimoc: 1\nname: kim\nage_months: 9\nsenses: {proprioception: {}, vestibular: {}}\n")
    done = invoke("run", spec, "--policy", "sit:lag_weeks=99")
    assert done.code == 2
    assert "lag_weeks" in done.err
