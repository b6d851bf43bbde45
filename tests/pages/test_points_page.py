"""The page of a retargeted recording in Chromium: the recorded points move with the child."""

import numpy as np
import pytest
from support.motions import moved, retargeted

import mimoc
from mimoc.movement.retargeting.folder import write_retargeted
from mimoc.viewer.episode_page import page_of_recording


@pytest.fixture(scope="module")
def filmed(open_page, tmp_path_factory):
    folder = tmp_path_factory.mktemp("filmed")
    spec = {"mimoc": 1, "name": "kim", "age_months": 3, "scene": {"kind": "flat", "pose": "supine"}}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate({**spec, "senses": {"proprioception": {}}}))
    out = write_retargeted(retargeted(bundle, moved(bundle, 0.6)), folder / "kim")
    page = folder / "kim.html"
    page.write_text(page_of_recording(mimoc.read_recording(out))[0], encoding="utf-8")
    return open_page(page), mimoc.read_retargeted(out)


def test_points_are_those_of_the_time_shown(filmed):
    page, result = filmed
    for frame in (0, 7, 20):
        page.evaluate("(seconds) => mimoc.recording.slider.set(seconds)", frame * 0.03)
        circles = page.locator("#points g.recorded circle")
        places = circles.evaluate_all("(all) => all.map((each) => [each.cx.baseVal.value, each.cy.baseVal.value])")
        assert np.allclose(places, result.recording.positions[frame], atol=0.01)


def test_points_can_be_hidden_and_go_with_the_recording(filmed):
    page, _ = filmed
    assert page.locator("#points").is_visible()
    page.get_by_label("Recorded points", exact=True).uncheck()
    assert page.locator("#points").is_hidden()
    page.get_by_label("Recorded points", exact=True).check()
    page.get_by_role("button", name="Explore").click()
    assert page.locator("#points").is_hidden()
