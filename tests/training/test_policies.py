import os
import shutil
import zipfile

import numpy as np
import pytest

import mimoc
from mimoc.errors import PolicyError
from mimoc.runtime.rollout import Run


@pytest.fixture
def policy(trained):
    return trained / "policy.zip"


def infant(bundle):
    return mimoc.InfantEnv(bundle)


def rewritten(source, target, **members):
    """Copy a zip file, with other content for some of its members; None leaves one out."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            if members.get(name, b"") is not None:
                new.writestr(name, members.get(name) or old.read(name))
    return target


def test_a_policy_acts_alike_on_alike_observations_and_within_the_range(bundle, policy):
    env = infant(bundle)
    act, generator = mimoc.load_policy(policy)(env), np.random.default_rng(0)
    observation, _ = env.reset(seed=3)
    action = act(generator, observation)
    np.testing.assert_array_equal(action, act(np.random.default_rng(1), observation))
    assert env.action_space.contains(action)
    assert generator.bit_generator.state == np.random.default_rng(0).bit_generator.state
    moved, *_ = env.step(np.ones_like(action))
    assert (act(generator, moved) != action).any()


def test_an_infant_runs_under_a_policy(bundle, policy):
    run = Run(infant(bundle), mimoc.load_policy(policy), seed=0)
    for _ in range(70):
        run.step()
    told = run.summary()
    assert told.finished >= 2
    assert told.mean_return is not None
    assert told.successes <= told.finished == told.episodes - 1


def test_what_an_observation_is_scaled_by_travels_with_the_policy(bundle, policy):
    """And what trembles by less than the floor is not blown up."""
    act = mimoc.load_policy(policy)(infant(bundle))
    deviation = act.scale["proprioception.deviation"]
    assert deviation.min() >= 0.01
    observation = {"proprioception": (act.scale["proprioception.mean"] + 1e9).astype(np.float32)}
    assert np.isfinite(act(np.random.default_rng(0), observation)).all()


def test_nothing_that_a_policy_brings_along_is_run(bundle, policy, tmp_path):
    """Stable-Baselines3 would run what is pickled in `data`."""
    hostile = rewritten(policy, tmp_path / "hostile.zip", data=b'{"policy_class": {":serialized:": "gASVAAAA"}}')
    assert mimoc.load_policy(hostile)(infant(bundle))


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        (
            {"senses": {"vestibular": {}}},
            "it did not observe 'vestibular'; it observed 'proprioception', which there is",
        ),
        ({"senses": {"proprioception": {"include": ["velocity"]}}}, r"'proprioception' had the shape \(295\), here it"),
        ({"task": {"kind": "free"}}, "it commanded 8 actuators, here are 44"),
        ({"task": {"kind": "reach", "hand": "left"}}, "number 0 of the action was act:right_shoulder_horizontal, here"),
        ({"actuation": {"model": "muscle"}}, "'proprioception' had the shape"),
    ],
)
def test_the_policy_of_another_infant_is_refused_and_what_differs_is_named(built, policy, keys, said):
    with pytest.raises(PolicyError, match=f"'reaching' was trained otherwise: .*{said}"):
        mimoc.load_policy(policy)(infant(built(**keys)))


def test_a_policy_serves_infants_of_other_ages(built, policy):
    assert mimoc.load_policy(policy)(infant(built(age_months=9)))


def test_no_file_is_no_policy(tmp_path):
    with pytest.raises(PolicyError, match="there is no such file"):
        mimoc.load_policy(tmp_path / "policy.zip")


@pytest.mark.parametrize("content", [b"", b"junk", b"PK\x05\x06" + bytes(18)])
def test_what_is_no_policy_is_refused(tmp_path, content):
    (tmp_path / "policy.zip").write_bytes(content)
    with pytest.raises(PolicyError, match="this is not a policy that mimoc trained"):
        mimoc.load_policy(tmp_path / "policy.zip")


@pytest.mark.parametrize("member", ["mimoc.json", "scale.npz", "policy.pth"])
@pytest.mark.parametrize("content", [None, b"{}", b"junk"])
def test_a_damaged_policy_is_refused(policy, tmp_path, member, content):
    with pytest.raises(PolicyError, match="this is not a policy that mimoc trained, or it is damaged"):
        mimoc.load_policy(rewritten(policy, tmp_path / "policy.zip", **{member: content}))


def test_a_policy_can_be_moved(bundle, policy, tmp_path):
    shutil.copy(policy, tmp_path / "mine.zip")
    assert mimoc.load_policy(tmp_path / "mine.zip")(infant(bundle))
    assert os.listdir(tmp_path) == ["mine.zip"]
