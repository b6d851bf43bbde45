"""Training on a device: here on `warp:cpu`, MuJoCo Warp on the CPU."""

import json
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

import mimoc
from mimoc.base.errors import MimocError, PolicyError
from mimoc.bundle.io import unpack_arrays
from mimoc.policies.policy_file import Archive
from mimoc.training import trainer
from mimoc.training.checkpoint import Progress, restore_state
from mimoc.training.device_learner import DeviceCurve, make_ppo
from mimoc.training.rsl_rl_env import EnvRows, InfantRslEnv
from mimoc.training.run_folder import read_training_run
from mimoc.training.trainer import TrainingJob, train_together

pytestmark = pytest.mark.usefixtures("kernels_compiled_quickly")

DEVICE = "warp:cpu"
TINY = {"n_steps": 32, "mini_batches": 2, "n_epochs": 2, "width": 8, "layers": 1}
EVERY = 128  # Control steps of a rollout of four infants, and between checkpoints.


def learn(bundle: mimoc.Bundle, folder: Path, steps: int, **options: Any) -> Any:
    chosen = {"envs": 4, "checkpoint_every": EVERY, "hyper": TINY, "device": DEVICE, "steps_per_episode": 15} | options
    return mimoc.train(bundle, folder, steps=steps, **chosen)


@pytest.fixture(scope="session")
def device_run(bundle, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "device"
    training = learn(bundle, folder, 2 * EVERY)
    assert training.use is not None
    assert training.use.physics_steps_per_s > training.use.control_steps_per_s > 0
    assert 0 <= training.use.success <= 1
    return folder


def arrays_of(file: Path) -> dict[str, np.ndarray]:
    return unpack_arrays(Archive(file.read_bytes()).content("weights.npz"))


@pytest.mark.slow
def test_a_resumed_training_equals_one_that_was_not_interrupted(bundle, device_run, tmp_path):
    """To the bit, on MuJoCo Warp's CPU: what is learnt, the policy's bytes, and the curve but for its times."""
    learn(bundle, tmp_path / "run", EVERY)
    assert learn(bundle, tmp_path / "run", 2 * EVERY).resumed_at == EVERY
    ours, theirs = arrays_of(tmp_path / "run" / "state.zip"), arrays_of(device_run / "state.zip")
    assert ours.keys() == theirs.keys()
    assert all(np.array_equal(ours[name], theirs[name]) for name in ours)
    last = Path("checkpoints", f"{2 * EVERY:010d}.zip")
    assert (tmp_path / "run" / last).read_bytes() == (device_run / last).read_bytes()


@pytest.mark.slow
def test_the_curve_has_returns_lengths_and_successes(device_run):
    rows = mimoc.training.Curve.from_csv((device_run / "curve.csv").read_text()).rows
    assert [row.steps for row in rows] == [EVERY, 2 * EVERY]
    assert all(row.episodes >= 4 and 0 < row.episode_steps <= 15 and 0 <= row.success_rate <= 1 for row in rows)
    run = json.loads((device_run / "run.json").read_text())
    assert run["settings"]["device"] == DEVICE
    assert {"rsl-rl-lib", "mujoco-warp", "warp-lang"} <= run["sessions"][0].keys()


@pytest.mark.slow
def test_its_policy_acts_on_the_cpu_as_on_the_device(bundle, device_run):
    """The same observations give the actions of rsl_rl's network, one at a time and many at once."""
    with _opened(bundle) as env:
        ppo = make_ppo(env, read_training_run(device_run)[0].settings)
        state = {name: array for name, array in arrays_of(device_run / "state.zip").items() if name.startswith("actor")}
        restore_state({"actor": ppo.actor}, state)
        with torch.no_grad():
            wanted = ppo.actor(env.get_observations()).clamp(-1, 1).numpy()
        seen = {name: array.numpy().copy() for name, array in env.infants.worlds.observation.items()}
    infant: Any = mimoc.make(bundle).unwrapped
    policy: Any = mimoc.load_policy(device_run / "policy.zip")(infant)
    assert np.abs(policy(None, seen) - wanted).max() < 1e-4
    for row in range(4):
        alone = policy(None, {name: array[row] for name, array in seen.items()})
        assert np.abs(alone - wanted[row]).max() < 1e-4
    assert policy.steps_per_episode == 15


def _opened(bundle: mimoc.Bundle) -> Any:
    return closing(mimoc.rsl_rl_env(bundle, 4, DEVICE))


@pytest.mark.slow
def test_an_infant_observes_on_the_device_what_it_observes_on_the_cpu(bundle):
    with _opened(bundle) as env:
        there = env.get_observations()["policy"].numpy()
    infant = mimoc.make(bundle)
    for seed in range(4):
        observation, _ = infant.reset(seed=seed)
        alone = np.concatenate([np.ravel(observation[name]) for name in sorted(observation)])
        assert np.abs(alone - there[seed]).max() < 1e-4


@pytest.mark.slow
def test_commands_run_its_policy(device_run, invoke):
    done = invoke("run", device_run / "bundle", "--policy", device_run / "policy.zip", "--steps", "5")
    assert (done.code, done.err) == (0, "")


def test_an_infant_that_senses_more_takes_its_policy(built, bundle, device_run):
    """What was sensed in training is picked by its names, wherever it is now."""
    policy = mimoc.load_policy(device_run / "policy.zip")
    richer: Any = mimoc.make(built(senses={"proprioception": {}, "vestibular": {}})).unwrapped
    plain: Any = mimoc.make(bundle).unwrapped
    seen, _ = plain.reset(seed=0)
    more, _ = richer.reset(seed=0)
    assert np.array_equal(policy(plain)(None, seen), policy(richer)(None, more))
    poorer: Any = mimoc.make(built(senses={"proprioception": {"include": ["velocity"]}})).unwrapped
    with pytest.raises(PolicyError, match="'proprioception' had shape"):
        policy(poorer)


def test_a_policy_for_another_infant_or_a_damaged_one_is_refused(device_run, built, tmp_path):
    other: Any = mimoc.make(built(senses={"vestibular": {}})).unwrapped
    with pytest.raises(PolicyError, match="trained for a different infant, 'reaching': observation"):
        mimoc.load_policy(device_run / "policy.zip")(other)
    content = (device_run / "policy.zip").read_bytes()
    damaged = tmp_path / "policy.zip"
    for end in range(0, len(content), max(len(content) // 50, 1)):
        damaged.write_bytes(content[:end])
        with pytest.raises(PolicyError, match="not a policy trained by mimoc"):
            mimoc.load_policy(damaged)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--algo", "sac"], "'sac' is not a learning algorithm on a device"),
        (["--record", "films"], "a training on a device is not recorded; leave out --record, or --device"),
        (["--processes"], "leave out --processes and --one-process, or --device"),
        (["--threads", "2"], "leave out --threads, or --device"),
        (["--grow", "17:18"], "leave out --grow, or --device"),
        (["--set", "batch_size=64"], "'batch_size' is not a hyperparameter of ppo"),
        (["--set", "mini_batches=3"], "choose mini_batches that divide it"),
        (["--device", "warp:cuda:9"], "device 'cuda:9' is not there"),
        (["--device", "cpu", "--envs", "2000"], "expected at most 1024 on the CPU, got 2000"),
    ],
)
def test_what_a_device_does_not_have_is_refused_before_anything_is_written(options, message, bundle, tmp_path, invoke):
    mimoc.write_bundle(bundle, tmp_path / "infant")
    out = tmp_path / "run"
    done = invoke("train", tmp_path / "infant", "-o", out, "--device", DEVICE, "--envs", "4", *options)
    assert done.code == 2
    assert message in done.err
    assert len(done.err.splitlines()) == 1
    assert not out.exists()


def test_images_and_infants_on_the_cpu_are_refused(built, bundle, tmp_path):
    seeing = built(senses={"vision": {"width_px": 40, "height_px": 40}})
    with pytest.raises(MimocError, match="is an image, which networks of plain layers do not learn from"):
        learn(seeing, tmp_path / "run", EVERY)
    assert not (tmp_path / "run").exists()
    with pytest.raises(MimocError, match="rsl_rl learns from infants on a device"):
        mimoc.rsl_rl_env(bundle, 2, device="cpu")


@pytest.mark.slow
def test_what_was_learnt_before_ctrl_c_is_kept_and_gone_on_from(bundle, device_run, tmp_path, monkeypatch):
    def stop(done: int, total: int) -> None:
        if done > EVERY + 8:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        learn(bundle, tmp_path / "run", 2 * EVERY, progress=stop)
    assert mimoc.training.Curve.from_csv((tmp_path / "run" / "curve.csv").read_text()).steps > EVERY
    mimoc.load_policy(tmp_path / "run" / "policy.zip")
    assert learn(bundle, tmp_path / "run", 2 * EVERY).resumed_at == EVERY
    ours, theirs = ((folder / "policy.zip").read_bytes() for folder in (tmp_path / "run", device_run))
    assert ours == theirs


@pytest.mark.slow
def test_rsl_rls_own_runner_learns(bundle, capsys):
    from rsl_rl.runners import OnPolicyRunner

    model = {"class_name": "MLPModel", "hidden_dims": [8], "obs_normalization": True}
    settings = {
        "num_steps_per_env": 8,
        "save_interval": 100,
        "obs_groups": {"actor": ["policy"], "critic": ["policy"]},
        "algorithm": {"class_name": "PPO", "num_mini_batches": 2, "num_learning_epochs": 1},
        "actor": {**model, "distribution_cfg": {"class_name": "GaussianDistribution"}},
        "critic": model,
    }
    with _opened(bundle) as env:
        assert isinstance(env, InfantRslEnv)
        OnPolicyRunner(env, settings).learn(2, init_at_random_ep_len=True)
        assert env.get_observations()["policy"].shape == (4, 295)
        env.reset(seed=1)  # After rsl_rl's inference mode.


def test_the_table_of_refusals_names_options_of_training():
    from inspect import signature

    assert trainer.ONLY_ON_CPU.keys() <= signature(mimoc.train).parameters.keys()


EVERY_STEPS = 16
TOGETHER = {"n_steps": 8, "mini_batches": 2, "n_epochs": 2, "width": 8, "layers": 1}


@pytest.fixture(scope="module")
def infants(built) -> list[mimoc.Bundle]:
    return [built(task={"kind": "reach", "steps": 5})] * 2


def together(infants: list[mimoc.Bundle], folder: Path, **options: Any) -> Any:
    jobs = [TrainingJob(infant, folder / str(number), seed=number) for number, infant in enumerate(infants)]
    return train_together(
        jobs,
        DEVICE,
        **{"steps": EVERY_STEPS, "envs": 2, "hyper": TOGETHER, "checkpoint_every": EVERY_STEPS} | options,
    )


def learnt(folder: Path, number: int) -> dict[str, Any]:
    """Return what a training has learnt: networks, what they divide by, and the optimizer's state."""
    return unpack_arrays(Archive((folder / str(number) / "state.zip").read_bytes()).content("weights.npz"))


@pytest.mark.slow
def test_trainings_side_by_side_learn_what_each_learns_alone(infants, tmp_path):
    """In single precision: in a batch of another size, MuJoCo Warp rounds differently."""
    reports = list[tuple[int, int]]()
    trainings = together(infants, tmp_path / "together", progress=lambda *report: reports.append(report))
    assert [training.curve.steps for training in trainings] == [EVERY_STEPS, EVERY_STEPS]
    assert all(0 <= training.use.success <= 1 for training in trainings)
    assert reports[-1] == (2 * EVERY_STEPS, 2 * EVERY_STEPS)
    options: Any = {"steps": EVERY_STEPS, "envs": 2, "hyper": TOGETHER, "device": DEVICE}
    for number, infant in enumerate(infants):
        mimoc.train(infant, tmp_path / "alone" / str(number), seed=number, **options)
        ours, theirs = (learnt(tmp_path / how, number) for how in ("together", "alone"))
        assert ours.keys() == theirs.keys()
        assert all(np.allclose(ours[name], theirs[name], rtol=1e-3, atol=1e-5) for name in ours)
        other = learnt(tmp_path / "together", 1 - number)
        assert not np.allclose(ours["actor/mlp.0.weight"], other["actor/mlp.0.weight"], atol=1e-2)


@pytest.mark.slow
def test_ctrl_c_keeps_what_each_has_learnt_and_all_go_on(infants, tmp_path):
    def stop(done: int, total: int) -> None:
        if done > 3 * EVERY_STEPS:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        together(infants, tmp_path / "run", steps=2 * EVERY_STEPS, progress=stop)
    for number in range(2):
        mimoc.load_policy(tmp_path / "run" / str(number) / "policy.zip")
    reports = list[int]()
    resumed = together(
        infants, tmp_path / "run", steps=2 * EVERY_STEPS, progress=lambda done, total: reports.append(done)
    )
    assert 2 * EVERY_STEPS < reports[0] < reports[-1] == 4 * EVERY_STEPS
    assert {training.resumed_at for training in resumed} == {EVERY_STEPS}
    again = together(infants, tmp_path / "run", steps=2 * EVERY_STEPS)
    assert [training.use for training in again] == [None, None]


@pytest.mark.slow
def test_trainings_that_are_not_equally_far_end_together(infants, tmp_path):
    together(infants[:1], tmp_path / "run")
    trainings = together(infants, tmp_path / "run", steps=2 * EVERY_STEPS)
    assert [training.resumed_at for training in trainings] == [EVERY_STEPS, 0]
    assert [training.curve.steps for training in trainings] == [2 * EVERY_STEPS] * 2


def test_the_infants_of_a_learner_are_not_all_equally_far_in_their_episodes():
    ended = SimpleNamespace(steps=torch.zeros(8, dtype=torch.int64), limits=torch.full((8,), 30))
    infants = SimpleNamespace(worlds=SimpleNamespace(ended=ended))
    env: Any = SimpleNamespace(num_envs=8, num_actions=1, infants=infants, device="cpu", max_episode_length=30)
    torch.manual_seed(0)
    EnvRows(env, first=1, every=2).randomize_episode_phase()
    theirs, others = ended.steps[1::2].tolist(), ended.steps[::2].tolist()
    assert others == [0] * 4
    assert len(set(theirs)) > 1
    assert all(0 <= steps < 30 for steps in theirs)


def test_an_episode_that_was_cut_at_a_random_time_does_not_count():
    curve = DeviceCurve(Progress(), 0.02, 2, "cpu", lambda row: None)
    done, not_done = torch.tensor([True, False]), torch.tensor([False, False])
    for dones in (done, not_done, done, done):
        flags = {"is_success": torch.tensor([True, True]), "overflowed": not_done}
        curve.add(torch.ones(2), dones, flags)
    row = curve.end_row()
    assert (row.episodes, row.success_rate, row.episode_steps, row.episode_return) == (2, 1.0, 1.5, 1.5)
    assert (row.unfinished, row.unfinished_steps) == (1, 4.0)
