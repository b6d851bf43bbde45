"""
Infants of several ages
=======================

One spec, four ages: each infant is built in memory. The camera of an environment comes as near as it can, so that all
look equally large; `mimoc render` draws several to scale.
"""

import matplotlib.pyplot as plt

import mimoc

spec = mimoc.InfantSpec(mimoc=1, name="child", age_months=0, senses={}, scene={"pose": "sitting"})
figure, axes = plt.subplots(1, 4, figsize=(10, 3))
for ax, age in zip(axes, (0, 6, 12, 24), strict=True):
    env = mimoc.make(spec.with_(age_months=age), render_mode="rgb_array", width=240, height=240)
    env.reset(seed=0)
    ax.imshow(env.render())
    ax.set_title(f"{age} months, {env.unwrapped.manifest.child.weight_kg:.1f} kg")
    ax.axis("off")
    env.close()
figure.tight_layout()
plt.show()
