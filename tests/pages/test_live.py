"""A running environment in Chromium, served by viser."""

import numpy as np

import mimoc
from mimoc.viewer.live import LiveView


def test_a_browser_sees_the_infant_move(browser, infant):
    env = mimoc.make(infant).unwrapped
    env.reset(seed=0)
    with LiveView(env, 8137) as live:
        page = browser.new_page()
        page.goto(live.address)
        page.wait_for_selector("canvas")
        before = [tuple(frame.position) for frame in live._bodies.values()]
        for _ in range(20):
            env.step(env.action_space.sample())
            live.show()
        bones = [(bone, body) for mesh, bodies in live._skins for bone, body in zip(mesh.bones, bodies, strict=True)]
        assert all(np.allclose(bone.position, env.data.xpos[body], atol=1e-6) for bone, body in bones)
        assert len({body for _, body in bones}) > 10
        after = [tuple(frame.position) for frame in live._bodies.values()]
        assert len(after) == len(before) > 20
        assert after != before
        assert tuple(env.data.body("head").xpos) in {tuple(map(float, position)) for position in after}
        page.close()
