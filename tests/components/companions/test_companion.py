"""Companions act before each physics step and see the state after it, in one infant as in many, and never by chance."""

import copy
import pickle
from contextlib import closing
from typing import Any

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import KindError, MimocError
from mimoc.runtime.companion import Companions
from mimoc.runtime.noise import NoiseStreams
from mimoc.runtime.sense import Vector
from mimoc.runtime.sound import Sound, step_of


class Gusts(mimoc.Companion):
    """Pushes the infant with random forces, and keeps when it was called."""

    def bind(self, model, bundle, generator):
        self.root, self.generator = model.body(bundle.manifest.root_body).id, generator
        self.timestep_s, self.calls, self.forces = model.opt.timestep, [], []

    def reset(self, data):
        self.calls, self.forces = [("reset", 0)], []

    def before_step(self, data):
        self.forces.append(self.generator.normal())
        data.xfrc_applied[self.root, 0] = self.forces[-1]
        self.calls.append(("before", step_of(data.time, self.timestep_s)))

    def after_step(self, data):
        self.calls.append(("after", step_of(data.time, self.timestep_s)))

    def sounds(self, data):
        return [Sound(0, 100.0, 300.0, 60.0, "voice", "gusts", self.root, (0.0, 0.0, 0.0))]

    @property
    def state(self) -> dict[str, Any]:
        return {"calls": self.calls, "forces": self.forces}

    @state.setter
    def state(self, state):
        self.calls, self.forces = state["calls"], state["forces"]


@pytest.fixture(scope="module")
def spec() -> mimoc.InfantSpec:
    senses = {"proprioception": {}, "vestibular": {}}
    return mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 6, "senses": senses})


@pytest.fixture
def env(spec):
    with closing(mimoc.make(spec, companions={"gusts": Gusts()})) as env:
        env.reset(seed=1)
        yield env.unwrapped


def moved(env: mimoc.InfantEnv, steps: int, seed: int = 0) -> np.ndarray:
    """Return the joints after some random actions."""
    generator = np.random.default_rng(seed)
    for _ in range(steps):
        env.step(generator.uniform(-1, 1, env.action_space.shape).astype(np.float32))
    return env.data.qpos.copy()


def test_each_physics_step_has_a_call_before_and_one_after_it(env):
    moved(env, 3)
    pairs = [(("before", step), ("after", step + 1)) for step in range(6)]
    assert env.companions["gusts"].state["calls"] == [("reset", 0), *(call for pair in pairs for call in pair)]


def test_without_companions_a_control_step_is_not_cut_and_a_state_is_as_before(spec, env):
    with closing(mimoc.make(spec).unwrapped) as alone:
        alone.reset(seed=1)
        assert [len(one.schedule.begin(np.zeros(one.model.nu))) for one in (alone, env)] == [1, 2]
        assert "companions" not in alone.get_state()
        assert not alone.companions


def test_the_seed_determines_what_companions_draw(env):
    first = moved(env, 5)
    env.reset(seed=2)
    assert (moved(env, 5) != first).any()
    env.reset(seed=1)
    assert (moved(env, 5) == first).all()


def test_what_companions_draw_does_not_change_what_the_environment_draws(spec, env):
    moved(env, 5)
    with closing(mimoc.make(spec).unwrapped) as alone:
        alone.reset(seed=1)
        assert alone.np_random.random() == env.np_random.random()


@pytest.mark.parametrize("clone", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_copies_go_on_alike(env, clone):
    moved(env, 2)
    with closing(clone(env)) as twin:
        assert (moved(env, 4, seed=3) == moved(twin, 4, seed=3)).all()
        assert env.companions["gusts"].state == twin.companions["gusts"].state


def test_a_state_includes_companions(env):
    moved(env, 2)
    state = env.get_state()
    first, calls = moved(env, 4, seed=3), copy.deepcopy(env.companions["gusts"].state)
    env.set_state(state)
    assert (moved(env, 4, seed=3) == first).all()
    assert env.companions["gusts"].state == calls
    with pytest.raises(ValueError, match="cannot be restored"):
        env.set_state({**state, "companions": {}})


def test_companions_go_on_when_the_infant_grows(env):
    moved(env, 2)
    before = copy.deepcopy(env.companions["gusts"].state)
    env.grow(to=7)
    assert env.companions["gusts"].state == before
    assert env.companions["gusts"].root == env.model.body(env.manifest.root_body).id


def test_in_a_batch_companions_act_as_in_single_environments(spec):
    def objects() -> dict[str, Any]:
        return {"companions": {"gusts": Gusts()}}

    batch = mimoc.make_vec(spec, num_envs=3, threads=2, **objects())
    singles = [mimoc.make(spec, **objects()) for _ in range(3)]
    observed = batch.reset(seed=4)[0]
    expected = [env.reset(seed=4 + index)[0] for index, env in enumerate(singles)]
    for _ in range(5):
        actions = np.stack([env.action_space.sample() for env in singles])
        observed = batch.step(actions)[0]
        expected = [env.step(action)[0] for env, action in zip(singles, actions, strict=True)]
    for name, values in observed.items():
        assert (values == np.stack([item[name] for item in expected])).all()
    calls = [infant.companions["gusts"].state for infant in batch.infants]
    assert calls == [env.unwrapped.companions["gusts"].state for env in singles]
    for opened in (batch, *singles):
        opened.close()


def test_a_sense_can_listen_to_them(spec):
    class Loudness(Vector):
        def __init__(self):
            super().__init__("loudness", ("level [dB]",), 0.0, 120.0)

    class Listening(Loudness):
        sources: Any = None

        def __call__(self, data):
            return np.array([max(sound.level_db for sound in self.sources.sounds(data))])

        def listen_to(self, sources):
            self.sources = sources

    gusts = Gusts()
    gusts.root = 0
    sense = Listening()
    sense.listen_to(Companions({"gusts": gusts}, NoiseStreams(0)))
    assert sense(None) == [60.0]


def test_an_object_that_is_no_companion_is_refused(spec):
    with pytest.raises(KindError, match="companion 'wind' is the class Gusts"):
        mimoc.make(spec, companions={"wind": Gusts})
    with pytest.raises(KindError, match="companion 'wind' is 3"):
        mimoc.make(spec, companions={"wind": 3})


@pytest.mark.extras
def test_devices_refuse_companions(env):
    from mimoc.runtime.device import signals

    with pytest.raises(MimocError, match="companion 'gusts' acts on the CPU only"):
        signals.check_infant(env)
