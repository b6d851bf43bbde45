"""The `info` of many infants, as Gymnasium's vector environments give it."""

from typing import Any

from gymnasium.vector import VectorEnv

Infos = dict[int, dict[str, Any]]
"""Of each infant that has one."""


def joined(infos: Infos, env: VectorEnv) -> dict[str, Any]:
    """Return an array of each value, beside a mask of the infants that have it."""
    found: dict[str, Any] = {}
    for infant, info in sorted(infos.items()):
        found = env._add_info(found, info, infant)
    return found
