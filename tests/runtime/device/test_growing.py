"""Infants on MuJoCo Warp grow as on the CPU, and live in scenes of their own."""

from contextlib import closing

import numpy as np
import pytest
from support.devices import CLOSE, DEVICE, FEELING, SITTING, assert_close, infant, random_actions, spec
from support.scenes_of_objects import spec_with

import mimoc
from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.runtime.device.bodies import KEYFRAMES, NOT_COMPARED, WorldsError
from mimoc.runtime.device.vector_env import DeviceEnv
from mimoc.runtime.env import InfantEnv

ROOM = {"kind": "room", "toys": {"count": [0, 0]}}


def sitting(age_months: float) -> mimoc.Bundle:
    """Return an infant that sits, in the clothes that it wears at all ages."""
    body, delays = {"looks": {"clothes": "bodysuit"}}, {"preset": "physiological"}
    return infant(age_months, senses=FEELING, scene=SITTING, body=body, delays=delays)


def assert_same_steps(ours, theirs, count: int, others: float = 30 * CLOSE):
    generator = np.random.default_rng(1)
    for _ in range(count):
        action = random_actions(theirs, generator)
        (seen, reward, *_), (expected, wanted, *_) = ours.step(action), theirs.step(action)
        assert_close(seen, expected, theirs.infants[0], others=others)
        assert reward == pytest.approx(wanted, rel=1e-3, abs=1e-3)
    places = [infant.data.qpos for infant in theirs.infants]
    assert np.abs(ours.worlds.data.qpos.numpy() - places).max() < CLOSE


def test_infants_grow_in_the_midst_of_an_episode_as_on_the_cpu(pair):
    """Older, younger and not at all; what is on its way arrives after the delays of the new age, in order."""
    ours, theirs = pair([sitting(1), sitting(20)], 3, touch="points")
    ours.reset(seed=0), theirs.reset(seed=0)
    assert_same_steps(ours, theirs, 3)
    for ages in ([6, None, 3], 12, [1, 20, 12]):
        seen, expected = ours.grow(ages), theirs.grow(ages)
        assert_close(seen, expected, theirs.infants[0], others=100 * CLOSE)
        assert_same_steps(ours, theirs, 3, others=100 * CLOSE)
    info = ours.step(np.zeros(ours.action_space.shape, np.float32))[-1]
    assert info["age_months"].tolist() == [1, 20, 12]
    assert [infant.age_months for infant in ours.infants] == [1, 20, 12]


def test_grown_infants_have_the_models_of_those_that_were_built_at_that_age(make):
    """Also where all were of one age, so that worlds shared what differs now; later growth keeps places in memory."""
    grown, fresh = make(sitting(1), 2), make([sitting(9), sitting(12)])
    grown.reset(seed=0, options={"age_months": [6, 7]})
    places = {name: getattr(grown.worlds.model, name).ptr for name in ("geom_size", "body_mass", "dof_damping")}
    ours = grown.reset(seed=0, options={"age_months": [9, 12]})[0]
    assert {name: getattr(grown.worlds.model, name).ptr for name in places} == places
    theirs = fresh.reset(seed=0)[0]
    for name in grown.worlds.model.__dataclass_fields__:
        field, same = getattr(grown.worlds.model, name), getattr(fresh.worlds.model, name)
        if hasattr(field, "numpy") and name not in NOT_COMPARED and not name.startswith(KEYFRAMES):
            assert np.array_equal(np.broadcast_to(field.numpy(), same.numpy().shape), same.numpy()), name
    assert np.array_equal(grown.worlds.data.geom_xpos.numpy()[:, 0], fresh.worlds.data.geom_xpos.numpy()[:, 0])
    for _ in range(2):
        assert all(ours[name] == pytest.approx(theirs[name], abs=CLOSE) for name in theirs)
        ours, theirs = (env.step(np.ones(env.action_space.shape, np.float32))[0] for env in (grown, fresh))


def test_what_lies_around_what_is_held_and_the_task_stay_when_infants_grow(pair):
    """The size of the ball, a held hip that moves with the lift, a locked neck, and arousal.

    Where parts just touch after they were parted, forces differ in the third digit, as contacts are 0.1 mm deep then.
    """
    held = {"scene": {"held": ["hip"], "pose": "sitting"}, "actuation": {"locked": ["neck"]}}
    ours, theirs = pair(infant(12, task={"kind": "reach"}, **held), 2, starts=3)
    for envs in (ours, theirs):
        envs.reset(seed=0)
        envs.set_arousal([0.3, 1.2])
    assert_same_steps(ours, theirs, 3)
    ours.grow([18, None]), theirs.grow([18, None])
    welds = np.stack([infant.model.eq_data for infant in theirs.infants])
    assert ours.worlds.model.eq_data.numpy() == pytest.approx(welds, abs=1e-5)
    sizes = np.stack([infant.model.geom_size for infant in theirs.infants])
    assert ours.worlds.model.geom_size.numpy() == pytest.approx(sizes, abs=1e-6)
    assert_same_steps(ours, theirs, 4, others=300 * CLOSE)


def test_infants_that_cannot_grow_are_told_and_stay_as_they_are(make):
    """A crib of another age has other bars; infants that were opened by their class have no spec."""
    envs = make(spec(3, scene={"kind": "crib"}), 2)
    envs.reset(seed=0)
    before = envs.get_state()
    for ages, error, text in (
        ([None, 24], WorldsError, r"models differ in the number of geoms \(\d+, \d+\)"),
        (25, ValueError, "24 months"),
        ([4, "old"], ValueError, "24 months"),
        ([4, 5, 6], ValueError, "one value for all, or 2, got 3"),
    ):
        with pytest.raises(error, match=text):
            envs.grow(ages)
        with pytest.raises(error, match=text):
            envs.reset(options={"age_months": ages})
    after = envs.get_state()
    assert [state["age_months"] for state in after] == [3, 3]
    assert all((a["physics"]["qpos"] == b["physics"]["qpos"]).all() for a, b in zip(before, after, strict=True))
    alone = DeviceEnv([InfantEnv(sitting(9))], device=DEVICE.removeprefix("warp:"))
    with pytest.raises(MimocError, match=r"make them by mimoc\.make_vec"):
        alone.grow(10)
    alone.close()


def test_infants_of_one_batch_live_in_rooms_of_different_seeds(pair):
    """Of three rooms with as many things in them; one with more is told."""
    rooms = [spec(9, scene={**ROOM, "seed": seed}) for seed in (0, 3)]
    ours, theirs = pair(rooms)
    ours.reset(seed=0), theirs.reset(seed=0)
    assert_same_steps(ours, theirs, 4)
    seeds = {"scene_seed": [5, None]}
    ours.reset(seed=0, options=seeds), theirs.reset(seed=0, options=seeds)
    assert [infant.manifest.seed for infant in ours.infants] == [5, 3]
    assert_same_steps(ours, theirs, 4)
    with pytest.raises(WorldsError, match=r"the number of geoms \(51, 50\)"):
        ours.reset(options={"scene_seed": 1})
    assert [infant.manifest.seed for infant in ours.infants] == [5, 3]


def test_policies_see_that_infants_have_grown_and_what_their_arousal_is(pair):
    ours, theirs = pair(sitting(1), 2, touch="points")
    for envs in (ours, theirs):
        envs.reset(seed=0)
    policies = [mimoc.policy_vec("general_movements", envs) for envs in (ours, theirs)]
    generators = [[np.random.default_rng(seed) for seed in range(2)] for _ in policies]
    for ages in ([1, 1], [3, 12]):
        seen = [envs.grow(ages) for envs in (ours, theirs)]
        ours.set_arousal(0.4), theirs.set_arousal(0.4)
        actions = [policy(*given) for policy, *given in zip(policies, generators, seen, strict=True)]
        assert actions[0] == pytest.approx(actions[1], abs=1e-4)


SPEC = {
    **spec_with(
        {"name": "ball", "radius_cm": 4, "at": "within reach of right_hand"},
        {"name": "post", "shape": "box", "motion": "fixed", "at": {"x_cm": 60, "y_cm": 0}},
        {"name": "bead", "above": "chest", "height_cm": 25},
        {
            "name": "mobile",
            "kind": "mobile",
            "figures": ["ball", "ball"],
            "above": "head",
            "height_cm": 45,
            "tied_to": "left_foot",
        },
        age_months=3,
    ),
    "actuation": {"model": "torque"},
    "senses": {"proprioception": {}},
}
ELSEWHERE = {"ball": "within reach of left_hand", "post": {"x_cm": 40, "y_cm": 30}}


def places(envs, name: str) -> np.ndarray:
    infant = envs.unwrapped.infants[0]
    return envs.unwrapped.worlds.data.xpos.numpy()[:, infant.model.body(f"object_{name}").id].copy()


@pytest.mark.slow
def test_objects_move_and_stay_on_a_device_as_on_the_cpu():
    spec, still = mimoc.InfantSpec.model_validate(SPEC), np.zeros((2, 1), np.float32)
    with closing(mimoc.make(spec)) as single, closing(mimoc.make_vec(spec, num_envs=2, device=DEVICE)) as envs:
        still = np.zeros(envs.action_space.shape, np.float32)
        for options in ({}, {"objects": ELSEWHERE}):
            single.reset(seed=0, options=options)
            envs.reset(seed=0, options=options)
            for _ in range(3):
                single.step(still[0])
                envs.step(still)
            for name in ("ball", "post", "bead", "mobile"):
                expected = single.unwrapped.data.body(f"object_{name}").xpos
                np.testing.assert_allclose(places(envs, name), np.tile(expected, (2, 1)), atol=1e-4, err_msg=name)
        moved = places(envs, "post")
        for moves, error in (({"ball": {"x_cm": 0, "y_cm": 0}}, ValueError), ({"bal": "on post"}, UnknownNameError)):
            with pytest.raises(error):
                envs.reset(options={"objects": moves})
        states = envs.unwrapped.get_state()
        envs.reset(seed=0)
        envs.step(still)
        assert np.abs(places(envs, "post") - moved).max() > 0.1
        envs.unwrapped.set_state(states)
        envs.unwrapped.grow([6, None])
        envs.step(still)
        np.testing.assert_allclose(places(envs, "post"), moved, atol=1e-6)
