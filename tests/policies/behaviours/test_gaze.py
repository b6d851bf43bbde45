"""Gaze by age: saccades and their latencies, and what infants make of their own pictures."""

from contextlib import closing
from typing import Any

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import PolicyError, UnknownNameError
from mimoc.policies.behaviours import oculomotor as law
from mimoc.policies.behaviours.seen import Retina, contrast_of, face_of, motion_of
from mimoc.policies.named import policy_of
from mimoc.policies.rollout import Run

DELAYS = {"preset": "physiological", "processing": "age"}
EYES = {"width_px": 32, "height_px": 32}


def spec(age_months, **keys) -> mimoc.InfantSpec:
    data: Any = {"mimoc": 1, "name": "kim", "age_months": age_months, "delays": DELAYS}
    data |= {"senses": {"vestibular": {}}, "scene": {"pose": "supine", "held": ["hip", "head"]}}
    return mimoc.InfantSpec.model_validate({**data, **keys})


def look_of(run) -> Any:
    return run.policies[""]._ensemble.behaviours[-1]


def eye_speeds_deg_s(age_months, left_deg, seconds):
    """Return the speed of the left eye after each control step of a look to the side."""
    with closing(mimoc.InfantEnv(mimoc.build(spec(age_months)))) as env:
        env.reset(seed=0)
        cameras = [env.model.camera(f"eye_{side}").id for side in ("left", "right")]
        axes, left = env.data.body("head").xmat.reshape(3, 3), np.radians(left_deg)
        place_m = env.data.cam_xpos[cameras].mean(axis=0) + axes @ [np.cos(left), np.sin(left), 0.0]
        run = Run(env, "look_at({:.4f}, {:.4f}, {:.4f})".format(*place_m), seed=0)
        speeds = list[float]()
        for _ in range(round(100 * seconds)):
            run.step()
            speeds.append(float(np.degrees(env.data.joint("robot:left_eye_horizontal").qvel[0])))
        return np.array(speeds), look_of(run)._next


def test_a_saccade_of_four_months_is_on_the_main_sequence():
    """Here of 13.5 degrees, nine tenths of the way, in which eyes reach 333 deg/s; standard deviation 70 deg/s."""
    speeds, _ = eye_speeds_deg_s(4, 15.0, 1.0)
    assert speeds.max() == pytest.approx(333, abs=70)


def test_at_one_month_the_gaze_comes_to_30_degrees_in_equal_steps():
    speeds, state = eye_speeds_deg_s(1, 30.0, 2.2)
    is_fast = np.concatenate([[False], speeds > 60.0, [False]])
    begins, ends = np.flatnonzero(np.diff(is_fast.astype(int))).reshape(-1, 2).T
    steps_deg = [0.01 * speeds[begin:end].sum() for begin, end in zip(begins, ends, strict=True)]
    assert len(steps_deg) == state.saccades == 3
    assert np.ptp(steps_deg) < 1.0


@pytest.mark.parametrize(("age_months", "published_ms"), [(4, 595), (8, 442)])
def test_what_turns_up_elsewhere_is_looked_at_after_the_published_time(age_months, published_ms):
    """Conduction in and out included: Gredebäck et al. 2006. With `processing` or without, unless told the truth."""
    for delays in (DELAYS, {"preset": "physiological"}, {"preset": "none"}):
        manifest = mimoc.build(spec(age_months, delays=delays)).manifest
        reaction = law.after_a_turn(law.look_reaction(manifest, is_told=False), manifest)
        whole_s = reaction.conduction_s + reaction.mean_s + dict(manifest.delays)["motor"].ms / 1000
        assert whole_s == pytest.approx(published_ms / 1000, rel=0.01)
    assert law.look_reaction(manifest, is_told=True).mean_s == 0


def test_pursuit_at_nine_weeks_does_not_follow_the_speed_of_the_target():
    nine_weeks = law.Oculomotor.of(mimoc.build(spec(9 / 4.35)).manifest)
    gains = [nine_weeks.pursuit_rad_s(np.radians(speed)) / np.radians(speed) for speed in (3, 6, 12)]
    assert gains == pytest.approx([0.50, 0.25, 0.11], abs=0.04)


def test_a_vergence_of_the_spec_wins():
    young = {"vision": {**EYES, "vergence": "age"}}
    assert law.Oculomotor.of(mimoc.build(spec(1, senses=young)).manifest).vergence == 0
    assert law.Oculomotor.of(mimoc.build(spec(1)).manifest).vergence == law.VERGENCE[1]


def test_who_asks_twice_in_a_control_step_is_told_the_same():
    with closing(mimoc.InfantEnv(mimoc.build(spec(9)))) as env:
        run = Run(env, "look_at(0.3, 0.2, 0.3, truth)", seed=0)
        for _ in range(5):
            run.step()
        asked = [look_of(run).targets(env.data, 0.05) for _ in range(2)]
        assert asked[0].tobytes() == asked[1].tobytes()


@pytest.mark.parametrize("foveation", [0.0, 8.0])
def test_the_middle_of_a_picture_is_straight_ahead_and_up_is_up(foveation):
    directions = Retina(64, 64, 60.0, foveation).directions
    assert directions.mean(axis=(0, 1))[:2] == pytest.approx([0, 0], abs=1e-9)
    assert directions[0, 0, 1] > 0 > directions[0, 0, 0]
    assert directions[16, 16, 2] == pytest.approx(-1, abs=1e-3)


def face(skin) -> np.ndarray:
    """Return cells of a wall with a face in the middle of the left half."""
    cells = np.full((32, 32, 3), 0.6)
    cells[10:22, 4:13] = skin
    for row, column in ((14, 6), (14, 10), (18, 8)):
        cells[row, column] = 0.15
    return cells


@pytest.mark.parametrize("skin", [(0.85, 0.65, 0.5), (0.45, 0.3, 0.2), (0.8, 0.8, 0.8)])
def test_a_face_stands_out_in_colours_and_without(skin):
    row, column = np.unravel_index(face_of(face(np.array(skin))).argmax(), (32, 32))
    assert abs(row - 16) <= 5
    assert abs(column - 8) <= 4


def test_nothing_stands_out_of_a_wall_that_stays_as_it_is():
    wall = np.full((32, 32, 3), 0.4)
    assert [feature.max() for feature in (contrast_of(wall), motion_of(wall, wall), face_of(wall))] == pytest.approx(
        [0, 0, 0]
    )


@pytest.mark.parametrize("policy", ["look_around", "look_at(motion)"])
def test_who_cannot_see_is_told_to_add_vision(policy):
    with closing(mimoc.InfantEnv(mimoc.build(spec(9)))) as env:
        with pytest.raises(PolicyError, match="it has no vision; add senses"):
            policy_of(env, policy)
        with pytest.raises(UnknownNameError):
            policy_of(env, "look_at(movement)")


def seeing(**keys) -> mimoc.InfantSpec:
    scene = {"kind": "flat", "pose": "supine", "held": ["hip"], "caregiver": {"place": "in_front", "distance_cm": 40}}
    return spec(12, senses={"vision": EYES}, scene=scene, **keys)


def test_an_infant_that_looks_around_goes_where_its_pictures_show_something():
    with closing(mimoc.InfantEnv(mimoc.build(seeing()))) as env:
        run = Run(env, "look_around", seed=1)
        for _ in range(45):
            run.step()
        assert look_of(run)._next.saccades > 0
        assert run.summary().metrics["fixations_per_min"] > 0


@pytest.mark.full
@pytest.mark.parametrize("policy", ["look_around", "look_at(face)", "look_at(motion)", "look_at(contrast)"])
def test_many_infants_see_as_each_alone_does(policy):
    bundle = mimoc.build(seeing())
    envs = mimoc.make_vec(bundle, num_envs=2, autoreset_mode="Disabled")
    act, generators = mimoc.policy_vec(policy, envs), [np.random.default_rng(seed) for seed in range(2)]
    observations, _ = envs.reset(seed=0)
    for _ in range(60):
        observations, *_ = envs.step(act(generators, observations))
    for seed, row in enumerate(envs.infants):
        with closing(mimoc.InfantEnv(bundle)) as env:
            alone = Run(env, policy, seed=seed)
            for _ in range(60):
                alone.step()
            assert row.data.qpos == pytest.approx(env.data.qpos, abs=1e-9)
    envs.close()
