"""The page of a recording in Chromium."""

import numpy as np
import pytest
from support.motions import moved, retargeted
from support.pages import wait_for

import mimoc
from mimoc.movement.retargeting.folder import write_retargeted
from mimoc.viewer.episode_page import page_of_recording


def seek(page, seconds: float) -> None:
    page.evaluate("(seconds) => mimoc.recording.slider.set(seconds)", seconds)


def test_the_timeline_shows_the_recorded_states(replayed):
    frames = replayed.evaluate("mimoc.recording.seconds.length")
    assert frames == 61
    for frame in (0, 17, 60):
        seek(replayed, frame * 0.01)
        assert replayed.evaluate("mimoc.recording.frame") == frame
        shown, width = replayed.evaluate("Array.from(mimoc.body.qpos)"), replayed.evaluate("mimoc.recording.width")
        kept = replayed.evaluate(
            "(at) => Array.from(mimoc.data.recording.qpos.values.slice(at[0], at[1]))",
            [frame * width, (frame + 1) * width],
        )
        assert np.allclose(shown, kept)


def test_its_face_changes_when_it_changed(replayed):
    found = []
    for seconds in (0.1, 0.5):
        seek(replayed, seconds)
        found.append(replayed.evaluate("mimoc.infant.expression"))
        assert replayed.get_by_label("Expression").input_value() == found[-1]
    assert found == ["neutral", "happy"]


def test_touched_points_have_colours_of_their_own(replayed):
    seek(replayed, 0.6)
    touched = replayed.evaluate("Array.from(mimoc.touch.scene.geometry.attributes.load.array).filter(Boolean).length")
    ends = replayed.evaluate("Array.from(mimoc.data.recording.felt.ends.values.slice(60, 62))")
    assert touched == ends[1] - ends[0] > 0


def test_any_number_can_be_chosen_as_a_curve(replayed):
    figure = replayed.locator("#recording figure").first
    figure.get_by_label("What is shown").select_option("vestibular")
    figure.get_by_label("Which of its numbers").select_option(index=2)
    assert "m/s" in figure.locator("span").inner_text()
    assert figure.locator("svg path").get_attribute("d").count("L") == 60


def test_eyes_show_what_was_seen_then(replayed):
    replayed.get_by_label("What the eyes see").check()
    seek(replayed, 0.3)
    assert replayed.locator("#seen video:visible").count() == 2
    wait_for(replayed, "[...document.querySelectorAll('video')].every((each) => each.readyState >= 2 && !each.seeking)")
    assert replayed.locator("video").evaluate_all("(all) => all.map((each) => each.currentTime)") == pytest.approx(
        [0.305, 0.305]
    )


def test_one_can_leave_the_recording_and_come_back(replayed):
    replayed.get_by_role("button", name="Explore").click()
    replayed.get_by_role("button", name="Standing").click()
    assert replayed.locator("#age").is_visible()
    replayed.get_by_role("button", name="Recording").click()
    assert replayed.evaluate("mimoc.mode") == "recording"
    assert replayed.locator("#time").is_visible()


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
