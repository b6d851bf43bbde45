"""
Motors, muscles and servos
==========================

The elbow of the same infant under the three actuation models, when it is commanded to bend as strongly as it can.
"""

import matplotlib.pyplot as plt
import numpy as np

import mimoc

spec = mimoc.InfantSpec(
    mimoc=1, name="bending", age_months=9, senses={}, scene={"pose": "sitting", "held": ["hip", "chest"]}
)
for model in ("torque", "muscle", "position"):
    env = mimoc.make(spec.with_(actuation={"model": model}))
    env.reset(seed=0)
    names = [each.name for each in env.unwrapped.manifest.actuation.actuators]
    elbow = next(index for index, name in enumerate(names) if "left_elbow" in name)
    action = np.zeros(env.action_space.shape, np.float32)
    action[elbow] = env.action_space.low[elbow] if model != "muscle" else env.action_space.high[elbow]
    angles = []
    for _ in range(80):
        env.step(action)
        angles.append(np.degrees(env.unwrapped.data.joint("robot:left_elbow").qpos[0]))
    plt.plot(np.arange(80) * 0.01, angles, label=f"{model} ({names[elbow]})")
plt.xlabel("time [s]")
plt.ylabel("angle of the left elbow [degrees]")
plt.legend()
plt.show()
