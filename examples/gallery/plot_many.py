"""
Many infants at once
====================

Six infants of six ages in one vector environment fall from sitting, without any commands: the height of each head.
"""

import matplotlib.pyplot as plt
import numpy as np

import mimoc

AGES = (0, 3, 6, 12, 18, 24)

spec = mimoc.InfantSpec(mimoc=1, name="sitter", age_months=0, senses={"vestibular": {}}, scene={"pose": "sitting"})
envs = mimoc.make_vec([spec.with_(age_months=age) for age in AGES])
envs.reset(seed=0)
heights_m = []
for _ in range(100):
    envs.step(np.zeros(envs.action_space.shape, np.float32))
    heights_m.append([infant.data.body("head").xpos[2] for infant in envs.infants])
envs.close()

plt.plot(np.arange(100) * 0.01, heights_m, label=[f"{age} months" for age in AGES])
plt.xlabel("time [s]")
plt.ylabel("height of the head [m]")
plt.legend()
plt.show()
