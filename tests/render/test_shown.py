"""What is drawn of infants: the skin, or the solids under it."""

from contextlib import closing

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.bundle.model import load_posed
from mimoc.components.senses.vision.eyes import Eyes
from mimoc.render.portrait import lineup, portrait

SIZE = {"width": 96, "height": 72}
OWN = ("head", "left_eye", "right_eye")


@pytest.fixture(scope="module")
def both(built):
    """Return an infant with a skin, and the same without."""
    return tuple(built(body={"skin": skin}, scene={"pose": "sitting"}) for skin in (True, False))


def test_solids_under_a_skin_look_as_they_do_without(both):
    clothed, bare = both
    under, solids, skin = portrait(clothed, **SIZE, shown="solids"), portrait(bare, **SIZE), portrait(clothed, **SIZE)
    assert np.array_equal(under, solids)
    assert (np.abs(skin.astype(int) - solids).max(axis=2) > 20).mean() > 0.02


def test_infants_in_a_row_are_drawn_either_way(both):
    skins, solids = (lineup([both[0]] * 2, **SIZE, shown=shown) for shown in ("skin", "solids"))
    assert not np.array_equal(skins, solids)


EYES = ("eye_left", "eye_right")


def drawn(bundle, shown: str, cameras=EYES) -> np.ndarray:
    model, data = load_posed(bundle, "sitting")
    data.qpos[model.joint("robot:head_tilt").qposadr] = model.joint("robot:head_tilt").range[1]
    mujoco.mj_forward(model, data)
    eyes = Eyes(model, cameras, 48, 48, OWN, shown)
    try:
        return eyes(data).astype(int)
    finally:
        eyes.close()


def test_eyes_see_solids_or_skin(both):
    clothed, bare = both
    assert np.array_equal(drawn(clothed, "solids"), drawn(bare, "solids"))
    assert (np.abs(drawn(clothed, "skin") - drawn(clothed, "solids")).max(axis=-1) > 20).mean() > 0.01


def test_both_eyes_draw_from_one_scene_what_each_draws_alone(both):
    """But for rounding: MuJoCo centres a floor without end by the first of them."""
    together = drawn(both[0], "skin")
    assert not np.array_equal(*together)
    for picture, camera in zip(together, EYES, strict=True):
        assert np.abs(picture - drawn(both[0], "skin", (camera,))[0]).max() <= 2


def test_without_a_choice_infants_see_skins_alone_and_in_batches():
    """Batches and single infants see the same."""
    keys = {"mimoc": 1, "name": "infant", "age_months": 9, "scene": {"pose": "sitting"}}
    sharp = {"width_px": 48, "height_px": 48, "acuity": "off", "fovy_deg": 150}

    def seen(**vision):
        spec = mimoc.InfantSpec.model_validate({**keys, "senses": {"vision": {**sharp, **vision}}})
        with mimoc.make(spec) as env, closing(mimoc.make_vec(spec, num_envs=2, threads=1)) as envs:
            alone, of_many = env.reset(seed=0)[0]["eye_left"], envs.reset(seed=0)[0]["eye_left"][0]
        assert np.array_equal(alone, of_many)
        return alone

    assert np.array_equal(seen(), seen(body="skin"))
    assert not np.array_equal(seen(), seen(body="solids"))
