"""Where the pages have what the eyes see, on phones, which are turned, and on screens."""

from itertools import combinations
from pathlib import Path
from subprocess import run

import numpy as np
import pytest
from support.pages import wait_for

import mimoc
from mimoc.viewer.live import LiveView

PHONES = [(390, 844), (740, 360), (360, 640), (640, 360), (414, 896)]
WINDOWS = [*PHONES, (1100, 720), (1100, 500)]
GAP_PX = 12  # Around the pictures, as in the lower left corner of a wide window.
BOXES = """(selector) => {
    const shown = [...document.querySelectorAll(selector)].filter((each) => each.checkVisibility());
    const boxes = shown.map((each) => each.getBoundingClientRect());
    return boxes.map(({ left, top, right, bottom }) => [left, top, right, bottom]);
}"""
IS_OPAQUE = """(points) => {
    const { renderer, canvas } = mimoc.stage;
    mimoc.stage.render();
    const [context, ratio, box] = [renderer.getContext(), renderer.getPixelRatio(), canvas.getBoundingClientRect()];
    const pixel = new Uint8Array(4);
    return points.map(([x, y]) => {
        const [column, row] = [ratio * (x - box.left), ratio * (box.bottom - y)].map(Math.floor);
        context.readPixels(column, row, 1, 1, context.RGBA, context.UNSIGNED_BYTE, pixel);
        return pixel[3] === 255;
    });
}"""
"""What an eye sees hides the page behind the canvas, and the space around it does not."""


@pytest.fixture(scope="module", params=["infant", "recording"])
def seeing(request, open_page, written, recorded):
    """Return a page that shows what the eyes see; it is made small and large."""
    page = open_page({"infant": written, "recording": recorded}[request.param])
    page.get_by_label("What the eyes see").check()
    return page


def resize(page, width, height):
    page.set_viewport_size({"width": width, "height": height})
    page.evaluate("window.scrollTo(0, 0)")
    wait_for(page, "mimoc.stage.camera.aspect === mimoc.stage.canvas.clientWidth / mimoc.stage.canvas.clientHeight")


def overlap(one, other):
    return all(max(one[axis], other[axis]) < min(one[axis + 2], other[axis + 2]) for axis in (0, 1))


@pytest.mark.parametrize(("width", "height"), WINDOWS)
def test_what_the_eyes_see_is_in_the_lower_left_corner_of_the_stage(width, height, seeing):
    """Left eye first, square, inside the window, and over nothing that is read or pressed."""
    page = seeing
    resize(page, width, height)
    (stage,), eyes = page.evaluate(BOXES, "#stage"), page.evaluate(BOXES, "#seen figure")
    assert page.locator("#seen figcaption").all_inner_texts() == ["Left eye", "Right eye"]
    side_px = eyes[0][2] - eyes[0][0]
    assert 60 < side_px <= 150
    assert side_px < 0.31 * min(stage[2] - stage[0], stage[3] - stage[1])
    for number, eye in enumerate(eyes):
        left, bottom = stage[0] + GAP_PX + number * (side_px + GAP_PX), stage[3] - GAP_PX
        assert eye == pytest.approx([left, bottom - side_px, left + side_px, bottom], abs=0.6)
        assert 0 <= eye[0] < eye[2] <= width
        assert 0 <= eye[1] < eye[3] <= height
    others = page.evaluate(BOXES, "header *, #hint, #times, button, input, select, #panel")
    assert not any(overlap(eye, other) for eye in eyes for other in others)
    assert not any(overlap(*pair) for pair in combinations(eyes, 2))


@pytest.mark.parametrize(("width", "height"), WINDOWS)
def test_what_an_eye_sees_is_drawn_where_its_name_is(width, height, seeing):
    """Names stayed where they were in the window's former size."""
    page = seeing
    page.evaluate("mimoc.enter('pose')")
    resize(page, width, height)
    within, around = [], []
    for left, top, right, bottom in page.evaluate(BOXES, "#seen figure"):
        within += [(x, y) for x in (left + 2, right - 2) for y in (top + 2, bottom - 2)]
        around += [((left + right) / 2, bottom + GAP_PX / 2), (left - GAP_PX / 2, bottom - 4)]
    assert page.evaluate(IS_OPAQUE, within) == [True] * 8
    assert page.evaluate(IS_OPAQUE, around) == [False] * 4
    page.evaluate("mimoc.enter(mimoc.recording ? 'recording' : 'pose')")


@pytest.mark.parametrize(("width", "height"), PHONES)
def test_the_stage_and_its_times_fit_a_phone(width, height, seeing):
    resize(seeing, width, height)
    (times,) = seeing.evaluate(BOXES, "#times")
    assert times[3] <= height
    assert seeing.evaluate("document.documentElement.scrollWidth") <= width


def test_a_browser_sees_the_infant_move(browser, infant):
    env = mimoc.make(infant).unwrapped
    env.reset(seed=0)
    with LiveView(env, 8137) as live:
        page = browser.new_page()
        page.goto(live.address)
        page.wait_for_selector("canvas")
        bones = [(bone, body) for mesh, bodies in live._skins for bone, body in zip(mesh.bones, bodies, strict=True)]
        before = [tuple(bone.position) for bone, _ in bones]
        for _ in range(20):
            env.step(env.action_space.sample())
            live.show()
        assert [tuple(bone.position) for bone, _ in bones] != before
        assert all(np.allclose(bone.position, env.data.xpos[body], atol=1e-6) for bone, body in bones)
        assert len({body for _, body in bones}) > 10
        frames = {body: tuple(frame.position) for body, frame in live._bodies.items()}
        assert frames == {body: pytest.approx(env.data.xpos[body]) for body in frames}
        assert len(frames) >= 2  # The eyes.
        page.close()


CHECKOUT = Path(__file__).parents[2]


def test_the_program_of_pages_is_built_from_its_source():
    """`make pages` has just built it."""
    done = run(
        ["git", "status", "--porcelain", "mimoc/viewer"], cwd=CHECKOUT, capture_output=True, text=True, check=True
    )
    assert done.stdout == ""
