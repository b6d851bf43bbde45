"""
A reward of your own
====================

A task is a class with the method `judge`. This one rewards an infant for a head that is high, and for little
effort. Its terms are shown while an infant of nine months moves at random, and so falls over.
"""

import matplotlib.pyplot as plt

import mimoc


class HeadUp(mimoc.Task):
    """Hold the head up."""

    def bind(self, model, bundle):
        self.head = model.body(bundle.manifest.anatomy.head).id

    def judge(self, data, action, effort):
        height_m = float(data.xpos[self.head, 2])
        return mimoc.Verdict({"height": height_m, "effort": -0.1 * effort()}, success=height_m > 0.3)


spec = mimoc.InfantSpec(mimoc=1, name="sitting", age_months=9, senses={}, scene={"pose": "sitting"})
env = mimoc.make(spec, task=HeadUp(steps=150))
env.reset(seed=0)
env.action_space.seed(0)
terms, truncated = [], False
while not truncated:
    _, reward, _, truncated, info = env.step(env.action_space.sample())
    terms.append([*info["reward_terms"].values(), reward])

plt.plot(terms, label=[*info["reward_terms"], "reward"])
plt.xlabel("control step")
plt.legend()
plt.show()
