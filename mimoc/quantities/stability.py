"""Whether a simulation stays stable, as `mimoc check` finds it from each pose."""

from mimoc.quantities.quantity import Quantity

STABLE = Quantity(
    name="stable",
    label="Simulation stayed stable",
    about="whether the infant stayed stable in all trials",
    over="pose",
    reduce="all",
    field="passed",
    steps=("check",),
)
ENERGY = Quantity(
    name="energy_j_per_kg",
    label="Kinetic energy",
    unit="J/kg",
    about="largest kinetic energy per body mass",
    over="pose",
    reduce="max",
    field="energy_j_per_kg",
    steps=("check",),
)
BEYOND_LIMITS = Quantity(
    name="beyond_deg",
    label="Beyond joint limits",
    unit="°",
    about="largest violation of a joint range",
    over="pose",
    reduce="max",
    field="beyond_deg",
    steps=("check",),
)
UNSTABLE = Quantity(
    name="unstable",
    label="Simulation became unstable",
    about="whether the simulation became unstable",
    reduce="any",
    field="unstable",
    steps=("run",),
)
