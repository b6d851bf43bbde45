"""
Random rooms
============

Size, textures, lights and toys of a room follow from its seed; an environment can have another room at each reset.
"""

import matplotlib.pyplot as plt

import mimoc

spec = mimoc.InfantSpec(
    mimoc=1,
    name="at_play",
    age_months=9,
    senses={},
    scene={"kind": "room", "pose": "sitting", "toys": {"count": [4, 6]}},
)
env = mimoc.make(spec, render_mode="rgb_array", width=240, height=240)
figure, axes = plt.subplots(1, 4, figsize=(10, 3))
for ax, seed in zip(axes, range(1, 5), strict=True):
    env.reset(seed=0, options={"scene_seed": seed})
    ax.imshow(env.render())
    ax.set_title(f"seed {seed}")
    ax.axis("off")
figure.tight_layout()
plt.show()
env.close()
