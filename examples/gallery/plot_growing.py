"""
Growing in the midst of an episode
==================================

An infant becomes a year older while it lies on the floor. Its joints keep their angles, as far as they can, and its
observation and action spaces stay as they are.
"""

import matplotlib.pyplot as plt

import mimoc

spec = mimoc.InfantSpec(mimoc=1, name="growing", age_months=6, senses={"proprioception": {}})
env = mimoc.make(spec, render_mode="rgb_array", width=300, height=220)
env.reset(seed=0)
space = env.observation_space
figure, axes = plt.subplots(1, 3, figsize=(10, 3))
for ax, age in zip(axes, (6, 12, 18), strict=True):
    env.unwrapped.grow(to=age)
    for _ in range(10):
        env.step(env.action_space.sample() * 0)
    ax.imshow(env.render())
    ax.set_title(f"{env.unwrapped.age_months:g} months, {env.unwrapped.manifest.child.weight_kg:.1f} kg")
    ax.axis("off")
assert env.observation_space == space
figure.tight_layout()
plt.show()
env.close()
