"""The page of an infant in Chromium: what it shows is what MuJoCo says; `make pages` runs this."""

from io import BytesIO

import mujoco
import numpy as np
import pytest
from PIL import Image
from support.pages import wait_for

from mimoc.bundle.model import load_model
from mimoc.compiler.variants import SpecVariants, spec_of
from mimoc.viewer.growth import own_parts

PLACES = "() => mimoc.body.places.map((place) => place.toArray())"


@pytest.fixture(scope="module")
def variants(infant) -> SpecVariants:
    return SpecVariants(spec_of(infant))


def set_age(page, months: float) -> None:
    page.evaluate(
        """(months) => {
            const slider = document.getElementById("age");
            slider.step = "any";
            slider.value = months;
            slider.dispatchEvent(new Event("input"));
        }""",
        months,
    )


@pytest.mark.parametrize("age_months", [0, 4.7, 9, 24])
def test_bodies_are_where_mujoco_has_them_at_any_age_and_in_any_state(shown, variants, age_months):
    shown.evaluate("mimoc.enter('pose')")
    set_age(shown, age_months)
    variant = variants(float(age_months), 0)
    model, data = variant.model, mujoco.MjData(variant.model)
    own = own_parts(model, variant.bundle.manifest)
    shown.evaluate("mimoc.setPose('sitting')")
    low, high = model.jnt_range[own.joints].T
    state = np.concatenate([[0.1, 0.2, 0.5, 0.6, 0.0, 0.8, 0.0], low + 0.3 * (high - low)])
    data.qpos[own.qpos] = state
    mujoco.mj_kinematics(model, data)
    shown.evaluate("(state) => mimoc.show(Float32Array.from(state))", state.tolist())
    assert np.abs(np.array(shown.evaluate(PLACES)) - data.xpos[own.bodies]).max() < 1e-3


def test_it_stands_on_the_floor_at_every_age(shown):
    shown.evaluate("mimoc.setPose('standing')")
    for age_months in (0, 1.3, 8, 17, 24):
        set_age(shown, age_months)
        assert abs(shown.evaluate("mimoc.body.lowest()")) < 3e-3


def test_the_slider_grows_it_and_the_facts_and_curves_follow(shown):
    heights = []
    for age_months in (0, 12, 24):
        set_age(shown, age_months)
        heights.append(float(shown.locator("#facts").inner_text().split(" · ")[1].split()[0]))
    assert heights == sorted(heights)
    assert heights[-1] - heights[0] > 30
    dots = shown.locator("svg .dot").evaluate_all("(dots) => dots.map((dot) => Number(dot.getAttribute('cx')))")
    assert len(dots) == 3
    assert min(dots) > 250


def test_a_hand_that_is_dragged_follows_within_the_limits_of_its_joints(shown):
    shown.evaluate("mimoc.setPose('sitting'); mimoc.stage.render()")
    found = shown.evaluate(
        """() => {
            const hand = mimoc.body.names.indexOf("left_hand");
            const place = mimoc.body.places[hand].clone().project(mimoc.stage.camera);
            const box = mimoc.stage.canvas.getBoundingClientRect();
            return [box.left + ((place.x + 1) / 2) * box.width, box.top + ((1 - place.y) / 2) * box.height];
        }"""
    )
    before = shown.evaluate(PLACES)
    shown.mouse.move(*found)
    shown.mouse.down()
    shown.mouse.move(found[0] - 40, found[1] - 120, steps=6)
    shown.mouse.up()
    after = shown.evaluate(PLACES)
    hand = shown.evaluate("mimoc.body.names.indexOf('left_hand')")
    assert after[hand][2] - before[hand][2] > 0.03
    assert np.allclose(after[0], before[0], atol=1e-6)
    assert shown.evaluate(
        """() => mimoc.body.jointNames.every((_, joint) => {
            const [low, high] = mimoc.body.limits(joint);
            const angle = mimoc.body.qpos[7 + joint];
            return low - 1e-4 <= angle && angle <= high + 1e-4;
        })"""
    )
    assert shown.locator("#poses [aria-pressed=true]").count() == 0


def test_sliders_of_joints_move_them(shown):
    shown.evaluate("mimoc.setPose('sitting')")
    group = shown.locator("#joints details", has_text="Left arm")
    group.locator("summary").click()
    elbow = group.locator("input[aria-label='Left arm: Elbow']")
    wait_for(shown, "document.querySelector('[aria-label=\"Left arm: Elbow\"]').hasAttribute('aria-valuetext')")
    elbow.focus()
    before = elbow.input_value()
    for _ in range(5):
        shown.keyboard.press("ArrowLeft")
    assert int(elbow.input_value()) == int(before) - 5


def test_every_control_can_be_reached_by_keyboard_and_has_a_name(shown):
    controls = shown.locator("button:visible, input:visible, select:visible, summary:visible, canvas")
    nameless = controls.evaluate_all(
        """(all) => all.filter((each) => !(each.getAttribute("aria-label") || each.textContent.trim()
            || each.closest("label")?.textContent.trim())).map((each) => each.outerHTML)"""
    )
    assert nameless == []
    assert controls.evaluate_all("(all) => all.every((each) => each.tabIndex >= 0)")
    shown.locator("#canvas").focus()
    before = shown.evaluate("mimoc.stage.camera.position.toArray()")
    shown.keyboard.press("ArrowLeft")
    shown.keyboard.press("+")
    assert shown.evaluate("mimoc.stage.camera.position.toArray()") != before


def test_touch_points_and_fields_of_view_can_be_shown(shown):
    shown.get_by_label("Touch points").check()
    shown.get_by_label("What the eyes see").check()
    assert shown.evaluate("mimoc.touch.scene.visible && mimoc.eyes.frusta.every((each) => each.visible)")
    assert shown.locator("#seen figure:visible").count() == 2
    nearest_m = shown.evaluate(
        """() => {
            const points = mimoc.touch.scene.geometry.attributes.position.array;
            const hand = mimoc.body.places[mimoc.body.names.indexOf("left_hand")];
            let least = Infinity;
            for (let i = 0; i < points.length; i += 3) {
                least = Math.min(least, Math.hypot(points[i] - hand.x, points[i + 1] - hand.y, points[i + 2] - hand.z));
            }
            return least;
        }"""
    )
    assert nearest_m < 0.03


def test_the_picture_is_of_an_infant(shown):
    """Not empty: many pixels in the middle are of skin and clothes."""
    shown.evaluate("mimoc.enter('pose'); mimoc.setPose('sitting')")
    box = shown.locator("#canvas").bounding_box()
    picture = np.asarray(Image.open(BytesIO(shown.screenshot(clip=box))).convert("HSV"))
    height, width, _ = picture.shape
    middle = picture[height // 4 : -height // 4, width // 3 : -width // 3, 1]
    assert (middle > 80).mean() > 0.1


def test_it_falls_as_in_mujoco_here(shown, infant):
    """The page's MuJoCo is of another version, so the fall is the same only nearly."""
    shown.evaluate("mimoc.enter('pose'); mimoc.setPose('supine'); mimoc.setAge(9)")
    shown.evaluate("mimoc.enter('physics')")
    wait_for(shown, "mimoc.physics.data")
    shown.evaluate("mimoc.physics.stop(); mimoc.physics.drop(); mimoc.physics.stop()")
    start = shown.evaluate("Array.from(mimoc.physics.data.qpos)")
    shown.evaluate("mimoc.physics.advance(40)")
    fallen = shown.evaluate("Array.from(mimoc.physics.data.qpos)")
    model = load_model(infant)
    data = mujoco.MjData(model)
    data.qpos[:] = start
    mujoco.mj_step(model, data, 40)
    assert start[2] - fallen[2] > 0.1
    assert np.abs(data.qpos - fallen).max() < 5e-3


def test_random_actions_move_it_without_breaking_the_simulation(shown):
    before = shown.evaluate("Array.from(mimoc.physics.data.qpos)")
    shown.evaluate("mimoc.physics.stop(); mimoc.physics.action = 'random'; mimoc.physics.advance(200)")
    assert shown.evaluate("mimoc.physics.data.time") > 0.9
    after = np.array(shown.evaluate("Array.from(mimoc.physics.data.qpos)"))
    assert np.isfinite(after).all()
    assert np.abs(after - before)[7:].max() > 0.1


def test_a_part_that_is_pulled_comes_along(shown):
    shown.evaluate(
        """() => {
            mimoc.physics.drop();
            mimoc.physics.stop();
            mimoc.physics.action = "limp";
            mimoc.physics.advance(200);
            mimoc.physics.show();
            const hand = mimoc.body.names.indexOf("right_hand");
            const target = mimoc.body.places[hand].clone();
            target.z += 0.3;
            mimoc.pull({ number: hand, local: target.clone().setScalar(0), target }, []);
            for (let i = 0; i < 40; i += 1) { mimoc.physics.advance(5); mimoc.physics.show(); }
        }"""
    )
    heights = shown.evaluate("() => mimoc.body.places.map((place) => place.z)")
    assert heights[shown.evaluate("mimoc.body.names.indexOf('right_hand')")] > 0.12
    shown.evaluate("mimoc.pull(null, []); mimoc.enter('pose')")


def test_it_fits_a_small_window(open_page, written):
    page = open_page(written, 360, 640)
    assert page.evaluate("document.documentElement.scrollWidth") <= 360
    assert page.locator("#canvas").bounding_box()["height"] > 250
    assert page.locator("#age").is_visible()
