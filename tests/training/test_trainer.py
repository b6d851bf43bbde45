import csv
import json
import os
import shlex
import shutil
import zipfile
from dataclasses import replace

import numpy as np
import pytest
from stable_baselines3 import PPO
from support.full import full_but

import mimoc
import mimoc.training
from mimoc.base.errors import BundleError, MimocError, TrainingError, UnknownNameError
from mimoc.bundle.io import LOCK, pack_arrays, unpack_arrays
from mimoc.training.checkpoint import read_progress
from mimoc.training.run_folder import open_run_folder
from mimoc.training.settings import TrainingSettings

EVERY = 128  # Steps between checkpoints.
PNG = b"\x89PNG\r\n\x1a\n"


def everything_in(folder):
    return {path.relative_to(folder): path.is_file() and path.read_bytes() for path in folder.rglob("*")}


def timeless(curve):
    return mimoc.training.Curve(tuple(replace(row, wall_s=0.0) for row in curve.rows)).to_csv()


def interrupt(at: int):
    def tell(done, total):
        if done >= at:
            raise KeyboardInterrupt

    return tell


# The result of a training run.


def test_a_run_folder_has_all_that_is_needed_to_repeat_and_to_use_the_training(learn, bundle, tmp_path):
    training = learn("run")
    folder = tmp_path / "run"
    steps = [EVERY, 2 * EVERY]
    assert sorted(os.listdir(folder)) == [
        *("bundle", "checkpoints", "curve.csv", "curve.png", "policy.zip", "run.json", "state.zip", "tensorboard")
    ]
    assert sorted(os.listdir(folder / "checkpoints")) == [f"{each:010d}.zip" for each in steps]
    assert mimoc.read_bundle(folder / "bundle").files == bundle.files
    assert (folder / "curve.png").read_bytes().startswith(PNG)
    rows = list(csv.DictReader((folder / "curve.csv").read_text().splitlines()))
    assert [int(row["steps"]) for row in rows] == steps == training.curve.column("steps").tolist()
    assert (training.policy, training.resumed_at) == (folder / "policy.zip", 0)
    run = json.loads((folder / "run.json").read_text())
    assert {"mujoco", "gymnasium", "numpy", "torch", "stable_baselines3", "python", "mimoc"} <= run["sessions"][
        0
    ].keys()
    assert TrainingSettings(**run["settings"]).hyper["width"] == 8


def test_the_command_in_the_run_folder_has_all_settings(learn, tmp_path):
    learn("run", seed=3)
    command = shlex.split(json.loads((tmp_path / "run" / "run.json").read_text())["command"])
    assert command[:5] == ["mimoc", "train", "bundle", "-o", "NEW"]
    said = dict(zip(command[5::2], command[6::2], strict=True))
    assert (said["--algo"], said["--steps"], said["--seed"], said["--envs"]) == ("ppo", "256", "3", "2")
    assert said["--checkpoint-every"] == "128"
    assert {"n_steps=32", "width=8", "n_epochs=1"} <= set(command)


def test_the_curve_counts_the_episodes_that_ended(learn):
    """Of 30 steps at most, in two infants: four each in 128 steps, unless a ball is hit."""
    rows = learn("run").curve.rows
    assert all(4 <= row.episodes <= 20 and row.episode_steps <= 30 for row in rows)
    assert all(row.success_rate <= 1 and row.episode_return < 100 for row in rows)


def test_a_spec_is_built_and_trained(learn, bundle, tmp_path):
    (tmp_path / "infant.yaml").write_bytes(bundle.files["spec.yaml"])
    assert learn("from_spec", EVERY, source=tmp_path / "infant.yaml").curve.steps == EVERY
    assert mimoc.read_bundle(tmp_path / "from_spec" / "bundle").files[LOCK]


def test_sac_trains_too(learn):
    training = learn("sac", 64, "sac", checkpoint_every=64)
    assert training.curve.steps == 64


@pytest.mark.parametrize("algo", full_but(["ppo"], ["sac"]))
def test_an_infant_with_vision_is_trained_on_images(learn, built, algo):
    seeing = built(senses={"proprioception": {"include": []}, "vision": {"width_px": 40, "height_px": 40}})
    training = learn("seeing", 64, algo, source=seeing, checkpoint_every=64)
    env = mimoc.make(seeing)
    assert len(mimoc.evaluate(env, mimoc.load_policy(training.policy), episodes=1)) == 1
    env.close()


# Bundle and settings determine the result.


def test_the_same_seed_gives_the_same_policy_and_another_does_not(learn, learned, same):
    first, second, other = (learned(learn(name, seed=seed).policy) for name, seed in [("a", 0), ("b", 0), ("c", 1)])
    assert same(first, second)
    assert not same(first, other)


@pytest.mark.parametrize("algo", full_but(["ppo"], ["sac"]))
def test_an_interrupted_and_resumed_run_gives_the_same_policy_as_an_uninterrupted_one(learn, learned, same, algo):
    """Weights, optimisers, statistics and replay buffer, to the bit."""
    whole = learn("whole", 3 * EVERY, algo)
    with pytest.raises(KeyboardInterrupt):
        learn("parts", 3 * EVERY, algo, progress=interrupt(at=EVERY + 40))
    parts = learn("parts", 3 * EVERY, algo)
    assert (whole.resumed_at, parts.resumed_at) == (0, EVERY)
    assert same(learned(whole.policy), learned(parts.policy))
    assert timeless(whole.curve) == timeless(parts.curve)


@pytest.mark.parametrize("options", [{"threads": 1}, {"threads": 3}, {"processes": False}, {"processes": True}])
def test_environments_that_step_elsewhere_give_the_same_policy(learn, learned, same, trained, options):
    assert same(learned(trained / "policy.zip"), learned(learn("other", EVERY, **options).policy))


def test_a_finished_run_with_more_steps_continues_where_it_ended(learn, learned, same):
    learn("run", EVERY)
    more = learn("run", 2 * EVERY)
    assert (more.resumed_at, more.curve.steps) == (EVERY, 2 * EVERY)
    assert same(learned(more.policy), learned(learn("at once", 2 * EVERY).policy))


def test_a_finished_run_is_only_read(learn, tmp_path):
    first = learn("run")
    state = (tmp_path / "run" / "state.zip").read_bytes()
    again = learn("run")
    assert (again.resumed_at, again.curve.to_csv()) == (first.curve.steps, first.curve.to_csv())
    assert (tmp_path / "run" / "state.zip").read_bytes() == state
    assert learn("run", EVERY).curve.to_csv() == first.curve.to_csv()  # Fewer steps, too.


def test_curve_and_plot_are_restored_from_the_checkpoint(learn, tmp_path):
    learn("run")
    (tmp_path / "run" / "curve.csv").unlink()
    (tmp_path / "run" / "curve.png").write_bytes(b"")
    (tmp_path / "run" / ".mimoc-0123.tmp").touch()
    curve = learn("run").curve
    assert (tmp_path / "run" / "curve.csv").read_text() == curve.to_csv()
    assert (tmp_path / "run" / "curve.png").read_bytes().startswith(PNG)
    assert not list((tmp_path / "run").glob(".mimoc-*"))


def test_a_run_killed_before_the_first_checkpoint_starts_over(learn, tmp_path):
    with pytest.raises(KeyboardInterrupt):
        learn("run", progress=interrupt(at=10))
    assert {"run.json", "curve.csv"} <= {*os.listdir(tmp_path / "run")} - {"policy.zip"}
    assert learn("run").resumed_at == 0


# Refusals.


OTHERS = {
    "started with seed 0, not 1": {"seed": 1},
    "started with envs 2, not 4": {"envs": 4},
    "started with layers 1, not 2; n_epochs 1, not 10; n_steps 32, not 256; width 8, not 64": {
        "hyper": {"batch_size": 64}
    },
}


def test_other_settings_are_refused_without_force_and_nothing_is_changed(learn, tmp_path):
    learn("run", EVERY)
    before = everything_in(tmp_path)
    for said, options in OTHERS.items():
        with pytest.raises(TrainingError, match=said):
            learn("run", EVERY, **options)
        assert everything_in(tmp_path) == before
    assert learn("run", EVERY, seed=1, force=True).resumed_at == 0


def test_another_infant_is_refused(learn, built):
    learn("run", EVERY)
    with pytest.raises(TrainingError, match="started with another infant; use the same settings to resume it"):
        learn("run", EVERY, source=built(age_months=9))


@pytest.mark.parametrize("kind", ["folder", "file"])
def test_a_path_that_is_not_a_run_folder_is_left_alone(learn, tmp_path, kind):
    if kind == "folder":
        (tmp_path / "run").mkdir()
        (tmp_path / "run" / "thesis.tex").touch()
    else:
        (tmp_path / "run").touch()
    before = everything_in(tmp_path)
    with pytest.raises(TrainingError, match=r"not the folder of a training run|this is a file"):
        learn("run", EVERY, force=True)
    assert everything_in(tmp_path) == before


def test_two_processes_cannot_train_in_one_folder(learn, bundle, tmp_path):
    tiny = {"n_steps": 32, "batch_size": 64, "n_epochs": 1, "width": 8, "layers": 1}
    settings = TrainingSettings.choose("ppo", EVERY, 0, 2, EVERY, tiny)
    with (
        open_run_folder(tmp_path / "run", settings, bundle, force=False),
        pytest.raises(TrainingError, match="another process is training here"),
    ):
        learn("run", EVERY)
    assert learn("run", EVERY).curve.steps == EVERY


def test_a_damaged_checkpoint_is_refused(learn, tmp_path):
    learn("run", EVERY)
    for content in (b"", b"PK\x05\x06" + bytes(18), b"junk"):
        (tmp_path / "run" / "state.zip").write_bytes(content)
        with pytest.raises(TrainingError, match=r"state\.zip: checkpoint is damaged; training cannot resume.*--force"):
            learn("run")
    assert learn("run", EVERY, force=True).curve.steps == EVERY


@pytest.mark.parametrize("name", ["policy.optimizer/0/step", "policy.optimizer/0/exp_avg", "policy/log_std"])
def test_a_checkpoint_of_other_shapes_is_refused(learn, tmp_path, name):
    learn("run", EVERY)
    with zipfile.ZipFile(tmp_path / "run" / "state.zip") as archive:
        members = {member: archive.read(member) for member in archive.namelist()}
    weights = {**unpack_arrays(members["weights.npz"]), name: np.zeros((3, 5), np.float32)}
    with zipfile.ZipFile(tmp_path / "run" / "state.zip", "w") as archive:
        for member, content in {**members, "weights.npz": pack_arrays(weights)}.items():
            archive.writestr(member, content)
    with pytest.raises(TrainingError, match=r"state\.zip: checkpoint is damaged"):
        learn("run")


def test_a_checkpoint_of_an_earlier_version_is_refused(learn, tmp_path):
    policy = learn("run", EVERY).policy
    shutil.copy(policy, tmp_path / "run" / "state.zip")  # Which has torch's weights, as checkpoints had.
    with pytest.raises(TrainingError, match=r"state\.zip: checkpoint was saved by an earlier version .*--force"):
        learn("run")


@pytest.mark.parametrize(
    ("options", "error", "said"),
    [
        ({"algo": "pppo"}, UnknownNameError, "did you mean 'ppo'"),
        ({"steps": 0}, TrainingError, "steps: expected at least 1, got 0"),
        ({"seed": -1}, TrainingError, "seed: expected a non-negative integer, got -1"),
        ({"hyper": {"gama": 1}}, UnknownNameError, "did you mean 'gamma'"),
        ({"hyper": {"gamma": 2}}, TrainingError, "gamma: expected a number from 0 to 1, got 2"),
        ({"hyper": {"n_steps": 100}}, TrainingError, "200 steps .* is not a multiple of batch_size 256"),
        ({"source": "nowhere"}, BundleError, "nowhere: there is no such folder"),
    ],
)
def test_bad_settings_are_refused_before_anything_is_written(bundle, tmp_path, options, error, said):
    with pytest.raises(error, match=said):
        mimoc.train(options.pop("source", bundle), tmp_path / "run", **{"envs": 2} | options)
    assert not (tmp_path / "run").exists()


def test_images_too_small_to_learn_from_are_refused(learn, built, tmp_path):
    with pytest.raises(TrainingError, match="images of 16 x 16 px are too small to learn from"):
        learn("run", source=built(senses={"vision": {"width_px": 16, "height_px": 16}}))
    assert not (tmp_path / "run").exists()


# The files.


def test_the_checkpoint_has_the_progress(learn, tmp_path):
    training = learn("run")
    progress = read_progress((tmp_path / "run" / "state.zip").read_bytes())
    assert (progress.steps, progress.curve.to_csv()) == (2 * EVERY, training.curve.to_csv())


def test_stable_baselines_loads_the_policy_too(trained, learned, same):
    agent = PPO.load(trained / "policy.zip", device="cpu")
    assert agent.num_timesteps == EVERY
    assert same(agent.policy.state_dict(), learned(trained / "policy.zip")[0])


@pytest.mark.slow
def test_a_training_of_an_infant_that_grows_resumes_to_the_bit(learn, learned, same, tmp_path):
    growth = {"grow": "6:7", "schedule": "shuffled", "grow_steps": 2 * EVERY}
    whole = learn("whole", **growth)
    learn("parts", EVERY, **growth)
    parts = learn("parts", **growth)
    assert same(learned(whole.policy), learned(parts.policy))
    assert timeless(whole.curve) == timeless(parts.curve)
    with pytest.raises(TrainingError, match="schedule shuffled, not grown"):
        learn("parts", **growth | {"schedule": "grown"})
    command = json.loads((tmp_path / "whole" / "run.json").read_text())["command"]
    assert "--grow 6:7 --schedule shuffled --grow-steps 256" in command


def test_growing_infants_that_step_elsewhere_give_the_same_policy(learn, learned, same):
    growth = {"grow": "17.5:18", "grow_steps": EVERY}
    ways = {"together": None, "one after another": False}
    together, alone = (learned(learn(name, EVERY, **growth, processes=way).policy) for name, way in ways.items())
    assert same(together, alone)


def test_an_interrupted_training_of_an_infant_that_grows_resumes_to_the_bit(learn, learned, same):
    growth = {"grow": "17:18", "schedule": "reversed", "grow_steps": 2 * EVERY}
    with pytest.raises(KeyboardInterrupt):
        learn("parts", **growth, progress=interrupt(at=EVERY + 40))
    parts = learn("parts", **growth)
    assert parts.resumed_at == EVERY
    assert same(learned(parts.policy), learned(learn("whole", **growth).policy))


def test_an_infant_that_cannot_have_an_age_is_refused_before_anything_is_written(learn, bundle, tmp_path):
    files = {name: content for name, content in bundle.files.items() if name != "resolved.yaml"}
    with pytest.raises(BundleError, match=r"cannot be built at 6 months: there is no resolved\.yaml"):
        learn("run", source=mimoc.Bundle(files, bundle.manifest, None), grow="6:12")
    assert not (tmp_path / "run").exists()


def test_growth_needs_a_range_of_ages(learn, tmp_path):
    with pytest.raises(MimocError, match="range of ages"):
        learn("run", grow="12:6")
    with pytest.raises(TrainingError, match="needs a range of ages"):
        learn("run", grow_steps=10)
    with pytest.raises(TrainingError, match="schedule needs a range of ages"):
        learn("run", schedule="adult")
    assert not (tmp_path / "run").exists()
