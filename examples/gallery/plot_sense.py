"""
A sense of your own
===================

A sense is an object with a `space` that is called with the simulation's data. This one has 50 ms of delay.
"""

import gymnasium
import matplotlib.pyplot as plt
import numpy as np

import mimoc


class Heights:
    """Heights of both hands above the floor, [m]."""

    space = gymnasium.spaces.Box(0.0, 2.0, (2,), np.float32)
    delay_ms = 50

    def bind(self, model, bundle):
        self.hands = [model.body(f"{side}_hand").id for side in ("left", "right")]

    def __call__(self, data):
        return data.xpos[self.hands, 2]


spec = mimoc.InfantSpec(mimoc=1, name="child", age_months=9, senses={})
env = mimoc.make(spec, senses={"heights": Heights()})
observation, _ = env.reset(seed=0)
env.action_space.seed(1)
heights = [env.step(env.action_space.sample())[0]["heights"] for _ in range(200)]

plt.plot(np.arange(200) * 0.01, heights, label=["left hand", "right hand"])
plt.xlabel("time [s]")
plt.ylabel("height [m]")
plt.legend()
plt.show()
