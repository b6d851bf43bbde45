"""Standing up earns the head's height, costs commands, and is what a child can do."""

import numpy as np
import pytest

import mimoc

PULLING_UP = {
    "hip1": (-119, -44, -4),
    "knee": (-168, -27, -8),
    "foot1": (1, 3, 24),
    "hip_bend1": (65, 0, -15),
    "shoulder_horizontal": (43, 42, 35),
    "shoulder_ad_ab": (58, 176, 6),
    "elbow": (-115, -114, -105),
}
"""Angles of joints, in degrees, after `AT_S` seconds: the child pulls itself over its feet, then stretches its legs."""
AT_S = (0.5, 1.15, 1.56)
STIFFNESS_NM_PER_RAD, DAMPING_NMS_PER_RAD = 60.0, 3.0
BODIES = [(18, "mitten", "torque"), (9, "five_finger", "muscle"), (3, "mitten", "position")]


def make(built, age_months: float, hands: str, model: str) -> mimoc.InfantEnv:
    task = {"kind": "standup"}
    env = mimoc.InfantEnv(built(age_months=age_months, body={"hands": hands}, actuation={"model": model}, task=task))
    env.reset(seed=0)
    return env


@pytest.fixture(params=BODIES, ids=str)
def env(request, built):
    with make(built, *request.param) as opened:
        yield opened


class Pull:
    """Commands that follow `PULLING_UP`."""

    def __init__(self, env: mimoc.InfantEnv):
        model, self._env = env.model, env
        self._motors = env.actuation.actuators
        joints = model.actuator_trnid[self._motors, 0]
        self._angles, self._speeds = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        self._range = model.jnt_range[joints]
        self._start = env.data.qpos[self._angles].copy()
        names = [model.joint(joint).name.removeprefix("robot:") for joint in joints]
        self._way = [PULLING_UP.get(name.removeprefix("left_").removeprefix("right_")) for name in names]

    def command(self, at_s: float) -> np.ndarray:
        """Return a control for the angles that are to be had at a time."""
        wanted = [
            np.interp(at_s, (0, *AT_S), (start, *np.deg2rad(way))) if way else start
            for start, way in zip(self._start, self._way, strict=True)
        ]
        env, data = self._env, self._env.data
        if env.manifest.actuation.model == "position":
            low, high = self._range.T
            return ((np.array(wanted) - low) / (high - low) * 2 - 1).astype(np.float32)
        torque_nm = STIFFNESS_NM_PER_RAD * (wanted - data.qpos[self._angles])
        torque_nm -= DAMPING_NMS_PER_RAD * data.qvel[self._speeds] + data.qfrc_passive[self._speeds]
        if env.manifest.actuation.model == "torque":
            share = torque_nm / env.model.actuator_gear[self._motors, 0]
        else:
            towards = -env.model.actuator_gear[self._motors, 0]  # A muscle pulls, and the positive one turns back.
            share = towards * torque_nm / env.model.actuator_gainprm[self._motors, 2]
        return np.clip(share, env.action_space.low, env.action_space.high).astype(np.float32)


@pytest.mark.parametrize(
    ("age_months", "hands", "model"),
    [
        (18, "mitten", "torque"),
        (18, "mitten", "muscle"),
        (24, "five_finger", "position"),
    ],
)
def test_a_child_can_pull_itself_up(built, age_months, hands, model):
    """It is not standing at first, and then stands for a second; both hands are at the rail all the time."""
    with make(built, age_months, hands, model) as env:
        pull, standing = Pull(env), []
        welds = [env.model.equality(weld.equality).id for weld in env.manifest.constraints.welds]
        for step in range(400):
            *_, terminated, _, info = env.step(pull.command(0.01 * step))
            standing.append(info["is_success"])
            assert not terminated
            off_m = env.data.efc_pos[np.isin(env.data.efc_id, welds) & (env.data.efc_type == 0)]
            assert np.abs(off_m).max() < 0.01
        assert not any(standing[:50])
        assert sum(standing) > 100


def test_the_reward_is_the_height_of_the_head_less_what_is_commanded(env):
    action = env.action_space.sample()
    _, reward, terminated, _, info = env.step(action)
    height_m = env.data.body("head").xpos[2] - env.manifest.task.base_m
    effort = 0.01 * float((action.astype(float) ** 2).sum())
    assert info["reward_terms"] == {"height": pytest.approx(height_m), "effort": pytest.approx(-effort)}
    assert reward == pytest.approx(height_m - effort)
    assert not terminated
    assert not info["is_success"]


def test_an_infant_that_sits_earns_a_little(env):
    at_rest = np.clip(np.zeros(env.action_space.shape, np.float32), env.action_space.low, env.action_space.high)
    if env.manifest.actuation.model == "position":
        at_rest = env.data.ctrl[env.actuation.actuators].astype(np.float32)
    heights = [env.step(at_rest)[4]["reward_terms"]["height"] for _ in range(5)]
    assert 0 < min(heights) < max(heights) < 0.2


def test_hands_stay_at_the_rail_whatever_is_commanded(built):
    """And fingers closed, whatever drives them."""
    rng = np.random.default_rng(0)
    oldest = ((24, "mitten", model) for model in ("torque", "muscle", "position"))
    for age_months, hands, model in ((3, "five_finger", "torque"), *oldest):
        with make(built, age_months, hands, model) as env:
            for _ in range(150):
                env.step(rng.uniform(env.action_space.low, env.action_space.high).astype(np.float32))
                equality = env.data.efc_type == 0
                assert np.abs(env.data.efc_pos[equality]).max() < 0.03
