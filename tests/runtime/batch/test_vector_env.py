"""What a vector environment of infants offers."""

import importlib.util
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from support import store
from support.same import assert_same

import mimoc
from mimoc.base.errors import MimocError, MissingExtraError, UnknownNameError
from mimoc.runtime.gymnasium_forms import BatchMismatchError

SPEC = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": {"proprioception": {}}}


def spec(**keys: object) -> mimoc.InfantSpec:
    return mimoc.InfantSpec.model_validate({**SPEC, **keys})


@pytest.fixture(scope="module")
def bundle() -> mimoc.Bundle:
    return store.built(spec())


@pytest.fixture
def three(bundle):
    env = mimoc.make_vec(bundle, 3)
    yield env
    env.close()


def test_spaces_hold_what_is_observed_at_every_age():
    env = mimoc.make_vec([spec(age_months=age) for age in (1, 20)])
    observation, _ = env.reset(seed=0)
    assert env.num_envs == 2
    assert env.observation_space.contains(observation)
    single = {name: readings[1] for name, readings in observation.items()}
    assert env.single_observation_space.contains(single)
    assert env.action_space.contains(env.action_space.sample())
    env.close()


def test_gymnasium_makes_it(bundle):
    for env in (
        gymnasium.make_vec("mimoc/Infant-v0", num_envs=2, bundle=bundle),
        gymnasium.make_vec("mimoc/Infant-v0", num_envs=2, source=[spec(), bundle], threads=1),
        gymnasium.make_vec("mimoc/Reach-v0", num_envs=2, age_months=12, steps=3),
        gymnasium.make_vec("mimoc/Reach-v0", num_envs=2, age_months=[9, 12], autoreset_mode="SameStep"),
        gymnasium.make_vec("mimoc/Free-v0", num_envs=2, bundle=bundle),
    ):
        assert type(env).__name__ == "BatchEnv"
        assert env.num_envs == 2
        env.reset(seed=0)
        env.step(env.action_space.sample())
        env.close()


def test_gymnasium_tells_of_the_ages_that_were_asked_for():
    env = gymnasium.make_vec("mimoc/Reach-v0", num_envs=3, age_months=[9, 12])
    assert [each.child.age_months for each in env.get_attr("manifest")] == [9, 12, 9]
    env.close()


@pytest.mark.parametrize(
    ("other", "parts"),
    [
        ({"body": {"hands": "five_finger"}}, ["commands", "act:left_fingers"]),
        ({"actuation": {"model": "muscle"}}, ["actuation model (torque, muscle)"]),
        ({"senses": {"proprioception": {}, "vestibular": {}}}, ["senses (only the other has vestibular)"]),
        ({"control": {"step_ms": 20}}, ["control step (10 ms, 20 ms)"]),
        ({"task": {"kind": "reach"}}, ["task (free, reach)"]),
    ],
)
def test_infants_that_cannot_share_a_batch_are_told_apart(other, parts):
    with pytest.raises(BatchMismatchError) as raised:
        mimoc.make_vec([spec(), spec(**{"name": "other", **other})])
    text = str(raised.value)
    assert text.startswith("infants 0 ('infant') and 1 ('other') cannot share a batch, because they differ in ")
    assert all(part in text for part in parts)
    assert "\n" not in text


def test_more_sources_than_infants_are_an_error(bundle):
    with pytest.raises(MimocError, match="3 infants do not fit into num_envs=2"):
        mimoc.make_vec([bundle] * 3, 2)


def test_without_mujoco_warp_the_error_says_what_to_install(bundle, monkeypatch):
    for name in [name for name in sys.modules if name.startswith("mimoc.runtime.device")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(MissingExtraError, match=r"MuJoCo Warp is not installed; run: pip install 'mimoc\[gpu\]'"):
        mimoc.make_vec(bundle, 2, device="cuda:0")


@pytest.mark.extras
def test_stable_baselines3_learns_on_the_cpu_only(bundle):
    with pytest.raises(MimocError, match="Stable-Baselines3 learns from infants on the CPU; leave out device"):
        mimoc.sb3_vec_env(bundle, 2, device="cuda:0")


def test_a_seed_counts_up_and_a_list_gives_each_its_own(three):
    first, _ = three.reset(seed=7)
    assert three.np_random_seed == (7, 8, 9)
    again, _ = three.reset(seed=[7, 8, 9])
    assert_same(first, again)
    with pytest.raises(ValueError, match="expected 3 seeds"):
        three.reset(seed=[1, 2])


def test_options_are_for_all_or_for_each(three, bundle):
    alone = mimoc.make(bundle)
    found, _ = three.reset(options={"pose": ["prone", None, "sitting"]})
    for index, pose in enumerate(("prone", bundle.manifest.pose, "sitting")):
        expected, _ = alone.reset(options={"pose": pose})
        assert_same({name: readings[index] for name, readings in found.items()}, expected)
    found, _ = three.reset(options={"pose": "prone"})
    expected, _ = alone.reset(options={"pose": "prone"})
    assert_same({name: readings[2] for name, readings in found.items()}, expected)
    with pytest.raises(ValueError, match="option 'pose': expected one value for all, or 3, got 2"):
        three.reset(options={"pose": ["prone", "supine"]})
    with pytest.raises(UnknownNameError, match="'prne' is not a pose"):
        three.reset(options={"pose": "prne"})


def test_an_array_without_axes_is_a_number(three):
    three.reset(options={"arousal": np.array(0.5)})
    assert [*three.get_attr("arousal")] == [0.5] * 3
    with pytest.raises(ValueError, match="expected a non-negative integer as seed"):
        three.reset(seed=np.array(3))


def test_a_mask_leaves_the_others_where_they_are(three):
    three.reset(seed=0)
    for _ in range(3):
        observation, *_ = three.step(three.action_space.sample())
    options = {"reset_mask": np.array([False, True, False])}
    anew, info = three.reset(options=options)
    assert options.keys() == {"reset_mask"}
    assert [each.steps for each in three.infants] == [3, 0, 3]
    assert info["_unstable"].tolist() == [False, True, False]
    for index in (0, 2):
        assert_same({name: each[index] for name, each in anew.items()}, {k: v[index] for k, v in observation.items()})
    with pytest.raises(ValueError, match="boolean array of shape"):
        three.reset(options={"reset_mask": np.zeros(3, bool)})


def test_a_scene_of_its_own_for_each():
    rooms = spec(scene={"kind": "room", "seed": 1, "toys": {"count": [2, 2]}})
    env = mimoc.make_vec(rooms, 2)
    observation, _ = env.reset(seed=3, options={"scene_seed": [4, 5]})
    assert [manifest.seed for manifest in env.get_attr("manifest")] == [4, 5]
    alone = mimoc.make(rooms)
    expected, _ = alone.reset(seed=4, options={"scene_seed": 5})
    actions = env.action_space.sample()
    assert_same({name: each[1] for name, each in observation.items()}, expected)
    ours, theirs = env.step(actions)[0], alone.step(actions[1])[0]
    assert_same({name: each[1] for name, each in ours.items()}, theirs)
    env.close()


@pytest.mark.parametrize("wrong", [np.zeros((2, 44)), np.full((3, 44), np.nan)])
def test_wrong_actions_are_refused(three, wrong):
    three.reset(seed=0)
    with pytest.raises(ValueError, match=r"expected .*finite action"):
        three.step(wrong)


def test_whoever_resets_by_hand_is_told_when(bundle):
    env = mimoc.make_vec(bundle, 2, autoreset_mode=AutoresetMode.DISABLED, max_episode_steps=2)
    env.reset(seed=0)
    actions = env.action_space.sample()
    assert not env.step(actions)[3].any()
    assert env.step(actions)[3].all()
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"infants \[0, 1\]"):
        env.step(actions)
    env.reset(seed=0)
    env.step(actions)
    env.close()


def test_observations_are_new_arrays(three):
    first, _ = three.reset(seed=0)
    kept = {name: readings.copy() for name, readings in first.items()}
    three.step(three.action_space.sample())
    assert_same(first, kept)


def test_a_picture_shows_all_infants_in_rows(bundle):
    env = mimoc.make_vec(bundle, 3, render_mode="rgb_array", width=64, height=48)
    env.reset(seed=0)
    picture = env.render()
    assert picture.dtype == np.uint8
    assert picture.shape[0] >= 2 * 48
    assert picture.shape[1] >= 2 * 64
    assert [each.shape for each in env.call("render")] == [(48, 64, 3)] * 3
    env.close()


def test_attributes_and_methods_of_each_infant_can_be_had(three):
    assert three.get_attr("max_steps") == (None,) * 3
    assert three.call("effort") == pytest.approx((0.0,) * 3, abs=1e-6)  # Muscle tone is almost gone at this age.
    three.set_attr("mark", [1, 2, 3])
    assert three.get_attr("mark") == (1, 2, 3)
    assert three.threads >= 1


class Height:
    """A task and a sense that remember what they are bound to."""

    def bind(self, model, bundle):
        self.head = model.body(bundle.manifest.anatomy.head).id

    def judge(self, data, action, effort):
        return float(data.xpos[self.head, 2])


def test_each_infant_gets_a_copy_of_a_script_s_task(bundle):
    env = mimoc.make_vec(bundle, 2, task=Height())
    alone = mimoc.make(bundle, task=Height())
    env.reset(seed=0)
    alone.reset(seed=1)
    actions = env.action_space.sample()
    assert env.step(actions)[1][1] == alone.step(actions[1])[1]
    env.close()


@pytest.mark.parametrize(("clothes", "contexts"), [("trousers", 1), (None, 2)])
def test_eyes_of_all_ages_in_the_same_clothes_share_one_opengl_context(clothes, contexts):
    """By default, infants below six months wear other clothes than older ones."""
    senses, body = {"vision": {"width_px": 8, "height_px": 8}}, {"looks": {"clothes": clothes}}
    env = mimoc.make_vec([spec(age_months=age, senses=senses, body=body) for age in (3, 9, 20)])
    env.reset(seed=0)
    assert len(env._renderers) == contexts
    env.close()
    assert len(env._renderers) == 0
