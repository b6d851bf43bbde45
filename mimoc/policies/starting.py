"""Episodes that begin where a policy puts the infant."""

from mimoc.bundle.physics_state import physics_of, set_physics
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import Observation


def begin_here(env: InfantEnv) -> Observation:
    """Let an infant whose configuration was changed begin its episode there, and return what it senses.

    A recording of the run keeps this as a state that was restored.
    """
    set_physics(env.model, env.data, physics_of(env.model, env.data))
    env.schedule.reset(env.data)
    return env.set_state(env.get_state())
