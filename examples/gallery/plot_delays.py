"""
Late senses
===========

The angle of an elbow, and what the infant observes of it with a proprioceptive delay of 100 ms.
"""

import matplotlib.pyplot as plt
import numpy as np

import mimoc

spec = mimoc.InfantSpec(
    mimoc=1,
    name="delayed",
    age_months=9,
    senses={"proprioception": {"include": []}},
    delays={"proprioception_ms": 100},
    scene={"pose": "sitting", "held": ["chest"]},
)
env = mimoc.make(spec)
observation, _ = env.reset(seed=0)
infant = env.unwrapped
elbow = next(i for i, name in enumerate(infant.layout("proprioception")) if "left_elbow" in name)
command = next(i for i, each in enumerate(infant.manifest.actuation.actuators) if "left_elbow" in each.name)

true, observed = [], []
for step in range(150):
    action = np.zeros(env.action_space.shape, np.float32)
    action[command] = np.sin(2 * np.pi * step / 50)
    observation, *_ = env.step(action)
    true.append(infant.data.joint("robot:left_elbow").qpos[0])
    observed.append(observation["proprioception"][elbow])

time_s = np.arange(150) * 0.01
plt.plot(time_s, np.degrees(true), label="angle")
plt.plot(time_s, np.degrees(observed), label="observed")
plt.xlabel("time [s]")
plt.ylabel("left elbow [degrees]")
plt.legend()
plt.show()
