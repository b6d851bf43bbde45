"""Episodes that begin where a policy puts the infant."""

import copy
from collections.abc import Mapping

from mimoc.base.errors import PolicyError
from mimoc.bundle.physics_state import physics_of, set_physics
from mimoc.bundle.world import overlaps
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import Observation


def begin_here(infant: Infant) -> Observation:
    """Let an infant whose configuration was changed begin its episode there, and return what it senses.

    Other infants of its world sense that, too, as if it had been there before; their noise is drawn anew later on. A
    recording of the run keeps this as a state that was restored.
    """
    simulation = infant.simulation
    set_physics(infant.model, infant.data, physics_of(infant.model, infant.data))
    for other in simulation.infants.values():
        noise = other.noise.state
        other.schedule.reset(infant.data)
        if other is not infant:
            other.noise.state = noise
    simulation.set_state(simulation.get_state())
    return infant.observe()


def check_apart(infants: Mapping[str, Infant]) -> None:
    """Raise a PolicyError if policies have put infants of a world within each other."""
    if len(infants) < 2:
        return
    first = next(iter(infants.values()))
    roots = [infant.manifest.root_body for infant in infants.values()]
    if depths := overlaps(first.model, copy.copy(first.data), roots):
        one, other = ([*infants][index] for index in next(iter(depths)))
        raise PolicyError(f"their policies put '{one}' and '{other}' within each other; place them further apart")
