"""Preferential looking: the card, the decision and its threshold."""

import math
from contextlib import closing
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st

import mimoc
from mimoc.bundle.model import load_model
from mimoc.compiler import building
from mimoc.components.senses.vision.build import acuity_at
from mimoc.runtime.env import InfantEnv
from mimoc.studies.experiments.acuity import PAPER_MONTHS, PROFILE, SHARES_OF_ACUITY, transfers
from mimoc.studies.experiments.looking import NOISE, RIGHT, CardTrial, Eyes, crossing, right_choices
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
from mimoc.studies.experiments.rooms import SPEC, take_inventory

NARROW = {"size_px": 128, "fovy_deg": 58.0}
"""Enough for gratings of one cycle per degree at 38 cm."""


def test_without_a_difference_a_side_is_chosen_by_chance_and_a_threshold_is_a_fixed_difference():
    assert right_choices(np.array([0.1, 0.1])) == pytest.approx(0.5)
    at_threshold = 0.6745 * math.sqrt(2) * NOISE
    assert right_choices(np.array([0.0, at_threshold])) == pytest.approx(RIGHT, abs=1e-3)
    assert right_choices(np.array([0.3, 0.0])) == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("shares", "at"),
    [([0.5, 0.5, 1.0, 1.0], 2 * 2**0.5), ([0.5, 1.0, 0.6, 1.0], 4 * 2 ** (3 / 8)), ([0.8, 0.9, 1, 1], 1)],
)
def test_the_threshold_is_where_choices_become_right_for_good(shares, at):
    assert crossing([1, 2, 4, 8], shares) == pytest.approx(at)


def test_what_is_never_preferred_has_no_threshold():
    assert math.isnan(crossing([1, 2, 4], [0.5, 0.6, 0.5]))


def test_a_card_is_drawn_with_the_contrast_that_is_printed_and_grey_on_the_other_side():
    """Within 15 %, as pixels average over bars; its other side has none."""
    with CardTrial(Eyes(3, 0.38, **NARROW, keys=(("acuity", "off"),)), 0.25) as trial:
        assert trial.frequency_cpd == pytest.approx(5 / math.degrees(0.125 / 0.38))
        for contrast in (0.8, 0.2):
            seen = trial.look(contrast)
            assert seen.drawn[1] == pytest.approx(contrast, rel=0.15)
            assert seen.drawn[0] == pytest.approx(0, abs=1e-9)
            assert seen.observed == pytest.approx(seen.drawn, abs=1e-9)


def test_an_infant_prefers_coarse_bars_and_not_those_that_it_cannot_see():
    """At one month, whose acuity is .66 cycles per degree."""
    choices = []
    for frequency_cpd in (0.3, 1.0):
        with CardTrial(Eyes(1, 0.38, **NARROW), frequency_cpd) as trial:
            choices.append(right_choices(trial.look().observed))
    assert choices[0] > 0.99
    assert choices[1] < 0.7


def test_faint_bars_are_preferred_at_six_months_and_not_at_one():
    choices = []
    for age_months in (1, 6):
        with CardTrial(Eyes(age_months, 0.38, **NARROW, keys=(("contrast", "age"),)), 0.3) as trial:
            choices.append(right_choices(trial.look(0.15).observed))
    assert choices[0] < 0.6
    assert choices[1] > 0.99


@pytest.mark.parametrize("age_months", PAPER_MONTHS)
def test_the_filter_leaves_what_the_law_says(age_months):
    found = list(transfers(age_months, acuity_at(age_months, PROFILE)))
    assert len(found) == len(SHARES_OF_ACUITY)
    for each in found:
        assert each.measured == pytest.approx(each.law, abs=0.002)


def test_gratings_are_about_as_fine_as_asked_for():
    for each, share in zip(transfers(6, 4.0), SHARES_OF_ACUITY, strict=True):
        assert each.frequency_cpd == pytest.approx(share * 4.0, abs=0.005)
        assert each.acuity_cpd == 4.0


def test_nothing_finer_than_acuity_is_seen():
    assert all(each.law == 0 and abs(each.measured) < 0.002 for each in transfers(2, 1.5) if each.frequency_cpd > 1.5)


MOBILE_YAML = Path(__file__).parents[3] / "configs" / "mobile.yaml"
SMALL_PX = 48


@pytest.fixture(scope="module")
def opened():
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


SEED = 7
PLAYROOM = Path(__file__).parents[3] / "configs" / "playroom.yaml"


@pytest.fixture(scope="module")
def builder():
    return building.builder(mimoc.InfantSpec.model_validate(SPEC))


@pytest.fixture(scope="module")
def room(builder):
    return take_inventory(builder, SEED)


@pytest.fixture(scope="module")
def bundle(builder):
    return builder(SEED, check=False)


@pytest.fixture(scope="module")
def started(bundle):
    model = load_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(bundle.manifest.pose).id)
    mujoco.mj_forward(model, data)
    return model, data


def test_the_playroom_is_that_of_the_config():
    spec, config = mimoc.InfantSpec.model_validate(SPEC), mimoc.load_spec(PLAYROOM)
    assert (spec.age_months, spec.body) == (config.age_months, config.body)
    assert spec.scene.model_copy(update={"seed": config.scene.seed}) == config.scene


def test_its_toys_are_those_of_the_bundle(room, bundle):
    listed = [(toy.object, toy.category) for toy in bundle.manifest.toys]
    assert [(toy.name, toy.category) for toy in room.toys] == listed
    for toy, entry in zip(room.toys, bundle.manifest.toys, strict=True):
        assert (toy.size_m, toy.mass_kg) == pytest.approx((entry.size_m, entry.mass_kg))


def test_its_size_and_place_are_those_of_the_model(room, started):
    model, data = started
    assert room.size_m[:2] == pytest.approx(2 * model.geom("floor").size[:2])
    assert room.size_m[2] == pytest.approx(2 * model.geom("wall_front").size[1])
    assert room.place_m == pytest.approx(data.body("hip").xpos[:2], abs=1e-6)


def test_places_are_counted_from_where_the_infant_looks(room, bundle, started):
    """The middle between the shoulders is where `PositionTask` says; ahead is where the hip's x axis points."""
    _, data = started
    ahead = data.body("hip").xmat.reshape(3, 3)[:2, 0]
    ahead = ahead / math.hypot(*ahead)
    left = (-ahead[1], ahead[0])
    for toy, entry in zip(room.toys, bundle.manifest.toys, strict=True):
        offset = data.body(entry.body).xpos[:2] - room.reach.centre_m
        assert (toy.ahead_m, toy.left_m) == pytest.approx((offset @ ahead, offset @ left), abs=1e-5)
        assert toy.within_reach == (toy.distance_m <= room.reach.radius_m)


def test_a_room_has_six_papers_and_some_pictures_and_lamps(room):
    assert len(room.textures) == 6
    assert room.floor.startswith("floor_")
    assert (2 <= room.pictures <= 4, 1 <= room.lamps <= 2) == (True, True)


def test_another_seed_is_another_room(builder, room):
    assert take_inventory(builder, SEED) == room
    assert take_inventory(builder, SEED + 1) != room
