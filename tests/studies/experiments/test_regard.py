"""Regard of a mobile and of hands: what counts as seen, and what is left of contrast."""

from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

import mimoc
from mimoc.runtime.env import InfantEnv
from mimoc.studies.experiments.regard import (
    MOBILE,
    ON_S,
    Pictures,
    Points,
    Sight,
    contrasts_of,
    gaze_onset_s,
    hand_regard,
    lying,
)

MOBILE_YAML = Path(__file__).parents[3] / "configs" / "mobile.yaml"
SMALL_PX = 48


@pytest.fixture(scope="module")
def opened():
    """Return what gives an infant at its start, and its sight, by age."""
    opened = {}

    def give(age_months: float) -> tuple[InfantEnv, Sight, float]:
        if age_months not in opened:
            env, vision = InfantEnv(lying(age_months)), lying(age_months, SMALL_PX).manifest.senses.vision
            opened[age_months] = env, Sight(env, vision), vision.noticed_deg
        opened[age_months][0].reset(seed=0)
        return opened[age_months]

    yield give
    for env, *_ in opened.values():
        env.close()


def hold(env: InfantEnv, geoms: np.ndarray, ahead_m: float, aside_m: float = 0.0) -> None:
    """Bring geoms before the eyes, the first of them to a distance along the line of sight, as they are oriented."""
    data, cameras = env.data, [env.model.camera(eye.camera).id for eye in env.manifest.anatomy.eyes]
    frame = data.cam_xmat[cameras[0]].reshape(3, 3)
    place_m = np.mean(data.cam_xpos[cameras], axis=0) - ahead_m * frame[:, 2] + aside_m * frame[:, 0]
    data.geom_xpos[geoms] += place_m - data.geom_xpos[geoms[0]]


def regard(env: InfantEnv, sight: Sight, noticed_deg: float) -> dict[str, bool]:
    return hand_regard([sight.points(sight.thing("left_hand"))], noticed_deg)


def test_the_mobile_is_that_of_the_config():
    (mobile,) = mimoc.load_spec(MOBILE_YAML).scene.objects
    scene = {"objects": [MOBILE]}
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 0, "scene": scene})
    assert spec.scene.objects == (mobile,)


def test_a_hand_held_before_the_eyes_is_regarded_and_one_at_the_side_is_not(opened):
    env, sight, noticed_deg = opened(1)
    hand = sight.thing("left_hand").geoms
    hold(env, hand, 0.25)
    assert regard(env, sight, noticed_deg) == {"hand_noticed": True, "hand_regarded": True, "hand_near": True}
    hold(env, hand, 0.25, aside_m=0.4)
    assert not any(regard(env, sight, noticed_deg).values())
    hold(env, hand, -0.25)
    assert not any(regard(env, sight, noticed_deg).values())


def test_a_hand_behind_the_chest_is_not_regarded(opened):
    env, sight, noticed_deg = opened(1)
    hold(env, sight.thing("left_hand").geoms, 0.25)
    chest = np.flatnonzero(env.model.geom_bodyid == env.model.body("chest").id)
    hold(env, chest, 0.14)
    assert not any(regard(env, sight, noticed_deg).values())


def test_a_far_hand_is_in_focus_at_six_months_and_not_at_one(opened):
    """Newborns' eyes are focused on 25 cm."""
    regarded = {}
    for age_months in (1, 6):
        env, sight, noticed_deg = opened(age_months)
        hold(env, sight.thing("left_hand").geoms, 0.6)
        regarded[age_months] = regard(env, sight, noticed_deg)
    assert regarded[1] == {"hand_noticed": True, "hand_regarded": False, "hand_near": True}
    assert all(regarded[6].values())


def test_gaze_is_the_angle_of_the_eye_that_looks_farther_away(opened):
    """From the middle between eyes, a place straight ahead is as far from both lines of sight."""
    env, sight, _ = opened(1)
    eyes = [env.data.camera(eye.camera) for eye in env.manifest.anatomy.eyes]
    ahead = -eyes[0].xmat.reshape(3, 3)[:, 2]
    half_m = np.linalg.norm(eyes[0].xpos - eyes[1].xpos) / 2
    place_m = (eyes[0].xpos + eyes[1].xpos) / 2 + 0.3 * ahead
    assert sight.gaze_deg(place_m) == pytest.approx(np.degrees(np.arctan(half_m / 0.3)), abs=0.1)
    assert sight.gaze_deg(eyes[0].xpos + 0.3 * ahead) == pytest.approx(np.degrees(np.arctan(2 * half_m / 0.3)), abs=0.1)


@given(
    points=st.lists(st.tuples(st.floats(0, 180), st.booleans()), max_size=5),
    near_deg=st.floats(0, 180),
    more_deg=st.floats(0, 90),
)
def test_what_is_in_focus_is_noticed_and_a_larger_field_holds_what_a_smaller_one_does(points, near_deg, more_deg):
    angles_deg, is_sharp = (np.array([row[index] for row in points]) for index in (0, 1))
    seen = Points(angles_deg.astype(float), np.ones(len(points)), is_sharp.astype(bool))
    for sharp in (False, True):
        assert seen.within(near_deg, sharp=sharp) <= seen.within(near_deg + more_deg, sharp=sharp)
    assert seen.within(near_deg, sharp=True) <= seen.within(near_deg)


def test_gaze_is_on_something_when_it_stays():
    step_s = ON_S / 4
    is_on = np.array([True, True, True, False, True, True, True, True, True])
    assert gaze_onset_s(is_on, step_s) == pytest.approx(5 * step_s)
    assert gaze_onset_s(is_on[:7], step_s) is None
    assert gaze_onset_s(is_on[:2], step_s) is None


def test_contrast_is_that_of_what_is_drawn_over_the_rest():
    without = np.full((1, 4, 4), 100.0)
    drawn, observed = without.copy(), without.copy()
    drawn[0, :2, :2], observed[0, :2, :2] = 50.0, 80.0
    assert contrasts_of(drawn, without, observed, without) == pytest.approx((0.5, 0.2))
    assert contrasts_of(without, without, observed, without) == (0.0, 0.0)


def test_older_infants_observe_more_of_the_mobile_and_nothing_stays_hidden():
    kept = []
    for age_months in (0, 6):
        with closing(Pictures(lying(age_months, SMALL_PX))) as pictures:
            before = pictures.drawn().copy()
            drawn, observed = pictures.contrasts()
            assert np.array_equal(pictures.drawn(), before)
            assert pictures.contrasts() == (drawn, observed)
            kept.append(observed / drawn)
    assert 0 < kept[0] < 0.6 < kept[1] < 1.1
