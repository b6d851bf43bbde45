"""A running environment in Chromium, served by viser."""

import numpy as np
import pytest

import mimoc
from mimoc.viewer.live import LiveView


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
