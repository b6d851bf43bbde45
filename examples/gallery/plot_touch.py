"""
Touch on the whole skin
=======================

A prone infant of nine months feels the floor: each dot is a point of its skin, larger and darker where a force is felt.
"""

import matplotlib.pyplot as plt
import numpy as np

import mimoc

spec = mimoc.InfantSpec(
    mimoc=1, name="prone", age_months=9, senses={"touch": {"density": 0.5}}, scene={"pose": "prone"}
)
env = mimoc.make(spec)
env.reset(seed=0)
for _ in range(30):
    env.step(np.zeros(env.action_space.shape, np.float32))

skin = env.unwrapped.skin
force_n = np.linalg.norm(skin.forces, axis=1)
felt = force_n > 0

figure, ax = plt.subplots(figsize=(8, 4))
ax.scatter(*skin.positions[~felt, :2].T, s=1, color="0.8")
points = ax.scatter(*skin.positions[felt, :2].T, s=15, c=force_n[felt], cmap="viridis_r")
figure.colorbar(points, label="force [N]")
ax.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", title=f"{felt.sum()} of {len(felt)} points, from above")
plt.show()
