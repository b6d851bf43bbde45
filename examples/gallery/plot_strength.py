"""
Strength by age, by both laws
=============================

Torque limits of the elbow, relative to 18 months. By the paper's law (`published`), strength follows the volume of
the arm; by `maturing`, a muscle group also gains strength of its own. Both agree at 18 months.
"""

import matplotlib.pyplot as plt

import mimoc

AGES = (0, 3, 6, 9, 12, 15, 18)


def elbow_nm(age_months: float, law: str) -> float:
    """Return the larger of the elbow's two torque limits, in [Nm]."""
    spec = mimoc.InfantSpec(mimoc=1, name="child", age_months=age_months, senses={}, development=law)
    return max(map(abs, mimoc.torque_limits(mimoc.build(spec))["robot:left_elbow"]))


figure, ax = plt.subplots()
for law in ("maturing", "published"):
    torques = [elbow_nm(age, law) for age in AGES]
    ax.plot(AGES, [torque / torques[-1] for torque in torques], "o-", label=law)
ax.set(xlabel="age [months]", ylabel="peak torque of the elbow / at 18 months", ylim=(0, None))
ax.legend()
plt.show()
