"""A batch of worlds: row i is, to the bit, its infant in its world alone, and a world begins and ends as a whole."""

import numpy as np
import pytest
from support.worlds import ANNA, BEN

import mimoc
from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.schema.infant import InfantSpec

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
