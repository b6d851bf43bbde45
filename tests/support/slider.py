"""Two bodies that slide, a trunk and a leg, each with a motor whose control is its command: a model for delays."""

import mujoco
import numpy as np

from mimoc.runtime.actuation import Actuation
from mimoc.runtime.term import Field

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


SLIDERS = np.arange(2)
MOTORS = Actuation(  # Every command is its control.
    SLIDERS,
    np.full(2, -1e6),
    np.full(2, 1e6),
    np.tile([-1e6, 1e6], (2, 1)),
    Field("ctrl", SLIDERS),
    Field("ctrl", SLIDERS),
)
