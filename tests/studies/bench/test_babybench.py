"""BabyBench's behaviours: scores as its own program gives them for the same logs, and what is logged of an infant."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

import mimoc
from mimoc.studies.bench import babybench
from mimoc.studies.bench.babybench import RegardLog, TouchLog, hand_regard_score, self_touch_score

EVALUATED = {
    2: (0.058823529411764705, 0.36993865030674844),
    3: (0.1323529411764706, 0.41255506607929515),
    12: (0.47058823529411764, 0.5068334398976982),
    10_001: (0.5147058823529411, 0.5022195278140182),
    10_005: (0.45588235294117646, 0.4986697175278499),
}
"""What `EvalSelfTouch` and `EvalHandRegard` of `babybench/eval.py` returned for so many of the logs below, run once in
a folder of its own: BabyBench2025_Starter_Kit, commit 645ad73."""
SIDES = "right", "left"


def touch_logs(count: int) -> list[dict]:
    if count > 100:  # Those of the oldest episodes touch what no others do.
        touched = [index % 30 if index > 5 else 100 + index for index in range(count)]
        return [{"right_hand_touches": [geom], "left_hand_touches": []} for geom in touched]
    generator = np.random.default_rng(count)
    return [
        {f"{side}_hand_touches": generator.integers(0, 34, generator.integers(0, 5)).tolist() for side in SIDES}
        for _ in range(count)
    ]


def regard_logs(count: int) -> list[dict]:
    generator, logs = np.random.default_rng(count), []
    for _ in range(count):
        steps = int(generator.integers(1, 1001))
        names = [f"{eye}_eye_{hand}_hand" for hand in SIDES for eye in SIDES]
        logs.append({name: int(generator.integers(0, steps + 2)) for name in names} | {"steps": steps})
    return logs


@pytest.mark.parametrize("count", EVALUATED)
def test_scores_are_those_of_its_own_program(count):
    assert (self_touch_score(touch_logs(count)), hand_regard_score(regard_logs(count))) == EVALUATED[count]


def test_hand_regard_needs_an_episode():
    with pytest.raises(ValueError, match="no episode has any steps"):
        hand_regard_score(regard_logs(1))


@pytest.fixture(scope="module")
def infant():
    """Return an infant with BabyBench's settings of self-touch, at rest."""
    env = mimoc.make(babybench.babybench_spec("self_touch")).unwrapped
    env.reset(seed=0)
    return env


def touching(env, *pairs: tuple[str, str]) -> dict:
    """Return what is logged where some geoms are in contact."""
    geoms = np.array([[env.model.geom(name).id for name in pair] for pair in pairs])
    data = SimpleNamespace(contact=SimpleNamespace(geom=geoms))
    logger = TouchLog(SimpleNamespace(model=env.model, manifest=env.manifest, data=data))
    logger.look()
    return logger.log()


def test_hands_touch_the_own_body_and_fingers_do_not_count(infant):
    pairs = ("head", "left_hand1"), ("right_fingers1", "ub2"), ("right_hand2", "lb"), ("right_hand1", "lb")
    assert touching(infant, *pairs) == {"right_hand_touches": ("lb",), "left_hand_touches": ("head",)}


def test_hands_that_touch_each_other_count_for_the_right_one(infant):
    for pair in (("left_hand1", "right_hand1"), ("right_hand1", "left_hand1")):
        assert touching(infant, pair) == {"right_hand_touches": ("left_hand1",), "left_hand_touches": ()}


def test_what_is_not_the_infant_does_not_count(infant):
    floor = infant.model.geom(int(np.flatnonzero(infant.model.geom_bodyid == 0)[0])).name
    assert touching(infant, (floor, "left_hand1")) == {"right_hand_touches": (), "left_hand_touches": ()}


def test_its_formula_looks_down_where_eyes_look_ahead(infant):
    """A hand straight ahead of the right eye is in sight; one straight below is what BabyBench's code counts."""
    data, eye = infant.data, infant.data.body("right_eye")
    x, z = eye.xmat.reshape(3, 3)[:, 0], eye.xmat.reshape(3, 3)[:, 2]
    assert -data.cam("eye_right").xmat.reshape(3, 3)[:, 2] == pytest.approx(x, abs=1e-6)
    for place_m, in_sight in ((eye.xpos + 0.2 * x, True), (eye.xpos - 0.2 * z, False)):
        data.body("right_hand").xpos[:] = place_m
        data.body("left_hand").xpos[:] = eye.xpos + 0.2 * z
        for of_cameras in (True, False):
            logger = RegardLog(infant, in_sight=of_cameras)
            logger.look()
            assert logger.log()["right_eye_right_hand"] == int(of_cameras == in_sight)
            assert logger.log()["right_eye_left_hand"] == 0


@pytest.mark.parametrize("behaviour", ["self_touch", "hand_regard"])
def test_a_policy_is_scored_by_its_logs(behaviour, invoke, tmp_path, monkeypatch):
    """The same log each time, of fewer steps than BabyBench has."""
    monkeypatch.setattr(babybench, "STEPS", 40)
    file = tmp_path / "scored.json"
    arguments = ("bench", "--babybench", behaviour, "--policy", "random", "-o", file, "--episodes", "2")
    done = invoke(*arguments)
    assert (done.code, done.err) == (0, "")
    content = file.read_bytes()
    data = json.loads(content)
    score = self_touch_score if behaviour == "self_touch" else hand_regard_score
    assert data["score"] == pytest.approx(score(data["logs"]), abs=1e-8)
    assert [log["steps"] for log in data["logs"]] == [0, 40, 40]
    assert (data["in_sight"] is None) == (behaviour == "self_touch")
    assert f"{behaviour}: {score(data['logs']):.4g} in 2 episodes" in done.out
    assert invoke(*arguments).code == 0
    assert file.read_bytes() == content
