import copy
import pickle
import subprocess
import sys
from functools import partial

import gymnasium
import numpy as np
import pytest
from support.full import full_but

import mimoc
from mimoc.base.errors import BundleError, MimocError, UnknownNameError

SCENE = {"kind": "room", "toys": {"count": [3, 3]}, "seed": 4}
YAML = """\
mimoc: 1
name: infant
age_months: 9
senses: {proprioception: {}}
scene: {kind: room, seed: 4, toys: {count: [3, 3]}}
"""


def spec(seed: int = 4) -> mimoc.InfantSpec:
    data = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": {"proprioception": {}}}
    return mimoc.InfantSpec.model_validate({**data, "scene": {**SCENE, "seed": seed}})


@pytest.fixture
def env():
    with mimoc.make(spec()) as made:
        yield made


def told(env) -> tuple:
    return env.unwrapped.manifest.seed, [toy.body for toy in env.unwrapped.manifest.toys]


def test_a_spec_its_file_and_its_bundle_make_the_same_environment(tmp_path):
    (tmp_path / "spec.yaml").write_text(YAML)
    folder = mimoc.write_bundle(mimoc.build(spec()), tmp_path / "out")
    made = [mimoc.make(each) for each in (spec(), tmp_path / "spec.yaml", mimoc.build(spec()), folder, str(folder))]
    for env in made:
        env.reset(seed=0)
        assert told(env) == told(made[0])
        assert np.array_equal(env.unwrapped.data.qpos, made[0].unwrapped.data.qpos)


def test_options_go_to_the_environment():
    assert mimoc.make(spec(), render_mode="rgb_array", width=64).unwrapped.render_mode == "rgb_array"


def test_a_reset_to_a_scene_is_what_a_build_with_its_seed_is(env):
    env.reset(options={"scene_seed": 9})
    built = mimoc.build(spec(9))
    assert env.unwrapped.manifest == built.manifest
    assert env.unwrapped.bundle.files == built.files
    other = mimoc.make(built)
    env.reset(seed=1)
    other.reset(seed=1)
    for command in np.random.default_rng(0).uniform(-1, 1, (5, *env.action_space.shape)).astype(np.float32):
        felt, expected = env.step(command)[0], other.step(command)[0]
        assert felt.keys() == expected.keys()
        assert all(np.array_equal(felt[name], expected[name]) for name in felt)
    assert np.array_equal(env.unwrapped.model.key_qpos, other.unwrapped.model.key_qpos)


def test_another_scene_has_other_toys_the_same_infant_and_the_same_spaces(env):
    before = env.unwrapped.manifest
    spaces = env.observation_space, env.action_space
    env.reset(options={"scene_seed": 5})
    after = env.unwrapped.manifest
    assert (before.seed, after.seed) == (4, 5)
    assert before.toys != after.toys
    assert before.child == after.child
    assert (env.observation_space, env.action_space) == spaces


def test_a_scene_stays_until_another_is_asked_for(env):
    env.reset(options={"scene_seed": 5})
    here = told(env)
    env.reset()
    assert told(env) == here
    env.reset(options={"scene_seed": 4})
    assert told(env)[0] == 4


def test_a_scene_and_a_pose_can_be_asked_for_at_once(env):
    env.reset(options={"scene_seed": 5, "pose": "standing"})
    unwrapped = env.unwrapped
    assert np.array_equal(unwrapped.data.qpos, unwrapped.model.key("standing").qpos)


def test_a_bundle_has_one_scene_only():
    with mimoc.make(mimoc.build(spec())) as env, pytest.raises(UnknownNameError, match="scene_seed"):
        env.reset(options={"scene_seed": 5})


@pytest.mark.parametrize("seed", [-1, 1.5, "7", None, True])
def test_a_seed_that_is_no_whole_number_is_refused_and_changes_nothing(env, seed):
    env.reset()
    before = told(env)
    with pytest.raises(ValueError, match="non-negative integer"):
        env.reset(options={"scene_seed": seed})
    assert told(env) == before


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))], ids=["copy", "pickle"])
def test_copies_can_be_given_other_scenes_too(env, copied):
    env.reset(options={"scene_seed": 5})
    twin = copied(env.unwrapped)
    assert twin.manifest.seed == 5
    twin.reset(options={"scene_seed": 6})
    assert (twin.manifest.seed, env.unwrapped.manifest.seed) == (6, 5)
    env.reset(options={"scene_seed": 6})
    assert twin.manifest == env.unwrapped.manifest


@pytest.mark.parametrize("scenes", full_but([6], [20]))
def test_a_thousandth_scene_costs_no_more_than_the_second(env, scenes):
    for seed in range(scenes):
        env.reset(options={"scene_seed": seed})
    kept = len(pickle.dumps(env.unwrapped.bundle))
    for seed in range(scenes):
        env.reset(options={"scene_seed": seed})
    assert len(pickle.dumps(env.unwrapped.bundle)) == kept


def test_environments_in_other_processes_have_scenes_of_their_own():
    envs = gymnasium.vector.AsyncVectorEnv([lambda: mimoc.make(spec())] * 2)
    try:
        envs.reset(options={"scene_seed": 6})
        assert [manifest.seed for manifest in envs.get_attr("manifest")] == [6, 6]
    finally:
        envs.close()


def test_a_bundle_is_run_without_the_compiler(tmp_path):
    folder = mimoc.write_bundle(mimoc.build(spec()), tmp_path / "out")
    code = (
        "import sys, mimoc; env = mimoc.make(sys.argv[1]); env.reset(); env.step(env.action_space.sample());"
        "print([name for name in sys.modules if name.startswith(('mimoc.compiler', 'mimoc.body.tree', 'mimoc.fits',"
        " 'jinja2')) or name.startswith('mimoc.') and name.endswith('.build')])"
    )
    done = subprocess.run([sys.executable, "-c", code, str(folder)], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_the_command_line_builds_another_scene(invoke, tmp_path, monkeypatch):
    (tmp_path / "spec.yaml").write_text(YAML)
    monkeypatch.chdir(tmp_path)
    for arguments in (["-o", "own"], ["-o", "seven", "--seed", "7"]):
        assert invoke("build", "spec.yaml", *arguments).code == 0
    own, seven = (mimoc.read_bundle(tmp_path / name) for name in ("own", "seven"))
    assert (own.manifest.seed, seven.manifest.seed) == (4, 7)
    assert seven.files["scene.xml"] == mimoc.build(spec(7)).files["scene.xml"] != own.files["scene.xml"]
    assert b"seed: 7" in seven.files["resolved.yaml"]


def test_an_infant_that_sees_takes_its_eyes_along():
    """What it sees in another scene is what it would see there anyway; and so when it comes back."""
    senses = {"vision": {"width_px": 24, "height_px": 24, "foveation": 3}, "touch": {"density": 0.2}}
    spec = {
        "mimoc": 1,
        "name": "infant",
        "age_months": 9,
        "senses": senses,
        "scene": {"kind": "room", "pose": "sitting"},
    }
    infant = mimoc.InfantSpec.model_validate(spec)
    moving, other = mimoc.make(infant), mimoc.make(infant)
    first, _ = moving.reset(seed=0)
    seen, _ = moving.reset(options={"scene_seed": 5})
    expected, _ = other.reset(options={"scene_seed": 5})
    back, _ = moving.reset(options={"scene_seed": 0})
    assert all(np.array_equal(seen[key], expected[key]) for key in expected)
    assert all(np.array_equal(back[key], first[key]) for key in first)
    assert not np.array_equal(seen["eye_left"], first["eye_left"])
    for env in (moving, other):
        env.close()


def test_a_state_brings_its_scene_along(env):
    env.reset(options={"scene_seed": 9})
    state = env.unwrapped.get_state()
    expected = env.step(env.action_space.high)[0]
    env.reset(options={"scene_seed": 10})
    env.unwrapped.set_state(state)
    assert env.unwrapped.manifest.seed == 9
    again = env.step(env.action_space.high)[0]
    assert all(np.array_equal(again[key], expected[key]) for key in expected)


def test_a_bundle_refuses_the_state_of_another_scene():
    one, other = (mimoc.make(mimoc.build(spec(seed))) for seed in (1, 2))
    with pytest.raises(ValueError, match="state has scene_seed 1, but this environment has 2"):
        other.unwrapped.set_state(one.unwrapped.get_state())


class Regard(mimoc.Task):
    def judge(self, data, action, effort):
        return 0.0


def zeros(data):
    return np.zeros(3)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"task": Regard}, "task is the class Regard; pass an object of it: Regard()"),
        ({"task": zeros}, "which has no method 'judge'; pass an object such as a mimoc.Task"),
        ({"task": "reach"}, "task is 'reach', which has no method 'judge'"),
        ({"senses": {"hum": zeros}}, "sense 'hum' has no attribute 'space', the gymnasium.spaces.Box of"),
        ({"senses": {"hum": Regard}}, "sense 'hum' is the class Regard; pass an object of it: Regard()"),
        ({"senses": {"hum": 3}}, "sense 'hum' is 3, which has no method '__call__'"),
        ({"senses": [zeros]}, "pass a dictionary of objects by the name of their observation"),
        ({"age_months": 9}, "'age_months' is not a keyword of an environment (what the infant is like is said in"),
        ({"render_size": 9}, "'render_size' is not a keyword of an environment"),
    ],
    ids=["class", "function", "string", "no space", "class as sense", "number", "list", "key of a spec", "no key"],
)
@pytest.mark.parametrize(
    "make",
    [
        mimoc.make,
        lambda bundle, **options: mimoc.make_vec(bundle, 2, **options),
        lambda bundle, **options: gymnasium.make("mimoc/Infant-v0", bundle=bundle, **options),
    ],
    ids=["one", "many", "gymnasium"],
)
def test_what_is_no_object_or_keyword_is_one_clear_error(make, options, message, bundle_at):
    with pytest.raises(MimocError) as caught:
        make(bundle_at(9), **options)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("make", [gymnasium.make, partial(gymnasium.make_vec, num_envs=2)])
@pytest.mark.parametrize("options", [{}, {"age_months": 9}])
def test_an_environment_of_no_infant_is_one_clear_error(make, options):
    with pytest.raises(MimocError, match="mimoc/Infant-v0 needs an infant: give it as bundle=, a bundle or a spec"):
        make("mimoc/Infant-v0", **options)


@pytest.mark.parametrize("function", [mimoc.make, mimoc.make_vec, mimoc.read_bundle])
@pytest.mark.parametrize("file", ["scene.xml", "manifest.json"])
def test_a_file_of_a_bundle_is_no_bundle(function, file, bundle_at, tmp_path):
    folder = mimoc.write_bundle(bundle_at(9), tmp_path / "infant")
    with pytest.raises(BundleError, match=f"{file}: there is no such folder, as this is a file; name the folder of a"):
        function(folder / file)


@pytest.mark.parametrize(
    ("make", "limit"),
    [
        (lambda bundle: gymnasium.make("mimoc/Reach-v0"), 1000),
        (lambda bundle: gymnasium.make("mimoc/Reach-v0", steps=33), 33),
        (lambda bundle: gymnasium.make("mimoc/Reach-v0", max_episode_steps=7), 7),
        (lambda bundle: mimoc.make(bundle), None),
        (lambda bundle: mimoc.make(bundle, max_episode_steps=9), 9),
        (lambda bundle: mimoc.make(bundle, task=Regard(steps=44)), 44),
        (lambda bundle: mimoc.make(bundle, task=Regard()), None),
        (lambda bundle: gymnasium.make_vec("mimoc/Reach-v0", 2, max_episode_steps=5), 5),
        (lambda bundle: gymnasium.make_vec("mimoc/Reach-v0", 2), 1000),
        (lambda bundle: pickle.loads(pickle.dumps(mimoc.make(bundle, task=Regard(steps=44)))), 44),
    ],
)
def test_gymnasium_is_told_after_how_many_steps_episodes_are_truncated(bundle, make, limit):
    env = make(bundle)
    assert env.spec.max_episode_steps == limit
    env.close()
