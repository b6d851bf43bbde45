"""Soft light: what pictures show of shadows, of what is bright, and of the floor."""

from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest
from scipy import ndimage

from mimoc.bundle.model import load_model, load_posed
from mimoc.render import body_camera
from mimoc.render.body_camera import BACKGROUND, BodyCamera, backdrop_colours, is_outdoors
from mimoc.render.camera import Shot
from mimoc.render.portrait import Framing, portrait
from mimoc.render.soft_light import (
    DAYLIGHT,
    GOLDEN_RAD,
    MOVING,
    ONCE,
    STILL,
    Exposure,
    Mean,
    disc_points,
    passes,
    pixel_points,
    toned,
)

SIZE = {"width": 300, "height": 300}
CAPSULE = """
<mujoco>
  <asset><material name="matt" specular="0"/></asset>
  <worldbody>
    <geom type="plane" size="30 30 1" rgba=".8 .8 .8 1"/>
    <body name="capsule" pos="0 0 .3">
      <freejoint/><geom type="capsule" material="matt" size=".06 .12" rgba="{colour} 1"/>
    </body>
  </worldbody>
</mujoco>
"""


def drawn(exposure: Exposure, colour: str = ".6 .4 .3", elevation: float = -15.0, size: int = 300) -> np.ndarray:
    model = mujoco.MjModel.from_xml_string(CAPSULE.format(colour=colour))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    camera = BodyCamera(model, ["capsule"], size, size, (160.0, elevation), exposure=exposure, margin=2.0)
    try:
        return camera.render(data)
    finally:
        camera.close()


def specks(picture: np.ndarray) -> int:
    grey = picture.astype(int).sum(axis=2)
    return int((np.abs(grey - ndimage.median_filter(grey, 5)) > 24).sum())


def on_capsule(picture: np.ndarray) -> np.ndarray:
    red, _, blue = picture.astype(int).transpose(2, 0, 1)
    return ndimage.binary_erosion(red - blue > 30, iterations=3)


def test_points_of_a_disc_are_spread_evenly():
    """Each quarter and each half of the area of the disc has its share, and their middle is that of the disc."""
    points = disc_points(60)
    radii = np.linalg.norm(points, axis=1)
    assert radii.max() < 1
    assert (radii < np.sqrt(0.5)).sum() == 30
    quarters = np.unique(np.floor(np.arctan2(*points.T) / (np.pi / 2)), return_counts=True)[1]
    assert quarters.min() > 11
    assert np.abs(points.mean(axis=0)).max() < 0.02
    angles = np.diff(np.unwrap(np.arctan2(points[:, 1], points[:, 0])))
    assert np.cos(angles) == pytest.approx(np.cos(GOLDEN_RAD))


@pytest.mark.parametrize("count", [1, 3, 4, 5, 8])
def test_points_of_a_pixel_share_no_row_and_no_column(count):
    points = pixel_points(count)
    assert np.abs(points).max() < 0.5
    for column in points.T:
        assert np.sort(column) == pytest.approx((np.arange(count) + 0.5) / count - 0.5)


def test_a_mean_is_rounded_and_of_what_counts_alone():
    pictures = [np.full((1, 2, 3), value, np.uint8) for value in (10, 11, 13)]
    mean, part = Mean(), Mean()
    for picture, counts in zip(pictures, ([[True, False]], [[True, False]], [[False, False]]), strict=True):
        mean.add(picture)
        part.add(picture, np.array(counts))
    assert mean.picture().tolist() == [[[11] * 3, [11] * 3]]
    assert part.picture().tolist() == [[[11, 11, 11, 170], [0, 0, 0, 0]]]


def test_what_is_dark_stays_so_and_white_too_and_all_between_is_brighter():
    shares = np.linspace(0, 1, 101)
    lifted = toned(shares)
    assert (lifted[0], lifted[-1]) == (0, 1)
    assert (np.diff(lifted) > 0).all()
    assert (lifted[1:-1] > shares[1:-1]).all()


def test_a_smooth_solid_has_no_speckle():
    """Nor has the floor around it; with hard shadows at the same settings but MuJoCo's range, it had."""
    picture = drawn(STILL)
    inside = on_capsule(picture)
    assert inside.sum() > 2000
    grey = picture.astype(int).sum(axis=2)
    assert np.abs(grey - ndimage.median_filter(grey, 5))[inside].max() < 24
    assert specks(picture[-60:]) <= 8


def edge_width(picture: np.ndarray) -> int:
    """Return over how many pixels brightness rises most at the edge of the shadow on the floor, along any row."""
    grey = picture[-110:].astype(float).mean(axis=2)
    dark = grey.max(axis=1) - grey.min(axis=1)
    steps = np.abs(np.diff(grey[dark > 25], axis=1)).max(axis=1)
    return int(np.median(dark[dark > 25] / steps))


def test_the_edge_of_a_shadow_is_wide():
    """A fifth of a metre below the capsule, that of the sun's disc is 5 cm wide; a hard one is as wide as a pixel."""
    soft, hard = (edge_width(drawn(exposure, elevation=-50.0)) for exposure in (STILL, ONCE))
    assert hard <= 2
    assert soft > 4 * hard


def test_white_keeps_its_shades():
    """Nothing white is burnt out: brightest and darkest differ, and no pixel is at the end of its range."""
    picture = drawn(STILL, colour=".95 .94 .92")
    assert picture.max() < 255
    grey = picture[90:200, 110:190].astype(float).mean(axis=2)
    assert np.ptp(np.percentile(grey, (5, 95))) > 30


def test_no_light_is_brighter_than_white():
    """However a surface is turned, all lights together are hardly more than its colour can show."""
    normals = np.random.default_rng(0).normal(size=(5000, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    lights = [(-beam.towards(0.0), beam.colour) for beam in (DAYLIGHT.sun, *DAYLIGHT.fills)]
    together = sum(np.maximum(normals @ towards, 0)[:, None] * np.array(colour) for towards, colour in lights)
    assert 0.95 < (together + DAYLIGHT.ambient).max() < 1.03


@pytest.mark.parametrize("pose", ["sitting", "standing", "prone"])
def test_there_is_no_horizon(pose, bundle_at):
    """At both edges of a picture, brightness rises slowly from the floor to the background."""
    picture = portrait(bundle_at(9), pose, **SIZE).astype(float).mean(axis=2)
    for edge in (picture[:, :4], picture[:, -4:]):
        column = edge.mean(axis=1)
        assert np.abs(np.diff(column)).max() < 4
        assert np.ptp(column) < 45


def test_what_is_far_away_is_the_background(bundle_at):
    top = portrait(bundle_at(9), "standing", **SIZE, framing=Framing(elevation_deg=5))[:4]
    assert np.abs(top.astype(float) - 255 * toned(np.array(BACKGROUND))).max() < 2


def test_frames_of_the_same_state_are_the_same(bundle_at):
    """The pattern of light does not change from frame to frame, or videos would flicker."""
    first, second = drawn(MOVING), drawn(MOVING)
    assert np.array_equal(first, second)


def test_pictures_change_nothing_of_a_model(bundle_at):
    """Eyes and viewers see the floor, the sky and the lights that they saw."""
    model, data = load_posed(bundle_at(9), "sitting")
    before = {name: np.copy(getattr(model, name)) for name in ("tex_data", "tex_width", "light_dir", "geom_group")}
    camera = BodyCamera(model, ["hip"], 32, 32, static_materials=True)
    camera.render(data)
    camera.close()
    for name, values in before.items():
        assert np.array_equal(getattr(model, name), values), name


def test_textures_that_nothing_wears_make_no_difference(bundle_at, monkeypatch):
    """A portrait leaves them out and enlarges others; what is drawn is the same but for the finest lines."""
    lean = portrait(bundle_at(9), "sitting", **SIZE).astype(int)
    monkeypatch.setattr(body_camera, "lean_textures", lambda *_: [])
    difference = np.abs(portrait(bundle_at(9), "sitting", **SIZE) - lean)
    assert difference.mean() < 0.1
    assert np.percentile(difference, 99.9) < 16


def test_rooms_keep_their_own_light_and_look(built):
    model = load_model(built(scene={"kind": "room", "seed": 2}))
    assert not is_outdoors(model)
    flat = load_model(built(scene={"kind": "flat"}))
    assert is_outdoors(flat)
    sky = flat.tex_adr[flat.texture("sky").id]
    assert backdrop_colours(flat)[sky : sky + 3] / 255 == pytest.approx(BACKGROUND, abs=0.005)


def through_wall(wall_m: float) -> np.ndarray:
    """Return a picture of a capsule from 2 m away in x, of a room whose wall faces it from so far away."""
    wall = f'<geom type="plane" size="30 30 1" pos="{wall_m} 0 0" zaxis="-1 0 0" rgba=".2 .3 .8 1"/>'
    xml = CAPSULE.format(colour=".6 .4 .3").replace("<worldbody>", "<worldbody>" + wall)
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    camera = BodyCamera(model, ["capsule"], 64, 64)
    try:
        return camera.render(data, shot=Shot(np.array([2.0, 0.0, 0.3]), 2.0, (180.0, 0.0), 24.0))
    finally:
        camera.close()


def test_walls_in_front_of_what_is_shown_leave_no_haze():
    """A wall between the camera and the infant shows as little as one behind the camera."""
    assert np.array_equal(through_wall(0.5), through_wall(5.0))


def lit(exposure: Exposure, daylight: Any) -> list[list[tuple[float, ...]]]:
    scene = mujoco.MjvScene(mujoco.MjModel.from_xml_string(CAPSULE.format(colour="1 1 1")), 10)
    scene.camera[0].frustum_near = scene.camera[1].frustum_near = 0.1
    shot = Shot(np.array([1.0, 0.0, 0.5]), 1.0, (180.0, -20.0), 24.0)
    found = []
    for _ in passes(scene, shot, 100, exposure, daylight):
        casting = [light for light in scene.lights[: scene.nlight] if light.castshadow]
        found.append([(*map(float, light.dir), float(light.diffuse[0])) for light in casting])
    return found


def test_all_passes_are_equally_bright_and_have_suns_of_their_own():
    suns = lit(Exposure(4, 3), DAYLIGHT)
    assert [len(pass_) for pass_ in suns] == [3] * 4
    for pass_ in suns:
        assert sum(strength for *_, strength in pass_) == pytest.approx(DAYLIGHT.sun.colour[0], rel=1e-5)
    directions = np.array([sun[:3] for pass_ in suns for sun in pass_])
    assert len(np.unique(directions.round(6), axis=0)) == 12
    middle = directions.mean(axis=0) / np.linalg.norm(directions.mean(axis=0))
    angles_deg = np.degrees(np.arccos(np.clip(directions @ middle, -1, 1)))
    assert 0.6 * DAYLIGHT.sun_radius_deg < angles_deg.max() < 1.1 * DAYLIGHT.sun_radius_deg


def test_light_comes_with_the_camera():
    """A sun behind the camera shines along its view."""
    ahead = replace(DAYLIGHT, sun=replace(DAYLIGHT.sun, azimuth_deg=0.0, elevation_deg=-20.0), sun_radius_deg=0.0)
    (((x, y, z, _),),) = lit(ONCE, ahead)
    assert (x, y, z) == pytest.approx((-np.cos(np.radians(20)), 0, -np.sin(np.radians(20))), abs=1e-6)
