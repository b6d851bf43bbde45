"""
Reaching by inverse dynamics
============================

A seated infant moves its right hand to a point, looks at it, and keeps its posture otherwise; nothing is learned.
"""

import matplotlib.pyplot as plt
import numpy as np

import mimoc

spec = mimoc.InfantSpec(
    mimoc=1,
    name="seated",
    age_months=9,
    senses={},
    actuation={"locked": ["trunk"]},
    scene={"pose": "sitting", "held": ["hip"]},
)
env = mimoc.make(spec, render_mode="rgb_array", width=320, height=320)
env.reset(seed=0)
infant = env.unwrapped
reach = mimoc.PositionTask("right_hand", target=(0.2, -0.1, 0.3))
look = [mimoc.GazeTask(eye, reach.target) for eye in ("eye_left", "eye_right")]
control = mimoc.InverseDynamics(infant.model, infant.data, infant.manifest, [reach, look, mimoc.Posture()])

distances_m = []
for _ in range(120):
    env.step(control())
    distances_m.append(np.linalg.norm(infant.data.body("right_hand").xipos - reach.target))

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4))
left.imshow(env.render())
left.axis("off")
right.plot(np.arange(120) * 0.01, np.array(distances_m) * 100)
right.set(xlabel="time [s]", ylabel="distance of the hand from its target [cm]", ylim=(0, None))
plt.show()
env.close()
