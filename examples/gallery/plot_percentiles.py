"""
Three girls on their percentiles
================================

`body.individual` makes a particular child. The same percentiles at another age are the same child, older.
"""

import matplotlib.pyplot as plt

import mimoc

AGES = range(0, 25, 6)

figure, ax = plt.subplots()
for percentile in (3, 50, 97):
    girl = {"sex": "female", "length_percentile": percentile, "weight_percentile": percentile}
    spec = mimoc.InfantSpec(mimoc=1, name="girl", age_months=0, senses={}, body={"individual": girl})
    bundles = [mimoc.build(spec.with_(age_months=age)) for age in AGES]
    ax.plot(AGES, [bundle.manifest.child.weight_kg for bundle in bundles], "o-", label=f"percentile {percentile}")
ax.set(xlabel="age [months]", ylabel="weight [kg]")
ax.legend()
plt.show()
