"""
Children drawn from the population
==================================

A cohort draws children whose length and weight have the means, spread and correlation of WHO's standards.
"""

import matplotlib.pyplot as plt

import mimoc

study = mimoc.Cohort(
    {
        "mimoc": 1,
        "cohort": "spring",
        "base": {"mimoc": 1, "name": "child", "age_months": 9, "senses": {}},
        "children": {"draw": 12, "sex": "both", "seed": 7},
        "do": ["build"],
    }
)
children = [mimoc.build(infant.spec).manifest.child for infant in study.infants]
plt.scatter([child.length_cm for child in children], [child.weight_kg for child in children])
plt.xlabel("length [cm]")
plt.ylabel("weight [kg]")
plt.title(f"{len(children)} children of nine months")
plt.show()
