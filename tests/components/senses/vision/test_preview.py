from pathlib import Path

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.bundle.model import load_posed
from mimoc.compiler import building
from mimoc.compiler.mjcf.sensor_sites import UNSEEN
from mimoc.components.senses.vision import VisionEntry, VisionSpec
from mimoc.components.senses.vision.build import acuity_at
from mimoc.components.senses.vision.foveation import blur, contrast_gain
from mimoc.components.senses.vision.preview import (
    BLANK_RANGE,
    DEFAULT_FOVEATION,
    compare_ages,
    is_blank,
    preview,
    read_ages,
)
from mimoc.schema import infant

PLAYROOM = Path(__file__).parents[4] / "configs" / "playroom.yaml"
DRAWN = VisionEntry(
    cameras=("eye_left",),
    width_px=48,
    height_px=48,
    supersample=1,
    acuity_cpd=None,
    foveation=0,
    foveation_radius="border",
    unseen=("head", "left_eye", "right_eye"),
)
BLURRED = DRAWN.model_copy(update={"acuity_cpd": 0.3})


def test_each_sight_shows_the_same_view(bundle):
    """The infant need not have a sense of vision."""
    assert bundle.manifest.senses.vision is None
    ((drawn, again), (blurred,)) = preview(bundle, [[DRAWN, DRAWN], [BLURRED]], "sitting", 50)
    assert drawn.std() > 10
    assert np.array_equal(drawn, again)
    by_hand = blur(drawn.astype(np.float32), contrast_gain(48, 48, 60.0, 0.3))
    assert np.array_equal(blurred, np.rint(by_hand))


def test_it_is_what_the_environment_observes(bundle):
    """Straight ahead, in the pose of the reset."""
    vision = {"width_px": 48, "height_px": 48, "acuity": {"cpd": 0.3}}
    spec = {"mimoc": 1, "name": "infant", "age_months": 9, "scene": {"pose": "sitting"}, "senses": {"vision": vision}}
    env = mimoc.InfantEnv(mimoc.build(mimoc.InfantSpec.model_validate(spec)))
    observed = env.reset(seed=0)[0]["eye_left"]
    env.close()
    assert np.array_equal(preview(bundle, [[BLURRED]], down_deg=0)[0][0], observed)


def test_an_eye_that_looks_down_sees_things_higher_up(bundle):
    """The horizon rises, and is gone at last."""
    shares = []
    for down_deg in (-10, 0, 10, 20, 60):
        ((picture,),) = preview(bundle, [[DRAWN]], "standing", down_deg)
        is_sky = picture[..., 2].astype(int) > picture[..., 0]
        shares.append(is_sky.mean())
    assert shares == sorted(shares, reverse=True)
    assert shares[0] > 0.6
    assert shares[-1] == 0


def test_the_pose_is_that_of_the_bundle_unless_another_is_asked_for(bundle):
    usual, sitting, prone = (preview(bundle, [[DRAWN]], pose)[0][0] for pose in (None, "sitting", "prone"))
    assert np.array_equal(usual, sitting)
    assert not np.array_equal(usual, prone)


def test_unknown_poses_and_eyes_are_refused(bundle):
    with pytest.raises(UnknownNameError, match="'sit' is not a pose; did you mean 'sitting'"):
        preview(bundle, [[DRAWN]], "sit")
    missing = DRAWN.model_copy(update={"cameras": ("eye_middle",)})
    with pytest.raises(UnknownNameError, match="'eye_middle' is not a camera of this infant"):
        preview(bundle, [[missing]])


def share_of_colours(picture, colours):
    """Return how much of the middle of a picture, an eighth of it each way, has the hue of one of some colours."""
    hues, wanted = (
        rows / rows.sum(axis=1, keepdims=True) for rows in (picture[21:27, 21:27].reshape(-1, 3) + 1e-9, colours)
    )
    return (np.abs(hues[:, None] - wanted).max(axis=2) < 0.05).any(axis=1).mean()


def test_an_eye_looks_at_the_toy_that_it_sees_best():
    """The one before it that is largest for its distance; its colours are in the middle, which they were not."""
    bundle = building.builder(infant.load_spec(PLAYROOM))(1, check=False)
    model, data = load_posed(bundle, None)
    eye, found = data.camera("eye_left"), []
    for toy in bundle.manifest.toys:
        offset_m = data.body(toy.body).xipos - eye.xpos
        distance_m = np.linalg.norm(offset_m)
        within_60_deg = -offset_m @ eye.xmat.reshape(3, 3)[:, 2] > 0.5 * distance_m
        found += [(toy.size_m / distance_m, toy.body)] if within_60_deg else []
    _, best = max(found)
    geoms = model.geom_bodyid == model.body(best).id
    colours = model.mat_rgba[model.geom_matid[geoms], :3]
    shares = []
    for down_deg in (None, 0.0):
        ((picture,),) = preview(bundle, [[DRAWN]], None, down_deg, 10.0)
        shares.append(share_of_colours(picture, colours[np.ptp(colours, axis=1) > 0.1]))
    assert shares[0] > 0.3
    assert shares[1] < 0.1


def test_the_narrower_the_field_the_larger_what_is_in_its_middle(bundle):
    wide, narrow = (preview(bundle, [[DRAWN]], "sitting", 40.0, fovy_deg)[0][0] for fovy_deg in (60.0, 30.0))
    own = preview(bundle, [[DRAWN]], "sitting", 40.0)[0][0]
    assert np.array_equal(wide, own)
    half = np.tan(np.radians(15)) / np.tan(np.radians(30)) * 24
    inner = wide[round(24 - half) : round(24 + half), round(24 - half) : round(24 + half)].astype(float)
    assert narrow.mean(axis=(0, 1)) == pytest.approx(inner.mean(axis=(0, 1)), abs=4)


FLAT, CRIB, ROOM = {"kind": "flat"}, {"kind": "crib"}, {"kind": "room", "seed": 3}
TOYS = ROOM | {"toys": {"count": [5, 5]}}


@pytest.mark.parametrize(
    ("scene", "age_months", "pose", "down_deg", "fovy_deg", "blank"),
    [
        pytest.param(FLAT, 6, "supine", None, 18, True, id="sky"),
        pytest.param(FLAT, 0, "supine", None, 60, True, id="wide sky"),
        pytest.param(CRIB, 6, "supine", None, 18, True, id="sky over a crib"),
        pytest.param(FLAT, 18, "sitting", None, 18, True, id="mat"),
        pytest.param(ROOM | {"seed": 0}, 9, "sitting", 60, 10, True, id="carpet"),
        pytest.param(FLAT, 0, "prone", None, 18, True, id="skin, and a splinter of light"),
        pytest.param(CRIB, 6, "standing", 0, 18, False, id="horizon"),
        pytest.param(ROOM, 6, "supine", 0, 18, False, id="ceiling"),
        pytest.param(FLAT, 0, "sitting", 40, 60, False, id="feet"),
        pytest.param(FLAT, 6, "sitting", None, 60, False, id="hand"),
        pytest.param(TOYS, 6, "sitting", None, 18, False, id="toy"),
    ],
)
def test_a_view_is_blank_if_it_shows_one_plain_surface(built, scene, age_months, pose, down_deg, fovy_deg, blank):
    """Looked at, one by one, and far from the limit."""
    entry = DRAWN.model_copy(update={"width_px": 128, "height_px": 128, "supersample": 2})
    [[view]] = preview(built(age_months=age_months, scene=scene), [[entry]], pose, down_deg, fovy_deg)
    assert is_blank(view) == blank
    range_levels = np.subtract(*np.percentile(view, (99.5, 0.5), axis=(0, 1))).max()
    assert max(range_levels / BLANK_RANGE, BLANK_RANGE / max(range_levels, 1)) > 1.25


def test_each_age_is_shown_as_seen_and_foveated_beside_what_is_drawn():
    compared = compare_ages(VisionSpec(), "right", (1, 9), 128)
    acuities_cpd = [acuity_at(1, "tac2"), acuity_at(9, "tac2"), None]
    assert [[entry.acuity_cpd for entry in row] for row in compared.entries] == [acuities_cpd, acuities_cpd]
    assert [[entry.foveation for entry in row] for row in compared.entries] == [[0] * 3, [DEFAULT_FOVEATION] * 3]
    assert (len(compared.rows), len(compared.columns)) == (2, 3)
    for entry in (entry for row in compared.entries for entry in row):
        assert (entry.cameras, entry.width_px, entry.height_px) == (("eye_right",), 128, 128)
        assert entry.unseen == UNSEEN


def test_captions_say_age_and_acuity():
    columns = compare_ages(VisionSpec(), "left", (1, 4.5), 64, profile="mimo_v2").columns
    assert columns == ("1 month: 0.85 cycles/degree", "4.5 months: 4.1 cycles/degree", "not blurred")


def test_profile_and_foveation_are_the_specs_unless_others_are_given():
    vision = VisionSpec(acuity_profile="mayer1995", foveation=2, foveation_radius="edge")
    usual = compare_ages(vision, "left", (6,), 64).entries[1][0]
    assert (usual.acuity_cpd, usual.foveation, usual.foveation_radius) == (pytest.approx(5.65), 2, "edge")
    other = compare_ages(vision, "left", (6,), 64, profile="mimo_v2", foveation=0).entries[1][0]
    assert (other.acuity_cpd, other.foveation) == (pytest.approx(5.64), 0)


@pytest.mark.parametrize(("text", "ages"), [("1,2,4", (1, 2, 4)), ("0", (0,)), (" 1.5 , 36", (1.5, 36))])
def test_ages_are_read(text, ages):
    assert read_ages(text) == ages


@pytest.mark.parametrize("text", ["", "one", "1,,2", "1;2", "-1", "37", "nan", "inf", "1,x"])
def test_what_is_no_list_of_ages_is_refused(text):
    with pytest.raises(MimocError, match="is not a list of ages; give months from 0 to 36"):
        read_ages(text)


def test_unknown_sides_and_profiles_are_refused():
    with pytest.raises(UnknownNameError, match="'up' is not a side; choose from left, right"):
        compare_ages(VisionSpec(), "up", (1,), 64)
    with pytest.raises(UnknownNameError, match="'mimo_v1' is not a profile of acuity; did you mean 'mimo_v2'"):
        compare_ages(VisionSpec(), "left", (1,), 64, profile="mimo_v1")


def test_what_matures_has_a_row_of_its_own():
    compared = compare_ages(VisionSpec(contrast="age", colour="age", field=1, flicker="age"), "left", (1, 12), 64)
    assert compared.rows[-1] == "all that matures"
    young, old, sharp = compared.entries[-1]
    assert (young.sensitivity, old.sensitivity) == pytest.approx((5, 50))
    assert sharp.sensitivity is None
    assert young.noticed_deg == old.noticed_deg == 28
    assert young.acuity_cpd == pytest.approx(acuity_at(1, "tac2"))
    assert len(compare_ages(VisionSpec(flicker="age"), "left", (1,), 64).rows) == 2, "flicker is in no still picture"
