"""Copies and pickles of vector environments, and what their models leave out."""

import copy
import os
import pickle
import subprocess
import sys
from typing import Any

import cloudpickle
import mujoco
import numpy as np
import pytest
from gymnasium.spaces import Box
from support import store
from support.forks import status_of_fork
from support.same import same

import mimoc
from mimoc.runtime.batch import ThreadedPhysics, usable_threads

SENSES = {"proprioception": {}, "vestibular": {}, "touch": {"density": 0.3}}
SPEC = mimoc.InfantSpec.model_validate(
    {"mimoc": 1, "name": "a", "age_months": 9, "senses": SENSES, "delays": {"preset": "physiological"}}
)
IN_A_PROCESS = """
import pickle, sys
import numpy as np
envs = pickle.load(sys.stdin.buffer)
rng = np.random.default_rng(1)
actions = [rng.uniform(-1, 1, envs.action_space.shape).astype(np.float32) for _ in range(8)]
pickle.dump([envs.step(action)[:4] for action in actions], sys.stdout.buffer)
"""


def steps(envs: Any, count: int, seed: int) -> list[Any]:
    """Return what some random steps give."""
    rng = np.random.default_rng(seed)
    return [envs.step(rng.uniform(-1, 1, envs.action_space.shape).astype(np.float32))[:4] for _ in range(count)]


@pytest.fixture(scope="module")
def bundle() -> mimoc.Bundle:
    return store.built(SPEC)


def test_copies_go_on_as_the_original_does_across_the_ends_of_episodes(bundle):
    envs = mimoc.make_vec(bundle, 3, threads=1, max_episode_steps=6)
    envs.reset(seed=0)
    steps(envs, 3, seed=0)
    others = copy.deepcopy(envs), pickle.loads(pickle.dumps(envs)), cloudpickle.loads(cloudpickle.dumps(envs))
    expected = steps(envs, 10, seed=1)
    for other in others:
        assert same(steps(other, 10, seed=1), expected)
        other.close()
    envs.close()


def test_infants_of_several_ages_are_copied_with_what_they_are_made_of():
    envs = mimoc.make_vec([SPEC, SPEC.with_(age_months=6)], 2, threads=1)
    other = pickle.loads(pickle.dumps(envs))
    for each in (envs, other):
        each.reset(seed=5)
        each.grow(to=[10, None])
    assert other.get_attr("age_months") == (10.0, 6.0)
    assert same(steps(other, 3, seed=0), steps(envs, 3, seed=0))
    envs.close()
    other.close()


def test_a_pickle_goes_on_in_another_process(bundle):
    envs = mimoc.make_vec(bundle, 2, threads=1)
    envs.reset(seed=0)
    steps(envs, 2, seed=0)
    done = subprocess.run(
        [sys.executable, "-c", IN_A_PROCESS], input=pickle.dumps(envs), capture_output=True, check=True, timeout=120
    )
    assert same(pickle.loads(done.stdout), steps(envs, 8, seed=1))
    envs.close()


def test_a_copy_of_a_closed_one_is_open(bundle):
    envs = mimoc.make_vec(bundle, 2, threads=1)
    envs.close()
    other = copy.deepcopy(envs)
    assert not other.closed
    other.reset(seed=0)
    other.close()


def test_models_that_nothing_draws_have_no_textures_and_simulate_the_same(bundle):
    envs, alone = mimoc.make_vec(bundle, 2, threads=1), mimoc.InfantEnv(bundle)
    plain, full = envs.infants[1].model, alone.model
    assert plain.ntexdata < 1000 < full.ntexdata
    assert plain.nbuffer < full.nbuffer / 5
    for name in dir(full):
        values = getattr(full, name)
        if isinstance(values, np.ndarray) and not name.startswith(("tex_", "_")):
            np.testing.assert_array_equal(getattr(plain, name), values, name)
    envs.reset(seed=[7, 7])
    alone.reset(seed=7)
    action = envs.action_space.sample()
    observed, expected = envs.step(action)[0], alone.step(action[1])[0]
    assert all(np.array_equal(observed[name][1], expected[name]) for name in expected)
    alone.set_state(envs.infants[1].get_state())
    envs.close()
    alone.close()


class Clock:
    """A sense that might draw."""

    space = Box(0.0, 1.0, (1,), np.float32)

    def __call__(self, data: Any) -> Any:
        return np.array([data.time])


@pytest.mark.parametrize(
    "options", [{"render_mode": "rgb_array"}, {"senses": {"clock": Clock()}}], ids=["env", "sense"]
)
def test_models_that_something_may_draw_keep_their_textures(bundle, options):
    envs = mimoc.make_vec(bundle, 2, threads=1, **options)
    assert envs.infants[1].model.ntexdata > 100_000
    envs.close()


def test_a_plain_texture_has_the_mean_colour(bundle):
    plain, full = mimoc.make_vec(bundle, 1).infants[0].model, mimoc.InfantEnv(bundle).model
    for index in range(full.ntex):
        start, size = full.tex_adr[index], full.tex_height[index] * full.tex_width[index] * full.tex_nchannel[index]
        mean = full.tex_data[start : start + size].reshape(-1, full.tex_nchannel[index]).mean(axis=0)
        at = plain.tex_adr[index]
        assert plain.tex_data[at : at + 3] == pytest.approx(mean[:3], abs=1.0)


PENDULUM = """
<mujoco>
  <worldbody>
    <body>
      <joint name="hinge" type="hinge" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0 0 -{length}" size="0.02"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def pendulums() -> list[tuple[mujoco.MjModel, mujoco.MjData]]:
    models = [mujoco.MjModel.from_xml_string(PENDULUM.format(length=0.1 * (i + 1))) for i in range(9)]
    datas = [mujoco.MjData(model) for model in models]
    for data in datas:
        data.qpos[0] = 1.0
    return list(zip(models, datas, strict=True))


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_each_group_is_done_when_it_is_yielded(pendulums, threads):
    physics = ThreadedPhysics(*zip(*pendulums, strict=True), threads)
    groups = [[3, 1], [0, 2, 4], [8]]
    alone = [mujoco.MjData(model) for model, _ in pendulums]
    for (model, _), data in zip(pendulums, alone, strict=True):
        data.qpos[0] = 1.0
        mujoco.mj_step(model, data, 7)
    seen = []
    for group in physics.step(groups, 7):
        assert np.array_equal(physics.array("qpos", group), [alone[index].qpos for index in group])
        seen.append(list(group))
    assert seen == groups
    assert [index for index, data in enumerate(physics.datas) if data.time == 0] == [5, 6, 7]
    physics.close()


def test_fields_come_in_the_order_that_is_asked_for(pendulums):
    physics = ThreadedPhysics(*zip(*pendulums, strict=True), 1)
    for index, data in enumerate(physics.datas):
        data.qpos[0] = index
    order = [2, 0, 1, 8, 7, 6, 5, 4, 3]
    assert physics.array("qpos", order).ravel().tolist() == order


def test_a_model_can_be_put_in_place_of_another(pendulums):
    physics = ThreadedPhysics(*zip(*pendulums, strict=True), 1)
    physics.array("qvel", [0])
    model, _ = pendulums[8]
    data = mujoco.MjData(model)
    data.qpos[0] = 1.0
    physics.replace(0, model, data)
    for _ in physics.step([[0, 8]], 3):
        pass
    assert physics.array("qvel", [0]) == physics.array("qvel", [8])


def test_as_many_threads_are_used_as_may_be(pendulums, monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: {0, 3, 5}, raising=False)
    assert usable_threads() == 3
    physics = ThreadedPhysics(*zip(*pendulums, strict=True))
    assert physics.threads == 3
    physics.close()


def test_nobody_steps_an_infant_behind_the_back_of_a_caller_that_stops(pendulums):
    physics = ThreadedPhysics(*zip(*pendulums, strict=True), 3)
    stepped = physics.step([[0, 1, 2], [3, 4, 5], [6, 7, 8]], 50)
    assert next(stepped) == [0, 1, 2]
    stepped.close()
    times = [data.time for data in physics.datas]
    physics.close()
    assert [data.time for data in physics.datas] == times


PATIENCE_S = 60
SEE = """
import sys
import gymnasium, numpy as np
import mimoc

if __name__ == "__main__":
    here = mimoc.InfantEnv(sys.argv[1])
    alone = here.reset(seed=0)[0]["eye_left"]
    envs = gymnasium.make_vec("mimoc/Infant-v0", 2, "async", bundle=sys.argv[1])
    seen = envs.reset(seed=0)[0]["eye_left"]
    envs.step(envs.action_space.sample())
    envs.close()
    print(all(np.array_equal(picture, alone) for picture in seen), alone.std() > 5)
    print(np.array_equal(here.reset(seed=0)[0]["eye_left"], alone))
    here.close()
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> str:
    vision = {"width_px": 32, "height_px": 32}
    spec = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": {"vision": vision}}
    compiled = mimoc.build(mimoc.InfantSpec.model_validate({**spec, "scene": {"pose": "sitting"}}))
    return str(mimoc.write_bundle(compiled, tmp_path_factory.mktemp("bundles") / "infant"))


@pytest.mark.full
def test_processes_that_gymnasium_forks_after_it_has_drawn_draw_the_same(folder, tmp_path):
    """`AsyncVectorEnv` opens an environment, closes it, and then forks: without a remedy, Mesa hangs."""
    (tmp_path / "see.py").write_text(SEE)
    environment = {name: value for name, value in os.environ.items() if name != "LP_NUM_THREADS"}
    command = [sys.executable, "-W", "ignore", str(tmp_path / "see.py"), folder]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    assert (done.returncode, done.stdout) == (0, "True True\nTrue\n"), done.stderr


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_many_infants_go_on_in_a_forked_process(bundle):
    """Which has none of the threads that shared the work before."""
    envs = mimoc.make_vec(bundle, 2, threads=2)
    envs.reset(seed=0)
    envs.step(envs.action_space.sample())
    assert status_of_fork(lambda: envs.step(envs.action_space.sample())) == 0
    envs.close()
