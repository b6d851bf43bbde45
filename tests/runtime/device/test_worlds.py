"""Infants on MuJoCo Warp, by default on its CPU device, sense and earn what they do on the CPU."""

from dataclasses import dataclass, replace

import gymnasium
import numpy as np
import pytest
import torch
from gymnasium.error import ClosedEnvironmentError
from support.devices import (
    CLOSE,
    DEVICE,
    WARP_DEVICE,
    assert_close,
    break_down,
    infant,
    random_actions,
    sitting,
    spec,
    still,
)

import mimoc
from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.components.actuation.run import bind_torque as bind
from mimoc.runtime.device.bodies import WorldsError
from mimoc.runtime.device.signals import DeviceError
from mimoc.runtime.device.vector_env import DeviceEnv
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.gymnasium_forms import BatchMismatchError
from mimoc.runtime.term import Term
from mimoc.schema.kinds import ActuationKind

AGES_MONTHS = (0, 3, 6, 9, 12, 18, 24)


@pytest.mark.slow
def test_infants_of_seven_ages_at_once_feel_what_they_do_on_the_cpu(pair):
    """After 20 physics steps, with all senses and every point of the skin.

    With the commands of seed 0, an elbow meets the trunk in the third step by less than float32 tells, on one of both.
    """
    ours, theirs = pair([sitting(age) for age in AGES_MONTHS], touch="points")
    (seen, _), (expected, _) = ours.reset(seed=3), theirs.reset(seed=3)
    generator = np.random.default_rng(1)
    for _ in range(10):
        command = random_actions(theirs, generator)
        seen, expected = ours.step(command)[0], theirs.step(command)[0]
        assert seen.keys() == expected.keys()
        assert_close(seen, expected, theirs.infants[0])
    assert np.abs(ours.worlds.data.qpos.numpy() - [each.data.qpos for each in theirs.infants]).max() < CLOSE
    assert (np.abs(expected["touch"]).sum(axis=1) > 0).all()
    assert ours.observation_space.contains(seen)


def delayed(age_months: float, **impairments: object) -> mimoc.Bundle:
    return sitting(age_months, delays={"preset": "physiological"}, impairments=impairments)


def test_delays_of_each_age_are_those_of_the_cpu(pair):
    """With an arm that is later than the other in the older infant, and stretch reflexes in both."""
    spastic = {"knees": {"kind": "spastic"}}
    late = {"right_arm": 2, "right_hand": 3, "legs": 1.5}
    ours, theirs = pair([delayed(1, tone=spastic), delayed(20, tone=spastic, delay=late)], touch="points")
    ours.reset(seed=0), theirs.reset(seed=0)
    generator = np.random.default_rng(1)
    for _ in range(12):
        command = random_actions(theirs, generator)
        seen, expected = ours.step(command)[0], theirs.step(command)[0]
        assert_close(seen, expected, theirs.infants[0])
    assert not np.allclose(expected["touch"], 0)


def test_bodies_feel_the_sum_of_their_points(pair):
    ours, theirs = pair([sitting(6), sitting(12)])
    seen, expected = ours.reset(seed=0)[0], theirs.reset(seed=0)[0]
    for _ in range(3):
        command = still(theirs)
        seen, expected = ours.step(command)[0], theirs.step(command)[0]
    bodies = theirs.infants[0].senses["touch"].bodies[::3]
    sums = [expected["touch"].reshape(2, -1, 3)[:, bodies == body].sum(axis=1) for body in np.unique(bodies)]
    assert seen["touch"].reshape(2, -1, 3) == pytest.approx(np.stack(sums, axis=1), abs=0.02)
    assert np.abs(seen["touch"]).max() > 1


@pytest.mark.parametrize("model", ["muscle", "position"])
def test_every_actuation_model_moves_as_on_the_cpu(pair, model):
    ours, theirs = pair([infant(age, actuation={"model": model}) for age in (6, 12)])
    ours.reset(seed=0), theirs.reset(seed=0)
    generator = np.random.default_rng(2)
    for _ in range(5):
        command = random_actions(theirs, generator)
        seen, expected = ours.step(command)[0], theirs.step(command)[0]
    assert_close(seen, expected, theirs.infants[0])


@pytest.mark.parametrize("kind", ["reach", "standup", "rollover", "selfbody", "catch", "sit", "grasp"])
def test_every_task_earns_what_it_does_on_the_cpu(pair, kind):
    """In the pose of `standup`, soles just touch the floor, so that the last digit decides how ankles begin to turn."""
    calm = {"noise": {"motor": 0.0}}  # Of the age in skills, unless told; a device draws other numbers.
    ours, theirs = pair([infant(age, task={"kind": kind}, **calm) for age in (12, 18)], 3, starts=3)
    seen, expected = ours.reset(seed=0)[0], theirs.reset(seed=0)[0]
    assert_close(seen, expected, theirs.infants[0])
    generator = np.random.default_rng(3)
    earned = []
    for _ in range(8):
        command = 0.5 * random_actions(theirs, generator)
        seen, rewards, terminated, _, info = ours.step(command)
        expected, wanted, ends, _, told = theirs.step(command)
        assert rewards == pytest.approx(wanted, rel=1e-3, abs=1e-3)
        assert terminated.tolist() == ends.tolist()
        assert info["is_success"].tolist() == told["is_success"].tolist()
        for name, values in info["reward_terms"].items():
            assert values == pytest.approx(told["reward_terms"][name], abs=1e-3)
        earned.append(wanted)
    assert_close(seen, expected, theirs.infants[0], limit=(20 if kind == "standup" else 10) * CLOSE)
    assert np.any(earned)


def test_an_infant_whose_episode_ends_begins_anew_as_agreed(make):
    """In the next step, in the same one with its last view told, or when it is reset by the caller."""
    infants = [infant(age, task={"kind": "reach"}) for age in (12, 18)]
    views = {}
    for mode in ("NextStep", "SameStep", "Disabled"):
        env = make(infants, autoreset_mode=mode, max_episode_steps=2, starts=2)
        first = env.reset(seed=0)[0]["proprioception"]
        command = np.ones(env.action_space.shape, np.float32)
        assert not env.step(command)[3].any()
        seen, _, _, truncated, info = env.step(command)
        assert truncated.all()
        starts = [
            env.worlds.default_starts.samples["proprioception"].cpu().numpy()[index : index + 2] for index in (0, 2)
        ]
        if mode == "NextStep":
            views["last"] = seen["proprioception"]
            seen, rewards, _, truncated, _ = env.step(command)
            assert not truncated.any()
            assert not rewards.any()
        elif mode == "SameStep":
            assert info["final_obs"]["proprioception"] == pytest.approx(views["last"], abs=1e-3)
            assert info["_final_obs"].all()
        else:
            with pytest.raises(Exception, match=r"infants \[0, 1\] have ended"):
                env.step(command)
            seen, _ = env.reset(options={"reset_mask": np.array([True, True])})
        for own, begun in zip(starts, seen["proprioception"], strict=True):
            assert any(np.allclose(start, begun, atol=1e-5) for start in own)
        assert first.shape == seen["proprioception"].shape


def test_a_simulation_that_breaks_down_ends_its_own_episode_only(make):
    env = make(sitting(9), 2)
    env.reset(seed=0)
    break_down(env)
    command = still(env)
    seen, _, terminated, _, info = env.step(command)
    assert info["unstable"].tolist() == terminated.tolist() == [True, False]
    assert env.observation_space.contains(seen)
    for _ in range(2):
        seen, _, terminated, _, info = env.step(command)
        assert not info["unstable"].any()
        assert not terminated.any()
    assert env.observation_space.contains(seen)
    env.close()
    env.close()
    for use in (env.reset, lambda: env.step(command), lambda: env.grow(to=9)):
        with pytest.raises(ClosedEnvironmentError):
            use()


def test_torch_sees_the_memory_of_the_environment_and_commands_from_it(make):
    env = make(sitting(9), 2, arrays="torch")
    first, _ = env.reset(seed=0)
    assert isinstance(first["vestibular"], torch.Tensor)
    before = first["vestibular"].clone()
    seen, rewards, terminated, _, _ = env.step(torch.ones(env.action_space.shape))
    assert seen["vestibular"].data_ptr() == first["vestibular"].data_ptr()
    assert not torch.equal(before, first["vestibular"])
    assert rewards.shape == terminated.shape == (2,)
    arrays = make(sitting(9), 2, arrays="warp")
    begun, _ = arrays.reset(seed=0)
    assert torch.from_dlpack(begun["vestibular"]).data_ptr() == begun["vestibular"].ptr


def test_commands_that_are_not_finite_are_errors(make):
    env = make(sitting(9), 2)
    env.reset(seed=0)
    command = np.zeros(env.action_space.shape, np.float32)
    command[1, 3] = np.nan
    with pytest.raises(ValueError, match=r"expected finite actions, got .* for infant 1"):
        env.step(command)
    with pytest.raises(ValueError, match=r"of shape \(2, 44\), got shape \(2, 3\)"):
        env.step(command[:, :3])
    env.step(torch.from_numpy(command))
    with pytest.raises(DeviceError, match="last actions of infant 1 were not finite"):
        env.step(0 * command)


def test_a_task_that_is_no_term_stays_on_the_cpu():
    alone = InfantEnv(sitting(9), task=mimoc.Task())
    with pytest.raises(DeviceError, match=r"'mimoc\.runtime\.task:Task' is not a term, so it runs on the CPU only"):
        DeviceEnv([alone], device=WARP_DEVICE)
    alone.close()


def test_what_cannot_live_on_a_device_is_told():
    for error, text, sources, options in (
        (DeviceError, "device 'cuda:99' is not there; MuJoCo Warp finds .*", sitting(9), {"device": "cuda:99"}),
        (DeviceError, "device 'gpu' is not there", sitting(9), {"device": "gpu"}),
        (BatchMismatchError, "commands", [sitting(9), infant(9, body={"hands": "five_finger"})], {}),
        (WorldsError, "models differ in", [infant(9, scene={"kind": "crib"}), infant(9)], {}),
        (UnknownNameError, "'numbers' is not a kind of arrays", sitting(9), {"arrays": "numbers"}),
        (UnknownNameError, "'skin' is not a way to tell of touch", sitting(9), {"touch": "skin"}),
        (UnknownNameError, f"option of infants on device '{DEVICE}'", sitting(9), {"width": 3}),
        (MimocError, "cannot be rendered", sitting(9), {"render_mode": "rgb_array"}),
    ):
        with pytest.raises(error, match=text) as raised:
            mimoc.make_vec(sources, 2, **{"device": DEVICE, **options})
        assert "\n" not in str(raised.value)


@dataclass(frozen=True)
class Half(Term):
    """Half of what is commanded."""

    def __call__(self, worlds, actions):
        return 0.5 * actions


def bind_halved(entry, model):
    return replace(bind(entry, model), command=Half())


HALVED = ActuationKind(
    "halved", "Half of what is commanded.", build="mimoc.components.actuation.torque", run=bind_halved
)


def test_actuation_that_a_plugin_brings_acts_on_one_on_many_and_on_a_device(registered):
    with registered(HALVED):
        halved = mimoc.build(spec(9, development="published", actuation={"model": "halved"}))
        alone, many = mimoc.make(halved), mimoc.make_vec(halved, 2, threads=1)
        device = mimoc.make_vec(halved, 2, device=DEVICE)
        action = np.full(alone.action_space.shape, 0.4, np.float32)
        for env in (alone, many, device):
            env.reset(seed=0)
            env.step(np.broadcast_to(action, env.action_space.shape))
        datas = [alone.unwrapped.data, *(each.data for each in many.infants)]
        for controls in (*(data.ctrl for data in datas), *device.worlds.data.ctrl.numpy()):
            assert controls == pytest.approx(np.full(len(controls), 0.2))
        alone.close(), many.close(), device.close()


class Height:
    """A sense that is no term."""

    space = gymnasium.spaces.Box(-10.0, 10.0, (1,), np.float32)

    def __call__(self, data):
        return data.qpos[2:3]


@dataclass(frozen=True)
class Heights(Term):
    bodies: np.ndarray

    def __call__(self, worlds, *args):
        return worlds.xp.take(worlds.xpos, self.bodies, axis=1)[..., 2:]


class Tall:
    """A sense that is a term, of a shape and with a delay of its own."""

    space = gymnasium.spaces.Box(-10.0, 10.0, (2, 1), np.float32)
    delay_ms = 15

    def bind(self, model, bundle):
        self.term = Heights(np.array([model.body(name).id for name in ("head", "chest")]))


def test_a_sense_that_is_no_term_is_told_and_one_that_is_senses_as_on_the_cpu(pair):
    with pytest.raises(DeviceError, match=r"sense 'tall' is not a term and has no device part: give it one"):
        mimoc.make_vec(infant(9), 2, device=DEVICE, senses={"tall": Height()})
    ours, theirs = pair([infant(age) for age in (6, 12)], senses={"tall": Tall()})
    ours.reset(seed=0), theirs.reset(seed=0)
    generator, views = np.random.default_rng(4), []
    for _ in range(4):
        command = random_actions(theirs, generator)
        seen, expected = ours.step(command)[0], theirs.step(command)[0]
        assert seen["tall"].shape == (2, 2, 1)
        assert seen["tall"] == pytest.approx(expected["tall"], abs=1e-5)
        views.append(seen["tall"])
    assert (views[-1] != views[0]).all()
