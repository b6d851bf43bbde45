"""Whether a simulation stays stable, as `mimoc check` finds it from each pose."""

from functools import partial

from mimoc.quantities.quantity import Quantity

_of_poses = partial(Quantity, over="pose", steps=("check",))

STABLE = _of_poses(
    "stable", "Simulation stayed stable", "", "whether it did in all trials", reduce="all", field="passed"
)
ENERGY = _of_poses("energy_j_per_kg", "Kinetic energy", "J/kg", "largest of all trials, per body mass", reduce="max")
BEYOND_LIMITS = _of_poses("beyond_deg", "Beyond joint limits", "°", "largest violation of a joint range", reduce="max")
UNSTABLE = Quantity(
    "unstable", "Simulation became unstable", about="whether it did at any time", reduce="any", steps=("run",)
)
