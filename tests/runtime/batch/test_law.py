"""Infant i of a vector environment gives, step for step and bit for bit, what it gives alone."""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from support import store
from support.full import full_but
from support.same import assert_same
from support.worlds import ANNA, BEN

import mimoc
from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.runtime.batch_env import BatchEnv
from mimoc.runtime.opening import open_infant
from mimoc.schema.infant import InfantSpec

CONFIGS = sorted((Path(mimoc.__file__).parents[1] / "configs").glob("*.yaml"))
NEXT_STEP, SAME_STEP = AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP
LONG = [path for path in CONFIGS if path.stem in ("catch", "five_finger")]
AGES_MONTHS = (0, 3, 6, 9, 12, 18, 24)
NOISY = {
    "motor": 0.1,
    "proprioception_deg": "age",
    "vestibular_thresholds": "age",
    "touch_n": 0.05,
    "delay_jitter_ms": 10,
}


def live_alike(
    sources: list[Any], count: int, steps: int, mode: AutoresetMode = NEXT_STEP, scale: float = 1.0, **options: Any
) -> int:
    """Run infants together and, as Gymnasium does it, one after another; return how many episodes ended."""
    openers = [partial(mimoc.make, sources[index % len(sources)]) for index in range(count)]
    alone = SyncVectorEnv(openers, autoreset_mode=mode, observation_mode="different")
    together = mimoc.make_vec(sources, count, autoreset_mode=mode, **options)
    assert_same(together.reset(seed=5), alone.reset(seed=5), "reset")
    together.action_space.seed(0)
    ended = 0
    for step in range(steps):
        actions = scale * together.action_space.sample()
        ours = together.step(actions)
        assert_same(ours, alone.step(actions), f"step {step}")
        ended += int((ours[2] | ours[3]).sum())
    alone.close()
    together.close()
    return ended


def of_config(path: Path, episode_steps: int) -> mimoc.Bundle:
    spec = mimoc.load_spec(path)
    return store.built(spec.with_(task={"steps": episode_steps}) if spec.task else spec)


def at_ages(ages_months: tuple[float, ...], **keys: Any) -> list[mimoc.Bundle]:
    spec = {"mimoc": 1, "name": "infant", "senses": {"proprioception": {}, "vestibular": {}}, **keys}
    return [store.built({**spec, "age_months": age}) for age in ages_months]


@pytest.mark.parametrize("config", [each for each in CONFIGS if each.stem != "all_senses"], ids=lambda each: each.stem)
def test_an_infant_gives_what_it_gives_alone(config):
    mode = NEXT_STEP if CONFIGS.index(config) % 2 else SAME_STEP
    spec = mimoc.load_spec(config)
    ended = live_alike([of_config(config, 4)], 2, 10, mode)
    assert ended >= 2 * bool(spec.task)


@pytest.mark.full
@pytest.mark.parametrize("mode", [NEXT_STEP, SAME_STEP])
def test_so_does_one_with_eyes(mode):
    senses = {"vision": {"width_px": 16, "height_px": 16}, "touch": {}}
    assert live_alike(at_ages((3, 9), senses=senses, task={"kind": "reach", "steps": 3}), 3, 8, mode) == 6


@pytest.mark.parametrize("config", full_but(LONG, CONFIGS), ids=lambda each: each.stem)
def test_so_it_does_for_300_steps(config):
    mode = SAME_STEP if CONFIGS.index(config) % 2 else NEXT_STEP
    live_alike([of_config(config, 70)], 2, 300, mode)


@pytest.mark.full
@pytest.mark.parametrize("threads", [1, 3])
def test_seven_ages_live_side_by_side_with_delays_noise_and_touch(threads):
    senses = {"proprioception": {}, "vestibular": {"canals": "age"}, "touch": {}}
    infants = at_ages(AGES_MONTHS, senses=senses, delays={"preset": "physiological"}, noise=NOISY)
    live_alike(infants, 9, 12, threads=threads)


def test_so_do_those_whose_senses_mature():
    senses = {"vestibular": {"canals": "age"}, "touch": {"density": 0.3, "channels": ["sa1", "ra", "ct"]}, "pain": {}}
    infants = at_ages((0, 6, 24), senses=senses, delays={"preset": "physiological"}, noise={"touch_n": 0.05})
    live_alike(infants, 4, 12)


@pytest.mark.parametrize("mode", [NEXT_STEP, SAME_STEP])
@pytest.mark.parametrize("kind", ["catch", "reach"])
def test_balls_that_change_their_size_and_locked_joints_stay_those_of_their_infant(kind, mode):
    infants = at_ages((9, 18), task={"kind": kind, "steps": 6})
    assert live_alike(infants, 4, 20, mode) >= 8


def test_scenes_and_strengths_may_differ():
    room = {"kind": "room", "toys": {"count": [2, 2]}}
    scenes = [at_ages((9,), scene={**room, "seed": seed})[0] for seed in (1, 2)]
    strong = at_ages((9,), scene={**room, "seed": 3}, actuation={"strength": {"neck": 0.5}})
    live_alike([*scenes, *strong], 4, 5)


def test_rooms_may_have_different_numbers_of_toys():
    """Their models have states of other sizes, so each room's infants are read by themselves."""
    rooms = [{"kind": "room", "seed": 1, "toys": {"count": [count, count]}} for count in (1, 3)]
    senses = {"proprioception": {}, "vestibular": {}, "touch": {"density": 0.3}}
    assert live_alike([at_ages((9,), scene=room, senses=senses)[0] for room in rooms], 3, 3) == 0


@pytest.mark.parametrize("mode", [NEXT_STEP, SAME_STEP])
def test_an_infant_that_becomes_unstable_ends_its_own_episode_only(mode):
    infants = at_ages((9, 12), task={"kind": "standup"})
    together = mimoc.make_vec(infants, 4, autoreset_mode=mode)
    together.reset(seed=0)
    together.infants[1].data.qvel[:] = 1e12
    actions = np.zeros(together.action_space.shape, np.float32)
    observation, rewards, terminated, truncated, info = together.step(actions)
    assert terminated.tolist() == [False, True, False, False]
    assert not truncated.any()
    assert rewards[1] == 0
    assert all(np.isfinite(readings).all() for readings in observation.values())
    told = info["final_info"] if mode is SAME_STEP else info
    assert told["unstable"].tolist() == terminated.tolist()
    assert not together.step(actions)[2].any()
    together.close()


NOISE = {"motor": 0.1, "delay_jitter_ms": 10}


def bundle(age_months: float = 6, **keys) -> mimoc.Bundle:
    spec = {"mimoc": 1, "name": "x", "age_months": age_months, "senses": {"proprioception": {}, "vestibular": {}}}
    return store.built({**spec, **keys})


@pytest.mark.full
@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_an_infant_that_grows_gives_what_it_gives_alone_in_the_wrapper(mode):
    """Mid-episode and across episodes, with physiological delays, which change their length."""
    infant = bundle(delays={"preset": "physiological"}, noise=NOISE, task={"kind": "reach", "steps": 5})
    schedule = mimoc.growth_schedule("grown", (6, 9), 12, stage_months=1.0)
    alone = SyncVectorEnv(
        [lambda: mimoc.GrowthWrapper(mimoc.make(infant), schedule)] * 2,
        autoreset_mode=mode,
        observation_mode="different",
    )
    together = BatchEnv([partial(open_infant, infant)] * 2, autoreset_mode=mode, schedule=schedule)
    assert_same(together.reset(seed=3), alone.reset(seed=3), "reset")
    together.action_space.seed(0)
    ages = set()
    for step in range(15):
        actions = together.action_space.sample()
        ours = together.step(actions)
        assert_same(ours, alone.step(actions), f"step {step}")
        ages |= set(ours[-1]["age_months"].tolist())
    assert ages == {6.0, 7.0, 8.0, 9.0}
    together.close()
    alone.close()


def test_infants_grow_to_one_age_or_to_one_each_in_the_midst_of_an_episode():
    many, alone = mimoc.make_vec([bundle(6), bundle(9)], 3), [mimoc.make(bundle(age)) for age in (6, 9, 6)]
    many.reset(seed=1)
    for seed, env in enumerate(alone, start=1):
        env.reset(seed=seed)
    many.action_space.seed(0)
    for ages in ([7, None, 24], [12] * 3):
        observation = many.grow(12 if ages == [12] * 3 else ages)
        actions = many.action_space.sample()
        stepped = many.step(actions)
        for index, (env, age) in enumerate(zip(alone, ages, strict=True)):
            own = env.unwrapped.grow(to=age) if age is not None else None
            if own is not None:
                assert all(np.array_equal(observation[name][index], own[name]) for name in own)
            own = env.step(actions[index])[0]
            assert all(np.array_equal(stepped[0][name][index], own[name]) for name in own)
        many_ages = [12.0] * 3 if ages == [12] * 3 else [7.0, 9.0, 24.0]
        assert stepped[-1]["age_months"].tolist() == many_ages
    many.close()


@pytest.mark.parametrize("ages", [25, [6, 7], [6, 7, "old"]])
def test_wrong_ages_are_refused(ages):
    many = mimoc.make_vec(bundle(6), 3)
    many.reset(seed=0)
    with pytest.raises(ValueError, match=r"24 months|one value"):
        many.grow(ages)
    many.close()


LATE = {"delays": {"sensory_ms": 30, "motor_ms": 20}, "noise": {"motor": 0.1, "delay_jitter_ms": 10}}
KIM, LEE = (InfantSpec.model_validate({**ANNA, **LATE, "name": name}) for name in ("kim", "lee"))
PAIR = {"kim": KIM, "lee": LEE}


class Still(mimoc.Task):
    """Pays for lying still, for some steps."""

    def judge(self, data, action, effort):
        return mimoc.Judgement({"effort": -effort()})


@pytest.mark.parametrize("threads", [1, 2])
def test_rows_are_what_infants_are_in_their_world_alone(threads):
    many = mimoc.make_vec(PAIR, num_envs=4, threads=threads)
    alone = [mimoc.make_parallel(PAIR) for _ in range(2)]
    observed, _ = many.reset(seed=5)
    theirs = [world.reset(seed=5 + 2 * number)[0] for number, world in enumerate(alone)]
    generator = np.random.default_rng(0)
    for step in range(8):
        for number, observations in enumerate(theirs):
            for row, observation in enumerate(observations.values(), 2 * number):
                assert all(np.array_equal(observed[name][row], observation[name]) for name in observation), step
        if step == 4:
            observed = many.grow([None, 3.5, 8, 4])
            theirs = [alone[0].grow({"lee": 3.5}), alone[1].grow({"kim": 8, "lee": 4})]
        actions = generator.uniform(-0.3, 0.3, many.action_space.shape).astype(np.float32)
        observed, rewards, *_ = many.step(actions)
        by_world = actions.reshape(2, 2, -1)
        stepped = [world.step(dict(zip(PAIR, pair, strict=True))) for world, pair in zip(alone, by_world, strict=True)]
        theirs = [step[0] for step in stepped]
        assert rewards.tolist() == [reward for step in stepped for reward in step[1].values()]


@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_episodes_of_a_world_end_together(mode):
    tasks = {"kim": Still(steps=2), "lee": Still(steps=9)}
    envs = mimoc.make_vec(PAIR, num_envs=2, tasks=tasks, autoreset_mode=mode)
    envs.reset(seed=0)
    ends = []
    for _ in range(4):
        _, _, terminated, truncated, infos = envs.step(np.zeros(envs.action_space.shape, np.float32))
        ends.append(truncated.tolist())
        assert not terminated.any()
        assert ("final_obs" in infos) == (mode == "SameStep" and truncated.any())
    pauses = [] if mode == "SameStep" else [[False, False]]
    assert ends == [[False, False], [True, True], *pauses, [False, False], [True, True]][:4]


def test_options_are_of_rows_and_scenes_of_worlds():
    envs = mimoc.make_vec(PAIR, num_envs=4)
    envs.reset(seed=0, options={"age_months": [None, 4, 10, None], "scene_seed": 3})
    assert envs.get_attr("age_months") == (9.0, 4.0, 10.0, 9.0)
    assert [world.bundle.manifest.seed for world in envs.simulations] == [3, 3]
    envs.reset(options={"reset_mask": np.array([True, False, False, False])})
    assert envs.get_attr("steps") == (0, 0, 0, 0)


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"num_envs": 3}, MimocError, "infants of whole worlds of 2; give .* num_envs=4"),
        ({"device": "cuda"}, MimocError, "infants that share a world are simulated on the CPU; leave out device"),
        ({"task": Still()}, UnknownNameError, "'task' is not a keyword of a vector environment of worlds; .*'tasks'"),
    ],
)
def test_what_a_batch_of_worlds_cannot_be_is_said_in_one_line(options, kind, message):
    with pytest.raises(kind, match=message):
        mimoc.make_vec(PAIR, **options)


def test_single_infants_and_worlds_do_not_mix():
    with pytest.raises(MimocError, match="of single infants or of worlds, not of both"):
        mimoc.make_vec([PAIR, InfantSpec.model_validate(BEN)])
