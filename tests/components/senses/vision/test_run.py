from contextlib import closing

import mujoco
import numpy as np
import pytest
from support import store
from support.full import full_but

import mimoc
from mimoc.base.errors import RenderingError
from mimoc.bundle.model import load_model
from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.eyes import HIDDEN_GROUP
from mimoc.components.senses.vision.foveation import blur, contrast_gain, foveate, source_weights
from mimoc.components.senses.vision.run import average_down, bind, filters, perceive
from mimoc.render import opengl, renderer
from mimoc.render.body_camera import BodyCamera

AGES = (0, 1.5, 4.5, 9, 15, 24)
PICTURE = {"width_px": 48, "height_px": 32}
RAW = {**PICTURE, "acuity": "off"}
GAZE = ("head_swivel", "head_tilt", "head_tilt_side", "eye_horizontal", "eye_vertical", "eye_torsional")
DOWN_RAD = {"head_tilt": 0.6, "left_eye_vertical": -0.5, "right_eye_vertical": -0.5}
"""A gaze at one's own hands and legs, when sitting."""


def seeing(age_months=9, vision=RAW, kind="flat", **keys) -> mimoc.Bundle:
    """Return an infant that sits and sees."""
    scene = {"kind": kind, "pose": "sitting"}
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "senses": {"vision": vision}, "scene": scene}
    return store.built({**spec, **keys})


def posed(bundle, angles_rad=DOWN_RAD):
    """Return the model and the state of an infant in its pose, but for some joints."""
    model = load_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(bundle.manifest.pose).id)
    for name, angle_rad in angles_rad.items():
        data.joint(f"robot:{name}").qpos = angle_rad
    mujoco.mj_forward(model, data)
    return model, data


@pytest.fixture
def open_vision():
    """Return what binds an infant's vision to its model, in a state; it is closed after the test."""
    opened = []

    def open_one(bundle, model, **changes):
        entry = bundle.manifest.senses.vision.model_copy(update=changes)
        opened.append(bind(entry, model, bundle))
        return opened[-1]

    yield open_one
    for vision in opened:
        vision.close()


@pytest.fixture(scope="module")
def infant() -> mimoc.Bundle:
    return seeing()


# What is observed.


def test_an_agent_gets_a_picture_for_each_eye(infant, open_vision):
    model, data = posed(infant)
    vision = open_vision(infant, model)
    sample = vision(data)
    observed = vision.observe(sample)
    assert list(observed) == list(vision.spaces) == ["eye_left", "eye_right"]
    for name, picture in observed.items():
        assert (picture.shape, picture.dtype) == ((32, 48, 3), np.uint8)
        assert picture in vision.spaces[name]
        assert not np.shares_memory(picture, sample)
    assert np.array_equal(np.stack(list(observed.values())), sample)
    assert len(set(vision.layout)) == 2
    assert [model.body(body).name for body in vision.bodies] == ["left_eye", "right_eye"]


@pytest.mark.parametrize(("gone", "left"), [("left_eye", "eye_right"), ("right_eye", "eye_left")])
def test_an_infant_with_one_eye_has_one_picture(gone, left, infant, open_vision):
    """The one that this eye has in an infant with two."""
    bundle = seeing(body={"remove": [gone]})
    model, data = posed(bundle, {})
    one = open_vision(bundle, model).observe(open_vision(bundle, model)(data))
    model, data = posed(infant, {})
    both = open_vision(infant, model).observe(open_vision(infant, model)(data))
    assert list(one) == [left]
    assert np.abs(one[left].astype(int) - both[left]).max() <= 2, "an eye less weighs less, and sits not quite the same"


# What there is to see.


def test_a_sitting_infant_that_looks_down_sees_its_limbs_on_the_floor(infant, open_vision):
    model, data = posed(infant)
    pictures = open_vision(infant, model)(data)
    model.mat_rgba[[*model.geom_matid[model.geom_bodyid > 0], *model.skin_matid], 3] = 0
    limbs = np.abs(pictures.astype(int) - open_vision(infant, model)(data)).max(axis=-1) > 10
    for share in limbs.mean(axis=(1, 2)):
        assert 0.05 < share < 0.9


def test_pictures_are_upright(infant, open_vision):
    """Looking ahead, with all joints at zero, with the bright sky above and the floor below."""
    model = load_model(infant)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    rows = open_vision(infant, model)(data).mean(axis=(0, 2))
    assert rows[0].min() > rows[-1].max() + 10
    assert rows[0, 2] > rows[0, 0]


def test_toys_look_the_same_whatever_is_drawn_of_the_infant():
    """The shapes that toys collide with stay hidden where the infant's solids are drawn."""
    pictures = []
    for skin, shown in ((True, "solids"), (False, "skin")):
        scene = {"kind": "room", "seed": 1, "pose": "sitting", "toys": {"source": "builtin", "count": [3, 6]}}
        bundle = seeing(body={"skin": skin}, scene=scene)
        model, data = posed(bundle, {})
        toys = [toy.body for toy in bundle.manifest.toys]
        with closing(BodyCamera(model, toys, 64, 48, shown=shown)) as camera:
            pictures.append(camera.render(data))
    assert np.array_equal(*pictures)


@pytest.mark.parametrize(("side", "columns"), [("left", slice(0, 24)), ("right", slice(24, 48))])
def test_the_left_foot_is_on_the_left_and_the_right_one_on_the_right(side, columns, infant, open_vision):
    """A foot is where the picture of the eye on its side changes when it is hidden."""
    model, data = posed(infant)
    vision = open_vision(infant, model, body="solids")
    with_foot = vision.observe(vision(data))[f"eye_{side}"].astype(int)
    for name in ("foot", "toes"):
        model.geom_group[model.geom_bodyid == model.body(f"{side}_{name}").id] = HIDDEN_GROUP
    changed = np.abs(with_foot - vision.observe(vision(data))[f"eye_{side}"]).max(axis=-1) > 10
    assert changed[:, columns].sum() == changed.sum() > 20


def test_both_eyes_of_a_symmetric_infant_see_mirror_images(open_vision):
    """Under a light from straight above, with nothing around."""
    bundle = seeing(kind="empty")
    model, data = posed(bundle)
    data.light_xdir[:] = 0, 0, -1
    left, right = open_vision(bundle, model)(data).astype(int)
    assert left.std() > 20
    assert np.abs(left - right[:, ::-1]).mean() < 1.5
    assert np.abs(left - right).mean() > 5


@pytest.mark.parametrize("age_months", full_but([0, 9], AGES))
def test_own_head_and_eyes_are_never_in_the_way(age_months, open_vision):
    """Wherever neck and eyes turn, their colour makes no difference; it would, if they were drawn."""
    bundle = seeing(age_months)
    model, _ = posed(bundle)
    vision, naive = open_vision(bundle, model), open_vision(bundle, model, unseen=())
    own = np.isin(model.geom_bodyid, [model.body(name).id for name in ("head", "left_eye", "right_eye")])
    own_skins = [index for index in range(model.nskin) if model.skin(index).name in ("head", "hair")]
    model.geom_matid[own] = model.skin_matid[own_skins] = -1
    names = [name for name in GAZE if name.startswith("head")]
    names += [f"{side}_{name}" for name in GAZE if name.startswith("eye") for side in ("left", "right")]
    rng, in_the_way = np.random.default_rng(0), 0
    for _ in range(10):
        _, data = posed(bundle, {name: rng.uniform(*model.joint(f"robot:{name}").range) for name in names})
        pictures = []
        for colour in ((1, 0, 1, 1), (0, 1, 0, 1)):
            model.geom_rgba[own] = model.skin_rgba[own_skins] = colour
            pictures.append((vision(data), naive(data)))
        assert np.array_equal(pictures[0][0], pictures[1][0])
        in_the_way += not np.array_equal(pictures[0][1], pictures[1][1])
    assert in_the_way


def test_the_eyes_of_every_age_are_as_far_apart_as_its_head_is_wide(infants):
    """To a hundredth, level, looking ahead; pupils of newborns are 3.5 cm apart, of two-year-olds near 5 cm."""
    apart_m, widths_m = [], []
    for grown in infants:
        eyes = [grown.data.camera(f"eye_{side}") for side in ("left", "right")]
        assert eyes[0].xpos * (1, -1, 1) == pytest.approx(eyes[1].xpos, abs=1e-9)
        for camera in eyes:
            right, up, back = camera.xmat.reshape(3, 3).T
            assert np.allclose([right, up, back], [(0, -1, 0), (0, 0, 1), (-1, 0, 0)], atol=1e-6)
        apart_m.append(eyes[0].xpos[1] - eyes[1].xpos[1])
        widths_m.append(2 * grown.model.geom("head").size[1])
    assert np.divide(apart_m, widths_m) == pytest.approx(0.365, rel=0.01)
    assert 0.03 < apart_m[0] < apart_m[-1] < 0.06


# What the eyes make of it.


def test_sharp_eyes_see_what_is_drawn_bit_by_bit(infant, open_vision):
    model, data = posed(infant)
    vision = open_vision(infant, model)
    assert vision.filters == ()
    assert np.array_equal(vision(data), vision.eyes(data))


def test_blur_comes_before_foveation_and_rounding_last(open_vision):
    bundle = seeing(2, {**PICTURE, "foveation": 5})
    entry = bundle.manifest.senses.vision
    model, data = posed(bundle)
    vision = open_vision(bundle, model)
    gain = contrast_gain(48, 32, 60.0, entry.acuity_cpd)
    blurred = blur(vision.eyes(data).astype(np.float32), gain)
    seen = foveate(blurred, source_weights(48, 32, 5.0, "corner"))
    assert np.array_equal(vision(data), np.rint(seen.clip(0, 255)))
    assert not np.array_equal(vision(data), vision.eyes(data))


def test_pictures_are_clipped_and_rounded_not_cut_off():
    drawn = np.array([[0, 10, 255]], np.uint8)
    shifted = [perceive(drawn, [lambda pictures, by=by: pictures + np.float32(by)]) for by in (-0.6, 0.4, 0.6)]
    assert [list(row[0]) for row in shifted] == [[0, 9, 254], [0, 10, 255], [1, 11, 255]]
    assert {row.dtype for row in shifted} == {np.dtype(np.uint8)}


@pytest.mark.parametrize("times", [2, 3, 8])
def test_supersampling_averages_a_larger_picture(times, infant, open_vision):
    """Of the same view: each pixel is the mean of those that it covers."""
    model, data = posed(infant)
    averaged = open_vision(infant, model, supersample=times)(data)
    larger = open_vision(infant, model, width_px=48 * times, height_px=32 * times)(data)
    blocks = larger.reshape(2, 32, times, 48, times, 3).mean(axis=(2, 4))
    assert np.abs(averaged - blocks).max() <= 0.5 + 1e-3


def test_supersampling_blurs_by_the_degree_at_any_size():
    """An even wave that only the larger picture can hold is gone, and one that both hold is left as it is in both."""
    entry = VisionEntry(
        cameras=("eye_left",), **PICTURE, supersample=4, acuity_cpd=0.7, foveation=0, foveation_radius="border",
        unseen=(),
    )  # fmt: skip
    (blur_large, average), (blur_small,) = (
        filters(entry.model_copy(update={"supersample": times}), 60.0) for times in (4, 1)
    )
    columns = np.arange(4 * 48) + 0.5
    fine, coarse = (np.tile(np.cos(np.pi * k * columns / (4 * 48)), (4 * 32, 1))[..., None] for k in (150, 12))
    assert np.abs(average(blur_large(fine.astype(np.float32)))).max() < 1e-3
    coarse = coarse.astype(np.float32)
    assert average(blur_large(coarse)) == pytest.approx(blur_small(average_down(coarse, 4)), abs=1e-3)


# Several infants, and none that can see.


def test_without_opengl_an_infant_that_sees_cannot_be_made_and_others_can(infant, bundle, monkeypatch):
    def broken(backend, width, height):
        raise OSError(f"no {backend}")

    monkeypatch.setattr(opengl, "_open", broken)
    monkeypatch.setattr(renderer, "open_context", opengl.open_context)  # Not one that was open before.
    with pytest.raises(RenderingError, match="OpenGL does not start here") as refusal:
        mimoc.make(infant)
    assert len(str(refusal.value).splitlines()) == 1
    with closing(mimoc.make(mimoc.build(mimoc.InfantSpec(mimoc=1, name="blind", age_months=9)))) as env:
        env.reset(seed=0)
