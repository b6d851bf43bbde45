"""Trainings side by side on one device: here on `warp:cpu`."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

import mimoc
from mimoc.bundle.arrays import unpack_arrays
from mimoc.policies.policy_file import Archive
from mimoc.training.checkpoint import Progress
from mimoc.training.device_learner import DeviceCurve
from mimoc.training.rsl_rl_env import EnvRows
from mimoc.training.trainer import TrainingJob, train_together

pytestmark = pytest.mark.usefixtures("kernels_compiled_quickly")

DEVICE, EVERY = "warp:cpu", 16
TINY = {"n_steps": 8, "mini_batches": 2, "n_epochs": 2, "width": 8, "layers": 1}


@pytest.fixture(scope="module")
def infants(built) -> list[mimoc.Bundle]:
    """Return the same child twice."""
    return [built(task={"kind": "reach", "steps": 5})] * 2


def together(infants: list[mimoc.Bundle], folder: Path, **options: Any) -> Any:
    jobs = [TrainingJob(infant, folder / str(number), seed=number) for number, infant in enumerate(infants)]
    return train_together(
        jobs, DEVICE, **{"steps": EVERY, "envs": 2, "hyper": TINY, "checkpoint_every": EVERY} | options
    )


def learnt(folder: Path, number: int) -> dict[str, Any]:
    """Return what a training has learnt: networks, what they divide by, and the optimizer's state."""
    return unpack_arrays(Archive((folder / str(number) / "state.zip").read_bytes()).content("weights.npz"))


@pytest.mark.slow
def test_trainings_side_by_side_learn_what_each_learns_alone(infants, tmp_path):
    """In single precision: in a batch of another size, MuJoCo Warp rounds differently."""
    reports = list[tuple[int, int]]()
    trainings = together(infants, tmp_path / "together", progress=lambda *report: reports.append(report))
    assert [training.curve.steps for training in trainings] == [EVERY, EVERY]
    assert all(0 <= training.use.success <= 1 for training in trainings)
    assert reports[-1] == (2 * EVERY, 2 * EVERY)
    options: Any = {"steps": EVERY, "envs": 2, "hyper": TINY, "device": DEVICE}
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
        if done > 3 * EVERY:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        together(infants, tmp_path / "run", steps=2 * EVERY, progress=stop)
    for number in range(2):
        mimoc.load_policy(tmp_path / "run" / str(number) / "policy.zip")
    reports = list[int]()
    resumed = together(infants, tmp_path / "run", steps=2 * EVERY, progress=lambda done, total: reports.append(done))
    assert 2 * EVERY < reports[0] < reports[-1] == 4 * EVERY
    assert {training.resumed_at for training in resumed} == {EVERY}
    again = together(infants, tmp_path / "run", steps=2 * EVERY)
    assert [training.use for training in again] == [None, None]


@pytest.mark.slow
def test_trainings_that_are_not_equally_far_end_together(infants, tmp_path):
    together(infants[:1], tmp_path / "run")
    trainings = together(infants, tmp_path / "run", steps=2 * EVERY)
    assert [training.resumed_at for training in trainings] == [EVERY, 0]
    assert [training.curve.steps for training in trainings] == [2 * EVERY] * 2


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
