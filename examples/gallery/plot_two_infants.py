"""
Two infants in one world
========================

They sit face to face and move by themselves. Each is an agent of a PettingZoo environment; when they touch, both feel
the same force.
"""

import matplotlib.pyplot as plt
import numpy as np

import mimoc
from mimoc.policies.named import policy_of

facing = {"mimoc": 1, "age_months": 9, "senses": {"touch": {"density": 0.3}}, "scene": {"pose": "sitting"}}
anna, ben = (mimoc.InfantSpec(name=name, **facing) for name in ("anna", "ben"))
env = mimoc.make_parallel({"anna": anna, "ben": ben}, render_mode="rgb_array", width=400, height=300)
observations, _ = env.reset(seed=0)
policies = {name: policy_of(infant, "general_movements") for name, infant in env.infants.items()}
generators = {name: np.random.default_rng(number) for number, name in enumerate(policies)}

felt = {name: [] for name in env.agents}
for _ in range(100):
    actions = {name: policies[name](generators[name], observations[name]) for name in env.agents}
    observations, *_ = env.step(actions)
    for name in env.agents:
        sizes_n = np.linalg.norm(env.infants[name].skin.forces, axis=1)
        felt[name].append(sizes_n.sum())

figure, (picture, curves) = plt.subplots(1, 2, figsize=(8, 3))
picture.imshow(env.render())
picture.axis("off")
for name, forces_n in felt.items():
    curves.plot(np.arange(len(forces_n)) * 0.01, forces_n, label=name)
curves.set(xlabel="time [s]", ylabel="force on the skin [N]")
curves.legend()
env.close()
plt.show()
