"""A ball of any size and mass: the same model as if it had been compiled so."""

import mujoco
import numpy as np
import pytest

from mimoc.components.tasks.catch.run import ResizableBall
from mimoc.schema.task_base import BallEntry

BALL = BallEntry(body="ball", joint="ball:free", geom="ball")


def compiled(radius_m: float, mass_kg: float) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <compiler boundinertia="1e-13"/>
      <worldbody>
        <geom name="floor" type="plane" size="1 1 1"/>
        <body name="hand" pos="0 0 1">
          <joint name="wrist" axis="1 0 0"/>
          <geom name="palm" type="box" size=".1 .1 .01"/>
        </body>
        <body name="ball" pos="0 0 2">
          <freejoint name="ball:free"/>
          <geom name="ball" type="sphere" size="{radius_m!r}" mass="{mass_kg!r}"/>
        </body>
      </worldbody>
    </mujoco>""")


def numbers(model: mujoco.MjModel) -> dict[str, np.ndarray]:
    found = {name: getattr(model, name) for name in dir(model) if not name.startswith("_")}
    return {name: value for name, value in found.items() if isinstance(value, np.ndarray)}


@pytest.mark.parametrize(("radius_m", "mass_kg"), [(0.005, 0.05), (0.005, 0.5), (0.025, 0.05), (0.025, 0.5)])
def test_a_changed_ball_is_as_if_compiled_so(radius_m, mass_kg):
    model = compiled(0.025, 0.0654)
    ball = ResizableBall(BALL, model)
    ball.change(radius_m, mass_kg)
    wanted = numbers(compiled(radius_m, mass_kg))
    for name, value in numbers(model).items():
        np.testing.assert_allclose(value, wanted[name], rtol=1e-9, atol=1e-15, err_msg=name)


def test_a_changed_ball_rolls_and_falls_as_if_compiled_so():
    places = []
    for model in (compiled(0.02, 0.3), compiled(0.025, 0.0654)):
        ball = ResizableBall(BALL, model)
        ball.change(0.02, 0.3)
        data = mujoco.MjData(model)
        data.qpos[ball.place] = (0.05, 0.02, 1.1)
        mujoco.mj_step(model, data, 600)
        places.append(data.qpos.copy())
    assert places[1] == pytest.approx(places[0], rel=1e-6)
    assert places[0][3] < 0.9  # It has rolled off the palm.
