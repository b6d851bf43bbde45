"""Two bodies that slide, a trunk and a leg, each with a motor whose control is its command: a model for delays."""

from typing import Any

import mujoco
import numpy as np

MODEL = mujoco.MjModel.from_xml_string("""
<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody>
    <body name="trunk"><joint name="x" type="slide"/><geom size="0.1" mass="1"/></body>
    <body name="leg"><joint name="y" type="slide"/><geom size="0.1" mass="1"/></body>
  </worldbody>
  <actuator><motor joint="x"/><motor joint="y"/></actuator>
</mujoco>
""")


class Motors:
    """Every command is its control."""

    actuators = np.arange(2)
    low, high = np.full(2, -1e6), np.full(2, 1e6)

    def __call__(self, action):
        return np.array(action, float)


MOTORS: Any = Motors()
