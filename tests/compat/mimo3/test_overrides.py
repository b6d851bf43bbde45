"""Classes that users derived from MIMo3's environments run, and what is never called is said."""

import mujoco
import numpy as np
import pytest
from gymnasium.envs.registration import register, registry

from mimoc.base.errors import MimocError
from mimoc.compat.mimo3 import (
    DEFAULT_PROPRIOCEPTION_PARAMS,
    DEFAULT_TOUCH_PARAMS,
    DEFAULT_VESTIBULAR_PARAMS,
    STANDUP_XML,
    MIMoEnv,
    MIMoReachEnv,
    SimpleVision,
    TrimeshTouch,
    mimo_utils,
)


class HeadUp(MIMoEnv):
    """The environment of MIMo3's guide to experiments of one's own, with its hooks."""

    def __init__(
        self,
        model_path=STANDUP_XML,
        proprio_params=DEFAULT_PROPRIOCEPTION_PARAMS,
        touch_params=None,
        vision_params=None,
        vestibular_params=DEFAULT_VESTIBULAR_PARAMS,
        done_active=False,
        **kwargs,
    ):
        self.calls = []
        super().__init__(
            model_path=model_path,
            proprio_params=proprio_params,
            touch_params=touch_params,
            vision_params=vision_params,
            vestibular_params=vestibular_params,
            done_active=done_active,
            **kwargs,
        )

    def get_achieved_goal(self):
        return self.data.body("head").xpos[2]

    def is_success(self, achieved_goal, desired_goal):
        return achieved_goal > desired_goal

    def is_failure(self, achieved_goal, desired_goal):
        return False

    def is_truncated(self):
        return len(self.calls) >= 3

    def sample_goal(self):
        return 0.1

    def compute_reward(self, achieved_goal, desired_goal, info):
        return achieved_goal - 0.2 - 0.01 * np.square(self.data.ctrl).sum()

    def _step_callback(self):
        self.calls.append("step")

    def reset_model(self):
        self.set_state(self.init_qpos, self.init_qvel)
        qpos = self.init_qpos.copy()
        qpos[7:] += self.np_random.uniform(low=-0.01, high=0.01, size=len(qpos[7:]))
        self.set_state(qpos, np.zeros(self.data.qvel.shape))
        self._set_action(np.zeros(self.action_space.shape))
        mujoco.mj_step(self.model, self.data, nstep=100)
        return self._get_obs()


def test_an_environment_of_the_guide_runs():
    env = HeadUp()
    observation, _ = env.reset(seed=0)
    assert observation["achieved_goal"] == env.data.body("head").xpos[2]
    joints = [env.data.joint(name).qpos[0] for name in env.proprioception.sensor_names["qpos"]]
    assert env.proprioception.sensor_outputs["qpos"] == pytest.approx(joints, abs=1e-6)
    assert env.data.time == pytest.approx(0.5)
    observation, reward, terminated, truncated, info = env.step(np.full(29, 0.5))
    assert reward == pytest.approx(env.get_achieved_goal() - 0.2 - 0.01 * np.square(env.data.ctrl).sum())
    assert (terminated, truncated, info["is_success"], info["is_failure"]) == (False, False, True, False)
    env.step(np.zeros(29))
    assert env.step(np.zeros(29))[3]


def test_it_can_be_registered_and_ends_where_it_says():
    register("HeadUp-v0", HeadUp, max_episode_steps=500)
    env = HeadUp(done_active=True)
    assert env.step(np.zeros(29))[2]
    registry.pop("HeadUp-v0")


def test_seeds_repeat_what_a_reset_draws():
    env = HeadUp()
    first, other, again = (env.reset(seed=seed)[0]["observation"] for seed in (1, 2, 1))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_a_ball_hangs_where_a_reset_puts_it():
    class Far(MIMoReachEnv):
        def reset_model(self):
            mimo_utils.set_joint_qpos(self.model, self.data, "target_joint", [1, 0, 0.5, 1, 0, 0, 0])
            self.set_state(self.data.qpos.copy(), np.zeros(self.data.qvel.shape))
            return self._get_obs()

        def compute_reward(self, achieved_goal, desired_goal, info):
            return 2 * super().compute_reward(achieved_goal, desired_goal, info)

    env = Far()
    env.reset(seed=0)
    _, reward, terminated, _, info = env.step(np.zeros(8))
    assert not terminated
    assert reward == 2 * info["reward_terms"]["distance"] < -1


def test_a_sense_of_the_users_own_takes_the_place_of_one():
    class Contacts:
        def __init__(self, env, params):
            self.env = env

        def get_touch_obs(self):
            return np.array([self.env.data.ncon], np.float32)

    class Counting(MIMoEnv):
        def touch_setup(self, touch_params):
            self.touch = Contacts(self, touch_params)

        def get_proprio_obs(self):
            return super().get_proprio_obs()[:4]

    env = Counting(touch_params=DEFAULT_TOUCH_PARAMS)
    observation, _ = env.reset(seed=0)
    assert observation["touch"] == [env.data.ncon]
    assert observation in env.observation_space
    assert observation["observation"].shape == (4,)


def test_a_sense_is_built_by_the_parameters_of_its_environment():
    class Fingers(MIMoEnv):
        def touch_setup(self, touch_params):
            self.touch = TrimeshTouch(self, {"scales": {"left_fingers": 0.1}})

    with pytest.raises(MimocError, match="give these parameters to its environment as touch_params"):
        Fingers(touch_params=DEFAULT_TOUCH_PARAMS)
    with pytest.raises(MimocError, match="vision is built with the infant"):
        SimpleVision(MIMoEnv(), None)


def test_joints_start_where_they_are_asked_to_and_locks_hold_from_the_next_reset():
    env = MIMoEnv(initial_qpos={"robot:left_elbow": -1.0})
    env.reset(seed=0)
    assert env.data.joint("robot:left_elbow").qpos == -1
    mimo_utils.lock_joint(env.model, "robot:right_knee", joint_angle=-1.0)
    env.reset(seed=0)
    for _ in range(30):
        env.step(np.ones(46))
    assert env.data.joint("robot:right_knee").qpos[0] == pytest.approx(-1, abs=0.1)
    with pytest.raises(MimocError, match="did you mean 'robot:left_knee'"):
        MIMoEnv(initial_qpos={"robot:knee": 0})


def test_what_is_never_called_or_not_there_is_said():
    class Substeps(MIMoEnv):
        def _substep_callback(self):
            raise AssertionError

    with pytest.raises(MimocError, match="frame_skip=1 and use _step_callback"):
        Substeps()
    env = HeadUp()
    with pytest.raises(AttributeError, match=r"no attribute 'mujoco_renderer'; call render\(\)"):
        _ = env.mujoco_renderer
    with pytest.raises(AttributeError, match=r"has no attribute 'weight'; see docs/from_mimo\.md"):
        _ = env.weight
    with pytest.raises(AttributeError, match="mimo_utils has no 'plot_forces' here; use MuJoCo's names"):
        mimo_utils.plot_forces(env.data)


def test_what_takes_no_action_of_this_shape_says_so():
    with pytest.raises(ValueError, match=r"expected an action of shape \(29,\), got shape \(46,\)"):
        HeadUp().step(np.zeros(46))
