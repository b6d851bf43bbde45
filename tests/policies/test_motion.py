"""The policy that follows a motion: it does so within the infant's strength, and its runs come out again."""

import numpy as np
import pytest
from support.motions import moved
from support.store import built

import mimoc
from mimoc.base.errors import ControlError, MimocError, UnknownNameError
from mimoc.policies.motion import MotionPolicy, bind
from mimoc.policies.rollout import Run
from mimoc.recording.recorder import Recording

SPEC = {"mimoc": 1, "name": "kim", "age_months": 3, "scene": {"kind": "flat", "pose": "supine"}}


def infant(model: str) -> mimoc.Bundle:
    return built({**SPEC, "senses": {"proprioception": {}}, "actuation": {"model": model}})


@pytest.mark.parametrize("model", ["torque", "muscle"])
@pytest.mark.parametrize("root", ["free", "assisted"])
def test_a_motion_of_its_own_body_is_followed(model, root):
    env = mimoc.InfantEnv(infant(model))
    policy = MotionPolicy(env, moved(infant(model), 1.0), root)
    run = Run(env, lambda env: policy, seed=0)
    for _ in range(policy.whole_steps):
        run.step()
    metrics = run.summary().metrics
    assert metrics["error_deg"] < 10
    assert metrics["drift_m"] < 0.01
    assert metrics["wrench_force_median_n"] == pytest.approx(0, abs=1)  # The ground can carry what it carried.
    assert ("assisted_force_median_n" in metrics) == (root == "assisted")
    assert len(policy.followed.rows()) == len(policy.followed.body.joints.names)


@pytest.mark.parametrize("root", ["free", "assisted"])
def test_a_motion_is_followed_as_well_under_the_delays_of_the_age(root):
    """What is on its way to each joint is foreseen; without that, joints are twice as far off."""
    errors_deg = []
    for preset in ("none", "physiological"):
        bundle = built({**SPEC, "senses": {"proprioception": {}}, "delays": {"preset": preset}})
        env = mimoc.InfantEnv(bundle)
        policy = MotionPolicy(env, moved(infant("torque"), 1.0), root)
        run = Run(env, lambda _, policy=policy: policy, seed=0)
        for _ in range(policy.whole_steps):
            run.step()
        errors_deg.append(run.summary().metrics["error_deg"])
    assert errors_deg[1] < 1.2 * errors_deg[0]


@pytest.mark.parametrize("root", ["free", "assisted"])
def test_a_recorded_run_comes_out_again(root, tmp_path):
    env = mimoc.InfantEnv(infant("muscle"))
    policy = MotionPolicy(env, moved(infant("muscle"), 0.4), root)
    with Recording([env], tmp_path / "run"):
        run = Run(env, lambda env: policy, seed=0)
        for _ in range(policy.whole_steps):
            run.step()
    assert [replayed.difference for replayed in mimoc.replay_recording(tmp_path / "run")] == [None]


def test_what_it_cannot_do_is_one_line(tmp_path):
    motion = moved(infant("torque"), 0.1)
    with pytest.raises(ControlError, match="does not accept"):
        MotionPolicy(mimoc.InfantEnv(infant("position")), motion)
    env = mimoc.InfantEnv(infant("torque"))
    with pytest.raises(UnknownNameError):
        MotionPolicy(env, motion, "hanging")  # pyright: ignore[reportArgumentType]
    with pytest.raises(MimocError, match=r"motion\.npz: the file does not exist"):
        bind(env, str(tmp_path))


def test_the_infant_starts_where_the_motion_does():
    env = mimoc.InfantEnv(infant("torque"))
    motion = moved(infant("torque"), 0.2)
    policy = MotionPolicy(env, motion)
    observation, _ = env.reset(seed=0)
    policy(np.random.default_rng(0), observation)
    assert np.allclose(env.data.qpos[7:], motion.qpos[0, 7:])


def test_each_joint_follows_what_is_wanted_when_its_own_command_acts():
    """Commands take 25 ms to arms, 35 to legs, besides the control step of 10; a wrench at the root only that."""
    late = built({**SPEC, "senses": {"proprioception": {}}, "delays": {"preset": "physiological"}})
    env, policy = mimoc.InfantEnv(late), MotionPolicy(mimoc.InfantEnv(late), motion := moved(late, 0.4))
    observation, _ = env.reset(seed=0)
    policy(np.random.default_rng(0), observation)
    wanted = policy._at(policy._coming, 5)
    for joint, lead_s in (("left_elbow", 0.035), ("left_knee", 0.045)):
        column = motion.joints.index(f"robot:{joint}") + 6
        expected_rad = motion.at(np.array([0.05 + lead_s])).qpos[0, column]
        assert wanted.qpos[env.model.joint(f"robot:{joint}").qposadr[0]] == pytest.approx(expected_rad, abs=1e-12)
    assert wanted.qpos[:7] == pytest.approx(motion.at(np.array([0.06])).qpos[0, :7], abs=1e-12)
