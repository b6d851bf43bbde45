"""
What an eye sees at several ages
================================

The same room seen with the acuity of 2, 4 and 12 months, and without blur. The field of view is narrow, so that the
picture has enough pixels for the acuity of every age.
"""

import matplotlib.pyplot as plt

import mimoc

spec = mimoc.InfantSpec(
    mimoc=1,
    name="looking",
    age_months=9,
    senses={"vision": {"width_px": 160, "height_px": 160, "fovy_deg": 20}},
    scene={"kind": "room", "pose": "sitting", "seed": 4, "toys": {"count": [6, 6]}},
)
figure, axes = plt.subplots(1, 4, figsize=(10, 3))
for ax, acuity in zip(axes, (2, 4, 12, "off"), strict=True):
    env = mimoc.make(spec.with_(senses={"vision": {"acuity": acuity}}))
    observation, _ = env.reset(seed=0)
    ax.imshow(observation["eye_left"])
    ax.set_title("no blur" if acuity == "off" else f"{acuity} months")
    ax.axis("off")
    env.close()
figure.tight_layout()
plt.show()
