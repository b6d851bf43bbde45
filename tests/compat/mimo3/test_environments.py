"""MIMo3's ids make environments with its keys and shapes, and programs written for it run."""

import copy
import pickle
import subprocess
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.registration import registry
from gymnasium.utils.env_checker import check_env

import mimoc.compat.mimo3 as mimo3
from mimoc.base.errors import MimocError
from mimoc.compat.mimo3.tasks import ELSEWHERE, ENVIRONMENTS, register_ids

NO_EYES = {"vision_params": None}
SHAPES = {
    "MIMoReach-v0": ({}, {"observation": (305,)}),
    "MIMoStandup-v0": ({}, {"observation": (305,), "vestibular": (6,)}),
    "MIMoSelfBody-v0": ({}, {"observation": (305,), "touch": None, "achieved_goal": (12,), "desired_goal": (12,)}),
    "MIMoCatch-v0": ({}, {"observation": (802,), "touch": None}),
    "MIMoRollOver-v0": ({}, {"observation": (305,), "vestibular": (6,)}),
    "MIMoBench-v0": (NO_EYES, {"observation": (305,), "touch": None, "vestibular": (6,)}),
    "MIMoBenchV2-v0": (NO_EYES, {"observation": (621,), "touch": None, "vestibular": (6,)}),
    "MIMoMuscle-v0": (NO_EYES, {"observation": (801,), "touch": None, "vestibular": (6,)}),
}


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_an_id_makes_an_environment_with_mimo3s_observations(name):
    keywords, shapes = SHAPES[name]
    env = gymnasium.make(name, **keywords)
    assert env.spec.max_episode_steps == ENVIRONMENTS[name][1]
    observation, _ = env.reset(seed=0)
    if "touch" in shapes:
        shapes = {**shapes, "touch": (3 * env.unwrapped.touch.get_total_sensor_count(),)}
    assert {key: array.shape for key, array in observation.items()} == shapes
    for _ in range(5):
        observation, reward, *_ = env.step(env.action_space.sample())
        assert observation in env.observation_space
        assert isinstance(reward, float)


def test_importing_mimoc_alone_registers_nothing_of_mimo3s():
    program = "import mimoc, gymnasium; print([name for name in gymnasium.registry if name.startswith('MIMo')])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_ids_are_mimocs_whoever_had_them_and_those_without_a_counterpart_say_what_to_use():
    registry.pop("MIMoReach-v0")
    gymnasium.register("MIMoReach-v0", "somebody.else:Env")
    register_ids()
    assert registry["MIMoReach-v0"].entry_point == "mimoc.compat.mimo3:MIMoReachEnv"
    for name in ELSEWHERE:
        with pytest.raises(MimocError, match=f"{name} has no counterpart in mimoc; use "):
            gymnasium.make(name)


@pytest.mark.filterwarnings("ignore:.*A Box observation space m.*imum value is", "ignore:.*render_modes")
@pytest.mark.parametrize("kind", [mimo3.MIMoReachEnv, mimo3.MIMoSelfBodyEnv])
def test_gymnasium_finds_no_fault(kind):
    check_env(kind(), skip_render_check=True)


def test_a_program_of_mimo3s_runs_with_the_import_changed():
    """As its script for training and testing does, without the training."""
    env = gymnasium.make("MIMoStandup-v0", actuation_model=mimo3.MuscleModel, age=12)
    env.reset()
    for _ in range(3):
        obs, _, done, trunc, _ = env.step(env.action_space.sample())
        if done or trunc:
            obs, _ = env.reset()
    assert obs["observation"].shape == (397,)
    assert env.unwrapped.dt == pytest.approx(0.01)


def test_a_reach_ends_with_a_touch_unless_done_is_not_active():
    for active in (True, False):
        env = mimo3.MIMoReachEnv(done_active=active)
        env.reset(seed=0)
        env.data.joint("target_joint").qpos[0] += 0.05
        _, reward, terminated, _, info = env.step(np.zeros(8))
        assert (terminated, info["is_success"], reward > 90) == (active, True, True)
        assert info["desired_goal"].shape == info["achieved_goal"].shape == (0,)


def test_a_caught_ball_is_observed_by_its_radius_and_effort_need_not_cost():
    env = mimo3.MIMoCatchEnv(action_penalty=False)
    observation, _ = env.reset(seed=3)
    assert observation["observation"][-1] == pytest.approx(env.model.geom("ball").size[0])
    _, reward, *_, info = env.step(np.ones(58))
    terms = info["reward_terms"]
    assert terms["effort"] < 0
    assert reward == pytest.approx(sum(terms.values()) - terms["effort"])
    with pytest.raises(MimocError, match="jitter"):
        mimo3.MIMoCatchEnv(jitter=True)


def test_goals_are_those_of_the_task():
    env = mimo3.MIMoSelfBodyEnv()
    observation, _ = env.reset(seed=1)
    assert observation["desired_goal"].sum() == 1
    assert env.target_body == env.infant.manifest.task.targets[int(observation["desired_goal"].argmax())].name
    rolling = mimo3.MIMoRollOverEnv()
    rolling.reset(seed=0)
    assert rolling.goal == 0.8
    assert 0 <= rolling.get_achieved_goal() < 0.2


def test_modules_hand_out_what_was_observed():
    env = mimo3.MIMoDummyEnv(vision_params=None)
    observation, _ = env.reset(seed=0)
    outputs = env.proprioception.sensor_outputs
    assert np.array_equal(np.concatenate([outputs[name] for name in sorted(outputs)]), observation["observation"])
    joints = [env.data.joint(name).qpos[0] for name in env.proprioception.sensor_names["qpos"]]
    assert outputs["qpos"] == pytest.approx(joints, abs=1e-6)
    hand = env.model.body("left_hand").id
    assert env.touch.sensor_outputs[hand].shape == env.touch.sensor_positions[hand].shape
    assert env.touch.get_sensor_count(hand) == len(env.touch.sensor_positions[hand])
    assert 3 * env.touch.get_total_sensor_count() == observation["touch"].size
    assert env.actuation_model.cost() == 0


def test_the_order_of_vestibular_sensors_is_kept():
    usual, other = (mimo3.MIMoEnv(vestibular_params={"sensors": names}) for names in (SENSORS, SENSORS[::-1]))
    first, second = (env.reset(seed=0)[0]["vestibular"] for env in (usual, other))
    assert np.array_equal(np.roll(first, 3), second)


SENSORS = mimo3.DEFAULT_VESTIBULAR_PARAMS["sensors"]


def test_copies_and_pickles_go_on_alike():
    env = mimo3.MIMoStandupEnv()
    env.reset(seed=0)
    env.step(np.ones(29))
    others = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    expected = env.step(np.zeros(29))
    for other in others:
        assert other.step(np.zeros(29))[1] == expected[1]


def test_eyes_and_cameras_draw(tmp_path):
    eye = {"width": 32, "height": 24, "fovy": 60, "acuity": True, "foveation": False}
    vision = {"eye_left": eye, "eye_right": eye}
    env = mimo3.MIMoEnv(vision_params=vision, render_mode="rgb_array", camera_name="eye_left", width=40, height=30)
    observation, _ = env.reset(seed=0)
    assert observation["eye_left"].shape == (24, 32, 3)
    assert env.render().shape == (30, 40, 3)
    env.vision.save_obs_to_file(tmp_path, "_1")
    assert (tmp_path / "eye_right_1.png").exists()
    env.swap_facial_expression("happy")
    env.close()
