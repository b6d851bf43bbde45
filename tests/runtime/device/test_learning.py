"""Learning on a device: what is learnt there runs on the CPU, goes on after an interruption, and says what it was."""

import json

import numpy as np
import pytest
import torch
from support.devices import WARP_DEVICE
from support.running import build

import mimoc
from mimoc.training.device_learner import Normalizer
from mimoc.training.trainer import train

DEVICE = f"warp:{WARP_DEVICE}" if WARP_DEVICE == "cpu" else WARP_DEVICE
SMALL = {"n_steps": 4, "width": 8, "layers": 2, "mini_batches": 2, "n_epochs": 1}
ONE_UPDATE = 8
"""Control steps of a rollout of two infants."""


@pytest.fixture(scope="module")
def infant() -> mimoc.Bundle:
    senses = {"proprioception": {"include": ["velocity"]}, "vestibular": {}}
    return build(age_months=12, senses=senses, task={"kind": "stand", "steps": 6})


def learn(infant, out, steps=2 * ONE_UPDATE, **options):
    keys = {"envs": 2, "device": DEVICE, "hyper": SMALL, "checkpoint_every": ONE_UPDATE, "seed": 5}
    return train(infant, out, steps=steps, **keys | options)


@pytest.fixture(scope="module")
def learnt(infant, tmp_path_factory):
    out = tmp_path_factory.mktemp("device") / "run"
    return learn(infant, out), out


@pytest.mark.slow
def test_two_updates_are_learnt_saved_and_told(learnt):
    training, out = learnt
    assert training.curve.steps == 2 * ONE_UPDATE
    assert "control steps/s" in training.speed
    run = json.loads((out / "run.json").read_text())
    assert run["settings"]["device"] == DEVICE
    assert {"rsl_rl_lib", "mujoco_warp"} <= run["sessions"][0].keys()
    first, last = (mimoc.load_policy(path) for path in sorted((out / "checkpoints").glob("*.zip")))
    assert first is not last


@pytest.mark.slow
def test_what_was_learnt_acts_on_the_cpu_as_on_the_device(infant, learnt):
    """On the same observations, to 1e-4; and starts are observed alike."""
    _, out = learnt
    env = mimoc.make(infant).unwrapped
    policy = mimoc.load_policy(out / "policy.zip")(env)
    there = mimoc.make_vec(infant, num_envs=2, device=DEVICE, touch="points")
    seen, _ = there.reset(seed=0)
    generator = np.random.default_rng(0)
    for world in range(2):
        observed, _ = env.reset(seed=world)
        for name, values in observed.items():
            assert seen[name][world] == pytest.approx(values, abs=1e-4)
        row = {name: values[world] for name, values in seen.items()}
        assert policy(generator, row) == pytest.approx(policy(generator, observed), abs=1e-3)
    mean = _mean_of(out, seen, infant)
    acts = [policy(generator, {name: values[world] for name, values in seen.items()}) for world in range(2)]
    assert np.array(acts) == pytest.approx(np.clip(mean, env.action_space.low, env.action_space.high), abs=1e-4)
    there.close()


def _mean_of(out, seen, infant):
    """Return the mean of rsl_rl's actor after it was restored from the checkpoint."""
    from mimoc.training.device_learner import DeviceLearner
    from mimoc.training.settings import ON_DEVICE, TrainingSettings

    settings = TrainingSettings.choose(ON_DEVICE, 16, 5, 2, 8, SMALL, device=DEVICE)
    learner = DeviceLearner(settings, mimoc.make(infant).unwrapped, lambda: mimoc.rsl_rl_env(infant, 2, DEVICE))
    assert learner.restore((out / "state.zip").read_bytes()).steps == 2 * ONE_UPDATE
    from tensordict import TensorDict

    device = learner.env.device
    observed = TensorDict(
        {name: torch.tensor(seen[name], device=device) for name in learner.env.spaces}, batch_size=[2]
    )
    with torch.no_grad():
        mean = learner.ppo.actor(learner.normalize(observed, learns=False)).cpu().numpy()
    learner.close()
    return mean


@pytest.mark.slow
def test_a_run_that_was_interrupted_ends_as_one_that_was_not(infant, learnt, tmp_path):
    """On Warp's CPU to the bit; each interval begins with its own seed and infants at their starts."""
    whole, out = learnt

    def stop(done, total):
        if done > ONE_UPDATE + 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        learn(infant, tmp_path / "run", progress=stop)
    resumed = learn(infant, tmp_path / "run")
    assert resumed.resumed_at == ONE_UPDATE
    for name in ("episodes", "episode_return", "unfinished_return"):
        assert resumed.curve.column(name) == pytest.approx(whole.curve.column(name), nan_ok=True)
    states = [mimoc.load_policy(folder / "policy.zip") for folder in (out, tmp_path / "run")]
    env = mimoc.make(infant).unwrapped
    observed, _ = env.reset(seed=0)
    one, other = (bind(env)(np.random.default_rng(0), observed) for bind in states)
    assert one == pytest.approx(other, abs=1e-6)


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({"algo": "sac"}, "learns on the CPU only"),
        ({"grow": "6:12"}, "grow: not there on device"),
        ({"record": "somewhere"}, "record: not there on device"),
        ({"processes": True}, "processes: not there on device"),
        ({"device": "cuda:77"}, "not there"),
        ({"hyper": {"batch_size": 8}}, "batch_size"),
    ],
)
def test_what_a_device_cannot_is_refused_and_nothing_is_written(infant, tmp_path, options, problem):
    with pytest.raises(mimoc.MimocError, match=problem) as refusal:
        learn(infant, tmp_path / "run", **options)
    assert "\n" not in str(refusal.value)
    assert not (tmp_path / "run" / "policy.zip").exists()


@pytest.mark.slow
def test_rsl_rl_gets_copies_that_stay_and_time_outs(infant):
    env = mimoc.rsl_rl_env(infant, 2, DEVICE)
    first = env.get_observations()
    before = {name: first[name].clone() for name in env.spaces}
    actions = torch.zeros((2, env.num_actions), device=env.device)
    outs = [env.step(actions) for _ in range(6)]
    assert all(torch.equal(first[name], before[name]) for name in before)
    assert [int(done.sum()) for _, _, done, _ in outs] == [0] * 5 + [2]
    assert outs[-1][3]["time_outs"].all()
    assert env.episode_length_buf.tolist() == [0, 0]
    env.close()
    with pytest.raises(mimoc.MimocError, match="device"):
        mimoc.rsl_rl_env(infant, 2, "cpu")


def test_statistics_are_those_of_all_that_was_counted():
    from tensordict import TensorDict

    generator = torch.Generator().manual_seed(0)
    sets = [torch.randn((count, 3), generator=generator, dtype=torch.float64) * 4 + 2 for count in (50, 200, 7)]
    normalizer = Normalizer({"a": 1, "b": 2}, 5.0, 0.01, "cpu")
    for values in sets:
        observed = TensorDict({"a": values[:, :1], "b": values[:, 1:]}, batch_size=[len(values)])
        scaled = normalizer(observed, learns=True)
    everything = torch.cat(sets)
    assert normalizer.mean.numpy() == pytest.approx(everything.mean(dim=0).numpy(), abs=1e-4)
    assert normalizer.var.numpy() == pytest.approx(everything.var(dim=0, unbiased=False).numpy(), rel=1e-4)
    assert float(scaled["observed"].abs().max()) <= 5.0
    other = Normalizer({"a": 1, "b": 2}, 5.0, 0.01, "cpu")
    other.restore(normalizer.statistics())
    assert torch.equal(other.mean, normalizer.mean)
