"""The infants of any environment of mimoc's on the CPU, whatever wraps it."""

from typing import Any

from mimoc.base.classes import described
from mimoc.runtime.batch.vector_env import BatchEnv
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.infant import Infant
from mimoc.runtime.world_env import WorldEnv


def infants_of(function: str, env: Any) -> dict[str, Infant]:
    """Return the infants of an environment, by name.

    The name of the only infant is empty; infants of a world have their own names, and those of a vector environment
    their numbers, from 0.

    Raises:
        TypeError: If it is no environment of mimoc's on the CPU; it names the function that was called.
    """
    inside = getattr(env, "unwrapped", env)
    if isinstance(inside, InfantEnv):
        return {"": inside}
    if isinstance(inside, WorldEnv):
        return dict(inside.infants)
    if isinstance(inside, BatchEnv):
        return {str(number): infant for number, infant in enumerate(inside.infants)}
    several = [env.unwrapped for env in getattr(inside, "envs", ())]
    if several and all(isinstance(infant, InfantEnv) for infant in several):
        return {str(number): infant for number, infant in enumerate(several)}
    raise TypeError(f"{function}: expected an environment of mimoc's on the CPU, got {described(inside)}")
